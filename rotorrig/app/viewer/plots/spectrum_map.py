"""A cascade by frequency in Rerun: amplitude as colours, frequency across and speed up, with lines at shaft orders."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import DECADES, SpeedSpectra, order_mark
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import SOFT, Panel, step_for, texts
from rotorrig.rig.config import UM

WIDTH, HEIGHT = 168, 132  # view units, a pixel of the image each
STOPS = ((0, 0, 4), (81, 18, 124), (183, 55, 121), (252, 137, 97), (252, 253, 191))  # magma, at equal steps
LABEL_UP, FRACTION_UP = 5.0, 13.0  # view units above the map: orders, and fractions of one
DASHES = 30  # of a line at an order


class SpectrumMapPicture:
    """Spectra of one place in one run, on a logarithmic scale of DECADES below `top` [µm 0-peak]; drawn once."""

    def __init__(self, stream: rr.RecordingStream, path: str, *, top: float, unit: AmplitudeUnit = AS_STATED) -> None:
        self._stream = stream
        self._unit, self._by = unit, unit.by / UM
        self._path = path
        self._top = top

    def draw(self, spectra: SpeedSpectra) -> None:
        """Draw the map, its axes, a line at every order and the colours' scale."""
        self._log("map", rr.Image(colour_amplitudes(image_of(spectra), top=self._top)))
        half = spectra.step / 2
        panel = Panel(
            left=0, top=0, width=WIDTH, height=HEIGHT,
            x=(float(spectra.frequency[0]) - half, float(spectra.frequency[-1]) + half),
            y=(float(spectra.rpm.min()), float(spectra.rpm.max())),
            x_step=step_for(float(np.ptp(spectra.frequency)), most=7),
            y_step=step_for(float(np.ptp(spectra.rpm)), most=6),
            x_title=f"Hz, resolved to {spectra.resolution:.2g}{'; backward whirl below 0' if spectra.full else ''}",
        )  # fmt: skip
        panel.log(self._stream, f"{self._path}/axes", static=True)
        self._draw_orders(panel, spectra)
        self._log_scale()

    def _draw_orders(self, panel: Panel, spectra: SpeedSpectra) -> None:
        """Draw a dashed line at every order, so that what lies on it is seen, with its name above."""
        rpm = np.linspace(spectra.rpm.min(), spectra.rpm.max(), DASHES * 2 + 1)
        dashes, names = [], []
        for order in spectra.orders:
            line = panel.place(order * rpm / 60, rpm)
            dashes += [line[i : i + 2] for i in range(0, 2 * DASHES, 2)]
            top = float(line[-1][0])
            place = (top, -LABEL_UP) if abs(order) >= 1 else (top, -FRACTION_UP)
            names.append((*place, order_mark(order)))
        self._log("orders", rr.LineStrips2D(dashes, colors=SOFT, radii=-0.4, draw_order=2.0))
        self._log("names", texts([*names, (-8.0, -LABEL_UP, "rpm")]))

    def _log_scale(self) -> None:
        """Draw the colours at whole decades of the unit, right of the map."""
        top = self._top * self._by
        decades = np.arange(np.ceil(np.log10(top) - DECADES), np.floor(np.log10(top)) + 1)
        colours = colour_amplitudes(10.0 ** decades[:, None], top=top)[:, 0]
        places = [(WIDTH + 6.0, HEIGHT - 8.0 - 14.0 * i) for i in range(len(decades))]
        self._log("scale", rr.Points2D(places, colors=colours, radii=3.0))
        words = [(x + 12.0, y, f"{10.0**decade:g}") for (x, y), decade in zip(places, decades, strict=True)]
        self._log("scale/words", texts([*words, (WIDTH + 14.0, places[-1][1] - 12.0, self._unit.name)]))

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=True)


def image_of(spectra: SpeedSpectra) -> NDArray[np.float64]:
    """Return amplitudes [µm] as HEIGHT rows from the fastest speed down and WIDTH columns, the largest in each."""
    speeds = np.linspace(spectra.rpm.max(), spectra.rpm.min(), HEIGHT)
    nearest = np.abs(speeds[:, None] - spectra.rpm).argmin(axis=1)
    first = np.linspace(0, len(spectra.frequency), WIDTH, endpoint=False).astype(int)
    return np.maximum.reduceat(spectra.amplitude[nearest], first, axis=1)


def colour_amplitudes(amplitude: NDArray[np.float64], *, top: float) -> NDArray[np.uint8]:
    """Return amplitudes (row, column) as colours (row, column, 3): the last stop at `top`, the first DECADES below.

    What is not known is as nothing.

    >>> colour_amplitudes(np.array([[100.0, 1.0, np.nan]]), top=100.0).tolist()
    [[[252, 253, 191], [183, 55, 121], [0, 0, 4]]]
    """
    with np.errstate(divide="ignore"):
        share = 1 + np.log10(np.nan_to_num(amplitude) / top) / DECADES
    at = np.linspace(0.0, 1.0, len(STOPS))
    return np.stack([np.interp(share, at, channel) for channel in np.transpose(STOPS)], axis=-1).astype(np.uint8)
