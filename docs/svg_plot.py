"""Small plots as SVG, for documents: a light card with panels of points, lines and level curves, to the pixel the same.

>>> figure = Figure(width=300, height=200)
>>> panel = figure.panel((50, 20, 230, 140), x=(0, 1), y=(0, 10), xlabel="x", ylabel="y")
>>> panel.line([0, 1], [0, 10])
>>> figure.text().startswith("<svg")
True
"""

from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Distinguishable with the common kinds of colour blindness (Okabe and Ito 2008), the yellow darkened for white.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b8860b", "#7f5bd5", "#444444")
INK, FAINT, HAIR = "#222", "#888", "#d5d5d5"


class Figure:
    """A card of its own background, so that it can be read on a light page and on a dark one."""

    def __init__(self, *, width: int, height: int) -> None:
        self._size = width, height
        self._parts: list[str] = []

    def panel(
        self,
        at: tuple[float, float, float, float],
        *,
        x: tuple[float, float],
        y: tuple[float, float],
        title: str = "",
        xlabel: str = "",
        ylabel: str = "",
        log: bool = False,
    ) -> "Panel":
        """Return axes at (left, top, width, height) px that span `x` and `y`; `log` makes y logarithmic."""
        return Panel(self._parts, at, x=x, y=y, title=title, xlabel=xlabel, ylabel=ylabel, log=log)

    def words(self, x: float, y: float, text: str, *, size: int = 13, colour: str = INK, anchor: str = "start") -> None:
        """Write at a place in px."""
        self._parts.append(_words(x, y, text, size=size, colour=colour, anchor=anchor))

    def box(self, at: tuple[float, float, float, float], *, fill: str, stroke: str = "none") -> None:
        """Draw a filled rectangle (left, top, width, height) in px."""
        x, y, w, h = at
        self._parts.append(f'<rect x="{x:g}" y="{y:g}" width="{w:g}" height="{h:g}" fill="{fill}" stroke="{stroke}"/>')

    def circle(self, x: float, y: float, radius: float, *, fill: str = "none", stroke: str = INK) -> None:
        """Draw a circle about a place in px."""
        self._parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{fill}" stroke="{stroke}"/>')

    def path(
        self, points: ArrayLike, *, colour: str = INK, width: float = 1.5, dash: str = "none", arrow: bool = False
    ) -> None:
        """Draw a line through places (n, 2) in px, with a head at its end if it is an arrow."""
        places = np.asarray(points, dtype=float)
        line = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        style = f'fill="none" stroke="{colour}" stroke-width="{width:g}" stroke-dasharray="{dash}"'
        self._parts.append(f'<path d="{line}" {style} stroke-linejoin="round"/>')
        if arrow:
            along = places[-1] - places[-2]
            along *= (4 + 2 * width) / np.hypot(*along)
            across = np.array([-along[1], along[0]]) * 0.4
            head = [places[-1], places[-1] - along + across, places[-1] - along - across]
            self._parts.append(f'<path d="M{"L".join(f"{x:.1f} {y:.1f}" for x, y in head)}Z" fill="{colour}"/>')

    def key(self, x: float, y: float, entries: Sequence[tuple[str, str]]) -> None:
        """List (colour, meaning) from a place in px downwards."""
        for i, (colour, meaning) in enumerate(entries):
            self.box((x, y + 18 * i - 9, 10, 10), fill=colour)
            self.words(x + 16, y + 18 * i, meaning, size=12)

    def key_row(self, x: float, y: float, entries: Sequence[tuple[str, str]]) -> None:
        """List (colour, meaning) from a place in px to the right."""
        for colour, meaning in entries:
            self.box((x, y - 9, 10, 10), fill=colour)
            self.words(x + 16, y, meaning, size=12)
            x += 30 + 7.2 * len(meaning)

    def text(self) -> str:
        """Return the SVG."""
        width, height = self._size
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="system-ui, Helvetica, Arial, sans-serif">\n'
            f'<rect width="{width}" height="{height}" rx="6" fill="#fff"/>\n' + "\n".join(self._parts) + "\n</svg>\n"
        )

    def save(self, path: Path, *, origin: str = "") -> None:
        """Write it, with what made it as a comment at its end."""
        path.write_text(self.text() + (f"<!-- {origin} -->\n" if origin else ""), encoding="utf-8")
        print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


class Panel:
    """Axes with what is drawn in them, in the units of the data."""

    def __init__(
        self,
        parts: list[str],
        at: tuple[float, float, float, float],
        *,
        x: tuple[float, float],
        y: tuple[float, float],
        title: str,
        xlabel: str,
        ylabel: str,
        log: bool,
    ) -> None:
        self._parts = parts
        self._at = at
        self._x = x
        self._y = (float(np.log10(y[0])), float(np.log10(y[1]))) if log else y
        self.log = log
        left, top, width, height = at
        clip = f"c{len(parts)}"
        self._clip = f'clip-path="url(#{clip})"'
        frame = f'x="{left:g}" y="{top:g}" width="{width:g}" height="{height:g}"'
        parts.append(f'<clipPath id="{clip}"><rect {frame}/></clipPath><rect {frame} fill="none" stroke="{FAINT}"/>')
        self._ticks()
        parts.append(_words(left + width / 2, top - 7, title, size=13, anchor="middle"))
        parts.append(_words(left + width / 2, top + height + 33, xlabel, size=12, anchor="middle"))
        turn = f"translate({left - 36:g},{top + height / 2:g}) rotate(-90)"
        parts.append(f'<g transform="{turn}">{_words(0, 0, ylabel, size=12, anchor="middle")}</g>' if ylabel else "")

    def points(self, points: ArrayLike, *, colour: str = COLOURS[0], size: float = 3.0) -> None:
        """Draw dots at (n, 2)."""
        path = "".join(f"M{x}h0" for x in self._places(points))
        self._stroke(path, colour, size, 'stroke-linecap="round"')

    def crosses(self, points: ArrayLike, *, colour: str = INK) -> None:
        """Draw crosses at (n, 2)."""
        path = "".join(f"M{x}m-4 -4l8 8m-8 0l8 -8" for x in self._places(points))
        self._stroke(path, colour, 1.5)

    def rings(self, points: ArrayLike, *, colour: str = INK, radius: float = 6.0, width: float = 1.5) -> None:
        """Draw circles of a radius in px about (n, 2)."""
        r = f"{radius:g}"
        path = "".join(
            f"M{x}m-{r} 0a{r} {r} 0 1 0 {2 * radius:g} 0a{r} {r} 0 1 0 -{2 * radius:g} 0" for x in self._places(points)
        )
        self._stroke(path, colour, width)

    def line(
        self, x: ArrayLike, y: ArrayLike, *, colour: str = COLOURS[0], width: float = 1.5, dash: str = "none"
    ) -> None:
        """Draw a line through (n,) and (n,)."""
        places = self._places(np.column_stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)]))
        self._stroke("M" + "L".join(places), colour, width, f'stroke-dasharray="{dash}" stroke-linejoin="round"')

    def straightened(self, x: ArrayLike, y: ArrayLike, *, within: float) -> tuple[NDArray, NDArray]:
        """Return as few points of a line as stay within so many px of all of them (Douglas and Peucker 1973)."""
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        places = self._px(np.column_stack([x, y]))
        kept, pieces = {0, len(x) - 1}, [(0, len(x) - 1)]
        while pieces:
            first, last = pieces.pop()
            along = places[last] - places[first]
            off = places[first : last + 1] - places[first]
            away = np.abs(along[0] * off[:, 1] - along[1] * off[:, 0]) / max(float(np.hypot(*along)), 1e-9)
            farthest = first + int(np.argmax(away))
            if away.max() > within:
                kept.add(farthest)
                pieces += [(first, farthest), (farthest, last)]
        chosen = sorted(kept)
        return x[chosen], y[chosen]

    def circle(self, centre: ArrayLike, radius: float, *, colour: str = INK) -> None:
        """Draw a dashed circle with a radius in units of the data."""
        turn = np.linspace(0, 2 * np.pi, 49)
        x, y = np.asarray(centre, dtype=float)
        self.line(x + radius * np.cos(turn), y + radius * np.sin(turn), colour=colour, width=1, dash="3 3")

    def box(self, low: ArrayLike, high: ArrayLike, *, colour: str = INK) -> None:
        """Draw a dashed rectangle between two corners (2,)."""
        (x0, y0), (x1, y1) = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        self.line([x0, x1, x1, x0, x0], [y0, y0, y1, y1, y0], colour=colour, width=1.2, dash="5 3")

    def levels(self, fun: Callable[[NDArray], NDArray], values: Sequence[float]) -> None:
        """Draw the level curves of fun, (n, 2) -> (n,), thin and grey."""
        x, y = np.linspace(*self._x, 61), np.linspace(*self._y, 61)
        grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        f = fun(grid.reshape(-1, 2)).reshape(grid.shape[:2])
        path = "".join("M" + "L".join(piece) for value in values for piece in self._crossings(grid, f - value))
        self._stroke(path, HAIR, 1)

    def note(self, x: float, y: float, text: str, *, colour: str = INK, anchor: str = "start", size: int = 12) -> None:
        """Write at a place in units of the data."""
        px, py = self._px(np.array([[x, y]]))[0]
        self._parts.append(_words(px, py, text, size=size, colour=colour, anchor=anchor))

    def _crossings(self, grid: NDArray, f: NDArray) -> list[list[str]]:
        """Return the pieces of the curve f = 0: each cell is cut into two triangles, crossed along a straight line."""
        n = len(f) - 1
        corner = {(i, j): (grid[i : n + i, j : n + j], f[i : n + i, j : n + j]) for i in (0, 1) for j in (0, 1)}
        pieces = []
        for third in ((1, 0), (0, 1)):
            triangle = [corner[0, 0], corner[1, 1], corner[third]]
            cuts = np.stack([_cut(*triangle[k - 1], *triangle[k]) for k in range(3)])  # (edge, i, j, 2)
            crossed = np.isfinite(cuts[..., 0])
            for i, j in np.argwhere(crossed.sum(axis=0) == 2):
                pieces.append(cuts[crossed[:, i, j], i, j])
        return [self._places(piece) for piece in pieces]

    def _stroke(self, path: str, colour: str, width: float, more: str = "") -> None:
        self._parts.append(
            f'<path {self._clip} d="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}" {more}/>'
        )

    def _px(self, points: NDArray) -> NDArray:
        left, top, width, height = self._at
        x, y = points.T
        y = np.log10(y) if self.log else y
        across = (x - self._x[0]) / (self._x[1] - self._x[0])
        up = (y - self._y[0]) / (self._y[1] - self._y[0])
        return np.column_stack([left + width * across, top + height * (1 - up)])

    def _places(self, points: ArrayLike) -> list[str]:
        return [f"{x:.1f} {y:.1f}" for x, y in self._px(np.asarray(points, dtype=float).reshape(-1, 2))]

    def _ticks(self) -> None:
        left, top, width, height = self._at
        for x in _round_numbers(*self._x):
            px = left + width * (x - self._x[0]) / (self._x[1] - self._x[0])
            self._parts.append(f'<path d="M{px:.1f} {top + height:g}v4" stroke="{FAINT}"/>')
            self._parts.append(_words(px, top + height + 17, f"{x:g}", size=11, anchor="middle"))
        for y in _decades(*self._y) if self.log else _round_numbers(*self._y):
            py = top + height * (1 - (y - self._y[0]) / (self._y[1] - self._y[0]))
            self._parts.append(f'<path d="M{left:g} {py:.1f}h-4" stroke="{FAINT}"/>')
            self._parts.append(_words(left - 7, py + 4, _power(y) if self.log else f"{y:g}", size=11, anchor="end"))


def _cut(a: NDArray, fa: NDArray, b: NDArray, fb: NDArray) -> NDArray:
    """Return where f passes zero between places a and b (..., 2); NaN where it does not."""
    passes = (fa < 0) != (fb < 0)
    share = np.where(passes, fa / np.where(passes, fa - fb, 1.0), np.nan)
    return a + share[..., None] * (b - a)


def _round_numbers(low: float, high: float) -> list[float]:
    """Return three to six round numbers between two ends.

    >>> _round_numbers(-5, 5)
    [-4.0, -2.0, 0.0, 2.0, 4.0]
    """
    step = 10.0 ** np.floor(np.log10((high - low) / 3))
    while (high - low) / step > 6:
        step *= 2 if f"{step:e}"[0] in "15" else 2.5
    return [round(i * step, 10) for i in range(int(np.ceil(low / step)), int(np.floor(high / step + 1e-9)) + 1)]


def _decades(low: float, high: float) -> list[float]:
    step = max(1, round((high - low) / 5))
    return [float(i) for i in range(int(np.ceil(low)), int(np.floor(high)) + 1, step)]


def _power(exponent: float) -> str:
    return f"{10**exponent:g}" if -2 <= exponent <= 3 else "1e" + f"{exponent:g}"


def _words(x: float, y: float, text: str, *, size: int, anchor: str = "start", colour: str = INK) -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" text-anchor="{anchor}"'
    return f"<text {place}>{escape(text)}</text>" if text else ""
