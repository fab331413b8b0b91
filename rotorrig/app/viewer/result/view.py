"""Rerun file of a finished run: measurement, model before and after its extension, and the rotor.

The timeline is the shaft speed: moving along it moves the orbits, the cursor in every plot and the rotor's deflection.
"""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import rerun as rr

from rotorrig.acquisition import WaveformSource
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots import displayable
from rotorrig.app.viewer.result import curves
from rotorrig.app.viewer.result.balance import draw_balance
from rotorrig.app.viewer.result.blueprint import result_layout
from rotorrig.app.viewer.result.by_speed import draw_by_speed, rows_to_show
from rotorrig.app.viewer.result.cascade import draw_cascades
from rotorrig.app.viewer.result.data import Result, result_of
from rotorrig.app.viewer.result.missing import draw_missing
from rotorrig.app.viewer.result.opening import note_opening, opening_rpm
from rotorrig.app.viewer.result.rotor import RotorScene
from rotorrig.app.viewer.result.rotor_motion import mode_words, rotor_motion
from rotorrig.app.viewer.result.text import colour_words, verdict_words
from rotorrig.app.viewer.sinks import Sink, to_file
from rotorrig.balancing import Balance
from rotorrig.identify import Diagnosis, Identification
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import provisional_file


def write_result_rrd(
    path: Path,
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    recording: WaveformSource | None = None,
    balance: Balance | None = None,
    *,
    unit: AmplitudeUnit = AS_STATED,
) -> None:
    """Write an .rrd of a response with the model's prediction and residual.

    `recording` adds the orbits and full spectra as recorded, `balance` the correction and the vectors with it;
    amplitudes are told in `unit`. Raises DataError if the file cannot be written, or if one of these is of another
    response.
    """
    result = result_of(response, identification, diagnosis, recording, balance, unit=unit)
    with provisional_file(path) as made:
        _draw_result(to_file(made), result)


def _draw_result(sink: Sink, result: Result) -> None:
    response = result.response
    rows = rows_to_show(result)
    motion = rotor_motion(result, rows)
    titles = [mode_words(mode, rotation=response.rig.rotation) for mode in motion.modes]
    source = response.source.source_hash or response.source.config_hash
    stream = rr.RecordingStream(application_of(result, titles), recording_id=f"result-{source}")
    stream.set_sinks(*sink.open_targets(), default_blueprint=result_layout(result, titles))
    stream.send_recording_name(displayable(f"{response.rig.name}, result"))
    note_opening(stream, opening_rpm(result, rows))
    bodes = curves.draw_bodes(stream, result)
    polars = curves.draw_polars(stream, result)
    curves.draw_residuals(stream, result)
    centrelines = curves.draw_centrelines(stream, result)
    curves.draw_gaps(stream, result)
    curves.draw_whirl(stream, result)
    draw_cascades(stream, result)
    draw_balance(stream, result)
    draw_missing(stream, result)
    for name, words in (("verdict", verdict_words(result)), ("colours", colour_words(result))):
        stream.log(
            name, rr.TextDocument(displayable(result.unit.retell(words)), media_type=rr.MediaType.MARKDOWN), static=True
        )
    rotor = RotorScene(stream, result, motion)
    draw_by_speed(stream, result, bodes=bodes, polars=polars, centrelines=centrelines, rotor=rotor)
    rotor.turning()
    stream.disconnect()


def application_of(result: Result, titles: Sequence[str]) -> str:
    """Return the name a viewer keeps the layout under: it would show another layout's result in the first it saw."""
    missing = result.diagnosis.missing if result.diagnosis else None
    pictured = missing and (bool(missing.places.size), missing.over_speed is not None)
    kinds = (result.diagnosis is None, pictured, bool(result.spectra), result.extended is None, result.balance is None)
    shape = (result.response.source, titles, *kinds)
    return f"rotorrig result {hashlib.sha256(repr(shape).encode()).hexdigest()[:8]}"
