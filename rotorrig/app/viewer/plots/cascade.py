"""A cascade of full spectra of one probe plane in Rerun: amplitude against order, one spectrum per speed.

Forward whirl stands at positive orders, backward at negative ones. Spectra stand at their speed; a nearer one (slower)
hides what of a farther one lies behind it.
"""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import nice
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import INK, UP, Panel, step_for, texts

SMALLEST_SPECTRUM = 1e-6  # m
TALLEST = 0.24  # of the height of the axes, for the largest amplitude
WIDTH, HEIGHT = 186.0, 100.0
Colour = tuple[int, int, int]


class CascadePicture:
    """Full spectra over speed; the scales grow with what is drawn."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        path: str,
        *,
        title: str,
        static: bool = False,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        self._stream = stream
        self._path = path
        self._title = title
        self._static = static
        self._unit = unit
        self._largest = SMALLEST_SPECTRUM * unit.by
        self._drawn: tuple[Panel, float] | None = None

    def draw(
        self,
        rpm: NDArray[np.float64],
        order: NDArray[np.float64],
        amplitude: NDArray[np.float64],
        *,
        colour: Colour = UP,
    ) -> None:
        """Draw amplitude (row, bin) in the unit at order (bin,), rising from -N to N, and rpm (row,)."""
        self._largest = max(self._largest, nice(float(np.nanmax(amplitude, initial=0.0))))
        panel = self._axes(order, rpm)
        lift = TALLEST * HEIGHT / self._largest  # view units per unit
        strips = [piece for _, pieces in visible(panel, rpm, order, amplitude * lift) for piece in pieces]
        lines = rr.LineStrips2D(strips, colors=colour, radii=-0.7, draw_order=2.0)
        self._stream.log(f"{self._path}/spectra", lines, static=self._static)

    def _axes(self, order: NDArray[np.float64], rpm: NDArray[np.float64]) -> Panel:
        """Return the axes, drawn where they are new, with a bar for the scale of the amplitude."""
        top = 500.0 * np.ceil(float(np.max(rpm, initial=1.0)) / 500.0)
        if self._drawn:
            top = max(top, self._drawn[0].y[1])
        panel = Panel(
            left=0, top=TALLEST * HEIGHT, width=WIDTH, height=(1 - TALLEST) * HEIGHT,
            x=(float(order[0]), float(order[-1])), y=(0.0, top), x_step=1.0, y_step=step_for(top, most=6),
            x_title="order of the shaft speed: backward whirl left of 0, forward right",
        )  # fmt: skip
        if (panel, self._largest) != self._drawn:
            panel.log(self._stream, f"{self._path}/axes", static=self._static)
            self._log_scale()
            self._drawn = (panel, self._largest)
        return panel

    def _log_scale(self) -> None:
        tall = TALLEST * HEIGHT / 2
        bar = [[(WIDTH + 3, 4 + tall), (WIDTH + 3, 4)]]
        self._stream.log(f"{self._path}/scale/bar", rr.LineStrips2D(bar, colors=INK, radii=-1.2), static=self._static)
        words = [
            (WIDTH - 14, 4 + tall / 2, f"{self._largest / 2:g} {self._unit.length}"),
            (WIDTH / 2, -5.0, self._title),
        ]
        words.append((-8.0, TALLEST * HEIGHT - 7.0, "rpm"))
        self._stream.log(f"{self._path}/scale/words", texts(words), static=self._static)


def visible(
    panel: Panel, rpm: NDArray[np.float64], order: NDArray[np.float64], height: NDArray[np.float64]
) -> Iterator[tuple[int, list[NDArray[np.float64]]]]:
    """Yield each row and the pieces of its spectrum that no slower row hides, in view units."""
    horizon = np.full(len(order), np.inf)  # the highest point so far; y points down
    for row in np.argsort(rpm, kind="stable"):
        places = panel.place(order, np.full(len(order), rpm[row]))
        places[:, 1] -= height[row]
        seen = places[:, 1] <= horizon
        horizon = np.fmin(horizon, places[:, 1])
        cut = np.flatnonzero(np.diff(seen.astype(np.int8))) + 1
        pieces = np.split(places, cut)[0 if seen[0] else 1 :: 2]  # seen and hidden pieces take turns
        yield int(row), [piece for piece in pieces if len(piece) > 1]
