"""Axes drawn as lines and labels, because Rerun has no plot of y against x: ticks at 1-2-5 steps, units, a frame.

A panel is a rectangle of a Spatial2DView, whose y points down and whose two axes share one scale.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from rotorrig.app.viewer.plots.words import displayable

INK = (200, 206, 214)
SOFT = (120, 128, 138)
GRID = (58, 64, 72)
UP = (74, 163, 223)
DOWN = (242, 142, 43)
MODEL_UP = (158, 208, 244)
MODEL_DOWN = (250, 200, 140)
MARK = (240, 240, 240)
LINE_APART = 7.5  # view units between the lines of a legend
Colour = tuple[int, int, int]
LIFT = 5.5  # view units: the viewer hangs a label below its point; this brings it back to the point's height


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """A drawn pair of axes: where it sits in the view and which values its edges have."""

    left: float
    top: float
    width: float
    height: float
    x: tuple[float, float]
    y: tuple[float, float]
    x_step: float
    y_step: float
    y_turn: float = math.inf  # 360 for an angle: labels start again there
    title: str = ""
    x_title: str = ""

    def place(self, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
        """Return the view's coordinates (point, 2) of values; NaN stays NaN."""
        u = (np.asarray(x) - self.x[0]) / (self.x[1] - self.x[0])
        v = (np.asarray(y) - self.y[0]) / (self.y[1] - self.y[0])
        return np.column_stack([self.left + self.width * u, self.top + self.height * (1 - v)])

    def strips(self, x: NDArray[np.float64], y: NDArray[np.float64], *, jump: float = math.inf) -> list[NDArray]:
        """Return the line through the values, broken where one is not finite or y leaps by more than `jump`."""
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        if not len(x):
            return []
        finite = np.isfinite(x) & np.isfinite(y)
        breaks = np.flatnonzero(~finite[1:] | ~finite[:-1] | (np.abs(np.diff(y)) > jump)) + 1
        pieces = np.split(self.place(x, y), breaks)
        return [piece for piece in pieces if len(piece) > 1 and np.isfinite(piece).all()]

    def log(self, stream: rr.RecordingStream, path: str, *, static: bool = False) -> None:
        """Draw frame, grid, tick labels and titles under `path`."""
        xs, ys = ticks(*self.x, self.x_step), ticks(*self.y, self.y_step)
        grid = [self.place(np.array([x, x]), np.array(self.y)) for x in xs]
        grid += [self.place(np.array(self.x), np.array([y, y])) for y in ys]
        corners = self.place(np.array(self.x)[[0, 1, 1, 0, 0]], np.array(self.y)[[0, 0, 1, 1, 0]])
        colours = [GRID] * len(grid) + [SOFT]
        stream.log(
            f"{path}/frame",
            rr.LineStrips2D([*grid, corners], colors=colours, radii=-0.5, draw_order=-10),
            static=static,
        )
        stream.log(f"{path}/labels", texts(self._labels(xs, ys)), static=static)

    def _labels(self, xs: Sequence[float], ys: Sequence[float]) -> list[tuple[float, float, str]]:
        below, beside = self.top + self.height + 5.5, self.left - 8.0
        labels = [(self.place([x], [0])[0][0], below, f"{x:g}") for x in xs] if self.x_title else []
        labels += [
            (beside, self.place([0], [y])[0][1], f"{y % self.y_turn if math.isfinite(self.y_turn) else y:g}")
            for y in ys
        ]
        labels.append((self.left + self.width / 2, self.top - 5.0, self.title))
        if self.x_title:
            labels.append((self.left + self.width / 2, below + 7.5, self.x_title))
        return labels


def ticks(low: float, high: float, step: float) -> list[float]:
    """Return the multiples of `step` within low .. high; none of an infinite step.

    >>> ticks(0.0, 3600.0, 1000.0)
    [0.0, 1000.0, 2000.0, 3000.0]
    """
    if not math.isfinite(step):
        return []
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(i * step, 12) for i in range(first, last + 1)]


def step_for(span: float, *, most: int = 6) -> float:
    """Return the smallest 1-2-5 step that cuts `span` into at most `most` pieces.

    >>> step_for(3600.0), step_for(0.7)
    (1000.0, 0.2)
    """
    decade = 10.0 ** math.floor(math.log10(span / most))
    return next(round(m * decade, 12) for m in (1, 2, 5, 10) if span / (m * decade) <= most + 1e-9)


def texts(labels: Iterable[tuple[float, float, str]]) -> rr.Points2D:
    """Return words centred at places (x, y, words) of a view; empty ones are left out."""
    kept = [label for label in labels if label[2]]
    return rr.Points2D(
        [(x, y - LIFT) for x, y, _ in kept],
        labels=[words for *_, words in kept],
        show_labels=True,
        radii=-0.01,
        colors=INK,
    )


def legend(entries: Sequence[tuple[str, Colour]], places: Iterable[tuple[float, float]]) -> rr.Points2D:
    """Return words in their colours, centred at places (x, y) of a view."""
    return rr.Points2D(
        [(x, y - LIFT) for (x, y), _ in zip(places, entries, strict=False)],
        labels=[displayable(words) for words, _ in entries],
        colors=[colour for _, colour in entries],
        show_labels=True,
        radii=-0.01,
    )


def below_one_another(x: float, y: float) -> Iterator[tuple[float, float]]:
    """Yield places for lines of a legend, the first at x, y of a view."""
    return ((x, y + LINE_APART * i) for i in itertools.count())


def pale(colour: Colour) -> Colour:
    """Return a colour half-way to white: that of the same thing while the speed falls.

    >>> pale((100, 0, 255))
    (177, 127, 255)
    """
    red, green, blue = ((channel + 255) // 2 for channel in colour)
    return red, green, blue
