"""A finished run as a Rerun file: Bode plots measured and modelled, orbits by speed, residual map, verdict in words.

The timeline is the shaft speed: moving along it moves the orbit and the cursor in every Bode plot.
"""

from pathlib import Path

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.acquisition.recording import RawRecording
from rotorrig.app import cause_words
from rotorrig.app.blueprint import result_blueprint
from rotorrig.app.curves import model_vectors, phase_window, residual_grid, slow_roll_known, sweeps, vectors
from rotorrig.app.diagnosis_part import part_of, predictions
from rotorrig.app.drawn_axes import DOWN, GRID, MODEL_DOWN, MODEL_UP, SOFT, UP, Panel, step_for, texts
from rotorrig.app.orbits import Plane, orbit, representative_rows
from rotorrig.app.rerun_pictures import BodePicture, OrbitPicture
from rotorrig.app.sinks import to_file
from rotorrig.app.wording import plus_minus, shown
from rotorrig.identify.diagnosis import Diagnosis
from rotorrig.identify.identification import Identification
from rotorrig.processing.probe_planes import planes
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.waveform import Waveforms
from rotorrig.rig.units import RPM, UM

ORBIT_SPEEDS = 60
MAP_BINS = 100  # of the residual map: about four rows of a run in each
RAW = (96, 104, 112)
SIGMA_STOPS = (
    (0.0, (34, 38, 43)),
    (2.0, (70, 76, 83)),
    (3.0, (242, 193, 78)),
    (5.0, (230, 121, 43)),
    (8.0, (200, 24, 66)),
)


def write_result_rrd(
    path: Path,
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    recording: RawRecording | None = None,
) -> None:
    """Write an .rrd of a response with the model's prediction and residual; `recording` adds the unfiltered orbits.

    The model is the extended one where there is one. Raises RigError if the file's folder is missing, DataError if the
    diagnosis is of another response.
    """
    stream = rr.RecordingStream(
        "rotorrig result", recording_id=f"result-{response.source.source_hash or response.source.config_hash}"
    )
    stream.set_sinks(*to_file(path).opened(), default_blueprint=result_blueprint(response.rig, response.probes))
    fit = identification.fits[0] if identification and identification.fits else None
    diagnosis = part_of(diagnosis, response) if diagnosis else None
    base, extended = predictions(response, fit, diagnosis)
    prediction = base if extended is None else extended
    bodes = _draw_bodes(stream, response, prediction)
    if sweeps(response):
        _draw_by_speed(stream, response, prediction, recording, bodes)
    if diagnosis is not None:
        _draw_residual(stream, response, diagnosis)
    words = verdict_words(response, identification, diagnosis, recorded=recording is not None)
    stream.log("verdict", rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN), static=True)
    stream.disconnect()


def _draw_bodes(
    stream: rr.RecordingStream, response: OrderTrackedResponse, prediction: NDArray[np.complex128] | None
) -> list[tuple[Panel, Panel]]:
    z = np.where(response.usable, vectors(response), np.nan)
    model = None if prediction is None else model_vectors(response, prediction)
    top = 100.0 * np.ceil(float(response.omega.max()) * RPM / 100.0)
    drawn = []
    for p, name in enumerate(response.probes):
        word = "slow-roll compensated" if slow_roll_known(response) else "raw"
        title = f"{name}: 1X amplitude, {word}, µm 0-peak"
        picture = BodePicture(stream, f"bode/{name}", title=title, fastest=top, static=True)
        panels = picture.panels(
            float(np.nanmax(np.abs(z[:, p]), initial=0.0)) * UM, top, lag_from=phase_window(z[:, p])
        )
        drawn.append(panels)
        for i in sweeps(response):
            rows, up = response.run == i, response.runs[i].direction > 0
            rpm = response.omega[rows] * RPM
            dots, radius, order = (
                (UP, 2.4, 1.0) if up else (DOWN, 1.2, 2.0)
            )  # smaller on top: both show where they agree
            picture.dots(f"{i}-measured", panels, rpm, z[rows, p], dots, radius=radius, order=order)
            if model is not None:
                picture.line(
                    f"{i}-model", panels, rpm, model[rows, p], MODEL_UP if up else MODEL_DOWN, order=2.0 + order
                )
    return drawn


def _draw_by_speed(
    stream: rr.RecordingStream,
    response: OrderTrackedResponse,
    prediction: NDArray[np.complex128] | None,
    recording: RawRecording | None,
    bodes: list[tuple[Panel, Panel]],
) -> None:
    """Draw orbits and the cursor at speeds along the first sweep."""
    z = vectors(response)
    model = None if prediction is None else model_vectors(response, prediction)
    waveforms = Waveforms(recording) if recording else None
    shown_planes = [plane for plane in planes(response.rig) if set(plane.probes) <= set(response.probes)]
    pictures = [OrbitPicture(stream, f"orbit/{i}") for i in range(len(shown_planes))]
    for row in representative_rows(response, z, run=sweeps(response)[0], count=ORBIT_SPEEDS):
        rpm = float(response.omega[row] * RPM)
        stream.set_time("speed_rpm", sequence=round(rpm))
        for plane, picture in zip(shown_planes, pictures, strict=True):
            columns = [response.probes.index(name) for name in plane.probes]
            xy = orbit(plane, z[row, columns][:, None]) * UM
            orbits = [("measured-1X", xy, UP)]
            if model is not None:
                orbits.append(("model-1X", orbit(plane, model[row, columns][:, None]) * UM, MODEL_UP))
            if waveforms and (raw := _unfiltered(waveforms, response, row, plane)) is not None:
                orbits.insert(0, ("unfiltered", raw, RAW))
            picture.draw(orbits, xy[:1])
        for name, panels in zip(response.probes, bodes, strict=True):
            cursor = [panel.place(np.array([rpm, rpm]), np.array(panel.y)) for panel in panels]
            stream.log(f"bode/{name}/cursor", rr.LineStrips2D(cursor, colors=SOFT, radii=-0.6))


def _unfiltered(
    waveforms: Waveforms, response: OrderTrackedResponse, row: int, plane: Plane
) -> NDArray[np.float64] | None:
    """Return two turns of the recorded orbit (point, 2) [µm] about its mean at a row's time; None where unknown."""
    after = np.searchsorted(response.keyphasor_t, response.t[row])
    if not 1 <= after < len(response.keyphasor_t) - 1:
        return None
    stretch = waveforms.between(*response.keyphasor_t[[after - 1, after + 1]])
    if stretch is None:
        return None
    names = [probe.name for probe in response.rig.probes]
    x = stretch.x[:, [names.index(name) for name in plane.probes]]
    return (x - x.mean(axis=0)) @ plane.to_xy.T * UM


def _draw_residual(stream: rr.RecordingStream, response: OrderTrackedResponse, diagnosis: Diagnosis) -> None:
    """Draw the 1X residual as an image with its own axes, 200 wide and 60 high."""
    labels, edges, grid = residual_grid(response, diagnosis.sigmas, bins=MAP_BINS)
    if not len(labels):
        return
    tall = max(1, 60 // len(labels))
    image = np.kron(_coloured(grid), np.ones((tall, 200 // MAP_BINS, 1), dtype=np.uint8))
    height = float(image.shape[0])
    stream.log("residual/map", rr.Image(image), static=True)
    panel = Panel(
        left=0, top=0, width=200, height=height, x=(edges[0], edges[-1]), y=(0, len(labels)),
        x_step=step_for(edges[-1] - edges[0], most=7), y_step=np.inf, x_title="speed, rpm",
    )  # fmt: skip
    panel.log(stream, "residual/axes", static=True)
    rows = [(-16.0, (i + 0.5) * tall, label) for i, label in enumerate(labels)]
    stops = [(40.0 + 34 * i, -6.0, f"{s:g} σ") for i, (s, _) in enumerate(SIGMA_STOPS)]
    stream.log("residual/rows", texts([*rows, *stops]), static=True)
    swatches = rr.Points2D([(x - 9, y) for x, y, _ in stops], colors=[c for _, c in SIGMA_STOPS], radii=2.0)
    stream.log("residual/scale", swatches, static=True)


def _coloured(grid: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return sigmas (row, bin) as colours (row, bin, 3); what was not measured takes the grid's colour."""
    at = [stop for stop, _ in SIGMA_STOPS]
    channels = [np.interp(grid, at, [colour[k] for _, colour in SIGMA_STOPS]) for k in range(3)]
    image = np.stack(channels, axis=-1)
    image[~np.isfinite(grid)] = GRID
    return image.astype(np.uint8)


def verdict_words(
    response: OrderTrackedResponse,
    identification: Identification | None,
    diagnosis: Diagnosis | None,
    *,
    recorded: bool,
) -> str:
    """Return what stands beside the pictures, in Markdown: verdict, causes, values, provenance."""
    said = [f"# {response.rig.name}"]
    if diagnosis:
        said += [f"**{str(diagnosis.verdict).upper()}**: {diagnosis.sentence}", *_causes(diagnosis)]
    if identification and identification.fits:
        said.append("| | identified | nameplate |\n|---|---|---|")
        said[-1] += "".join(
            f"\n| {e.name} | {plus_minus(e)} | {shown(e.nameplate, e.unit)} |" for e in identification.fits[0].estimates
        )
    said.append("Blue: speed rises, orange: it falls; dots measured, pale lines model. White dot: keyphasor edge.")
    if recorded:
        said.append("Grey: the orbit as recorded, two turns, runout included.")
    made = response.source
    said.append(f"Config {made.config_hash}, data {made.source} {made.source_hash}, code {made.code_version}.")
    return "\n\n".join(said)


def _causes(found: Diagnosis) -> list[str]:
    """Return the causes in the model and the best others as a table, what the model gains, and the next run."""
    said = [cause.words for cause in found.causes if cause.chosen]
    if found.causes:
        rows = [
            f"| {c.label} | {cause_words.size(c)} | {cause_words.evidence(c)} | {cause_words.heldout(c)} |"
            for c in cause_words.listed(found)
        ]
        said.append("\n".join(["| cause | size | evidence | held-out error |", "|---|---|---|---|", *rows]))
    return [
        *said,
        *(words for words in (cause_words.gain(found), *cause_words.ties(found), cause_words.next_run(found)) if words),
    ]
