"""Cascades of a result: by frequency from the recording if given, else by order from the order vectors."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import SpeedSpectra, nice, representative_rows
from rotorrig.app.viewer.plots import CascadePicture, SpectrumMapPicture
from rotorrig.app.viewer.result.data import Result
from rotorrig.processing.tracking import HIGHEST, whirl_vectors

SPECTRA = 40
STICK = 0.02  # orders: half the width of an order vector's line
Reals = NDArray[np.float64]
Cascade = tuple[Reals, Reals, Reals]  # rpm (row,), order (bin,), amplitude (row, bin) m


def draw_cascades(stream: rr.RecordingStream, result: Result) -> None:
    """Draw a map of every place and run of the recording; without one, a cascade of every plane's first sweep."""
    if result.spectra:
        top = nice(max(one.largest[0] for one in result.spectra))
        for path, one in zip(map_paths(result.spectra), result.spectra, strict=True):
            SpectrumMapPicture(stream, path, top=top, unit=result.unit).draw(one)
    elif result.sweeps and result.planes:
        rows = representative_rows(result.response, result.z, run=result.sweeps[0], count=SPECTRA)
        for i, (rpm, order, amplitude) in enumerate(tracked_cascades(result, rows)):
            unit = result.unit
            title = f"full spectrum of the order vectors, raw, {unit.name.split()[1]}"
            CascadePicture(stream, f"cascade/{i}", title=title, static=True, unit=unit).draw(
                rpm, order, amplitude * unit.by
            )


def map_paths(spectra: tuple[SpeedSpectra, ...]) -> list[str]:
    """Return where in the stream each map is drawn."""
    return [f"spectra/{i}" for i in range(len(spectra))]


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
