"""Full-spectrum cascades of a result: from the recording if given, else from the order vectors."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import representative_rows
from rotorrig.app.viewer.plots import CascadePicture
from rotorrig.app.viewer.result.data import Result
from rotorrig.processing import Waveforms
from rotorrig.processing.rows import lay_rows
from rotorrig.processing.shaft_angle import fit_shaft_angle
from rotorrig.processing.tracking import HIGHEST, full_spectra, whirl_vectors
from rotorrig.rig.config import RPM, UM

SPECTRA = 40
TURNS = 8  # in the window of a spectrum: orders an eighth apart
STICK = 0.02  # orders: half the width of an order vector's line
Reals = NDArray[np.float64]
Cascade = tuple[Reals, Reals, Reals]  # rpm (row,), order (bin,), amplitude (row, bin) m


def draw_cascades(stream: rr.RecordingStream, result: Result, waveforms: Waveforms | None) -> None:
    """Draw a cascade for every plane along the first sweep."""
    if not result.sweeps or not result.planes:
        return
    rows = representative_rows(result.response, result.z, run=result.sweeps[0], count=SPECTRA)
    recorded = recorded_cascades(result, waveforms, rows) if waveforms is not None and rows else []
    for i, (rpm, order, amplitude) in enumerate(recorded or tracked_cascades(result, rows)):
        what = "as recorded" if recorded else "of the order vectors, raw"
        picture = CascadePicture(stream, f"cascade/{i}", title=f"full spectrum, {what}, 0-peak", static=True)
        picture.draw(rpm, order, amplitude * UM)


def recorded_cascades(result: Result, waveforms: Waveforms, rows: list[int]) -> list[Cascade]:
    """Return the cascade of every plane from the waveforms in turns about the rows; none where pulses are unknown."""
    pulses = result.response.keyphasor_t
    middle = np.searchsorted(pulses, result.response.t[rows])
    middle = middle[(middle >= TURNS // 2) & (middle + TURNS // 2 < len(pulses))]
    if not len(middle):
        return []
    slack = 1e-6  # s, so that the outer edges lie within the span
    spans = [(pulses[k - TURNS // 2] - slack, pulses[k + TURNS // 2] + slack) for k in middle]
    shaft = fit_shaft_angle(pulses, gaps=waveforms.gaps, where=waveforms.where)
    laid = lay_rows(shaft, spans, turns=TURNS)
    spectra = full_spectra(waveforms, shaft, laid, rig=result.response.rig)
    wanted = {plane.name for plane, _ in result.planes}
    return [(laid.omega * RPM, s.order, s.amplitude) for s in spectra if s.plane.name in wanted]


def tracked_cascades(result: Result, rows: list[int]) -> list[Cascade]:
    """Return the cascade of every plane from the orders that were tracked, a narrow line at each."""
    orders = sorted(order for order in result.response.orders if 0 < order <= HIGHEST)
    centres = np.array([*(-n for n in reversed(orders)), *orders])
    places = np.concatenate([[-HIGHEST], *(c + np.array([-STICK, 0.0, STICK]) for c in centres), [HIGHEST]])
    by_order = [whirl_vectors(result.response, order=order) for order in orders]
    cascades = []
    for i in range(len(result.planes)):
        forward = np.array([np.abs(seen[i].forward[rows]) for seen in by_order])
        backward = np.array([np.abs(seen[i].backward[rows]) for seen in by_order])
        amplitude = np.zeros((len(rows), len(places)))
        amplitude[:, 2:-1:3] = np.concatenate([backward[::-1], forward]).T
        cascades.append((result.rpm[rows], places, amplitude))
    return cascades
