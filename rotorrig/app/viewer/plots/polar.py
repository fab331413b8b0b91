"""A polar plot of one probe in Rerun: the paths of its vectors, 0° of phase lag at the probe, lag against rotation.

So drawn, a vector points to where the shaft's high spot is at the keyphasor edge, seen along the axis with x to the
right and y up; two probes that see a circular orbit show the same picture.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from rotorrig.app.plot_data import nice
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import GRID, INK, SOFT, Panel, step_for, texts, ticks

SMALLEST = 1e-6  # m, the radius of the outer circle
CIRCLES, SPOKE = 4, 30.0  # at most so many circles; degrees between spokes
APART = 0.2  # of the outer circle's radius: speed labels nearer to one another are left out
EVERY = 100.0  # rpm: labelled speeds are multiples of it
ROUND = np.radians(np.linspace(0.0, 360.0, 121))
Colour = tuple[int, int, int]


class PolarPicture:
    """Vectors of one probe, in a unit of amplitude, and phase lags; the outer circle grows with what is drawn."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        path: str,
        *,
        title: str,
        probe_angle: float = 0.0,
        rotation: str = "x-to-y",
        static: bool = False,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        """`probe_angle` [rad] from +x towards +y and `rotation`, "x-to-y" or "y-to-x", as in the config."""
        self._stream = stream
        self._path = path
        self._title = title
        self._zero = probe_angle
        self._sense = 1 if rotation == "x-to-y" else -1
        self._static = static
        self._by = unit.by
        self._reach = 0.0

    def draw(
        self,
        curves: Sequence[tuple[str, NDArray[np.complex128], Colour]],
        *,
        rpm: Mapping[str, NDArray[np.float64]] | None = None,
    ) -> None:
        """Draw named paths z (point,) [m], a later one on top; NaN breaks one.

        `rpm` gives the speeds (point,) of a path, to label it.
        """
        self._grow(np.concatenate([z for _, z, _ in curves]) if curves else np.empty(0, dtype=complex))
        for i, (name, z, colour) in enumerate(curves):
            order = 2.0 + i / len(curves)
            lines = rr.LineStrips2D(self._panel.strips(*self._xy(z)), colors=colour, radii=-1.1, draw_order=order)
            self._log(name, lines)
            if rpm is not None and name in rpm:
                self._log(f"{name}/speeds", self._speeds(z, rpm[name], colour))

    def dots(self, name: str, z: NDArray[np.complex128], colour: Colour, *, radius: float = 1.5) -> None:
        """Draw vectors z (point,) [m] as dots called `name`, on top of the paths, at the stream's time."""
        self._grow(z)
        places = self._panel.place(*self._xy(z))
        places = places[np.isfinite(places).all(axis=1)]
        self._stream.log(f"{self._path}/{name}", rr.Points2D(places, colors=colour, radii=-radius, draw_order=5.0))

    def arrow(self, name: str, z: NDArray[np.complex128], colour: Colour) -> None:
        """Draw an arrow called `name` from the one of two vectors z (2,) [m] to the other, on top of the paths."""
        self._grow(z)
        start, end = self._panel.place(*self._xy(z))
        self._log(name, rr.Arrows2D(origins=[start], vectors=[end - start], colors=colour, radii=-2.0, draw_order=4.0))

    def _xy(self, z: NDArray[np.complex128]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return where vectors [m] are drawn, x and y in the unit: against rotation from the probe by the lag."""
        seen = (z if self._sense > 0 else np.conj(z)) * np.exp(1j * self._zero) * self._by
        return seen.real, seen.imag

    @property
    def _panel(self) -> Panel:
        both, none = (-self._reach, self._reach), math.inf
        return Panel(left=0, top=0, width=100, height=100, x=both, y=both, x_step=none, y_step=none)

    def _grow(self, z: NDArray[np.complex128]) -> None:
        """Draw the axes anew if a vector z (point,) [m] lies beyond the outer circle."""
        reach = float(np.nanmax(np.abs(z))) * self._by if np.isfinite(z).any() else 0.0
        wanted = max(nice(1.1 * reach), SMALLEST * self._by)
        if wanted <= self._reach:
            return
        self._reach = wanted
        radii = ticks(0.0, wanted, step_for(wanted, most=CIRCLES))[1:]
        lags = np.arange(0.0, 360.0, SPOKE)
        grid: list[ArrayLike] = [r * np.exp(1j * ROUND) for r in radii if r < wanted]
        grid += [np.array([0.0, wanted]) * self._way(lag) for lag in lags]
        edge = [wanted * np.exp(1j * ROUND), np.array([wanted, 1.05 * wanted]) * self._way(0.0)]
        colours = [GRID] * len(grid) + [SOFT, INK]
        lines = [self._to_view(line) for line in (*grid, *edge)]
        self._log("axes/circles", rr.LineStrips2D(lines, colors=colours, radii=-0.5, draw_order=-10))
        self._log("axes/labels", texts(self._labels(radii, lags, clear=_clear_lag(z, lags + SPOKE / 2))))
        self._draw_rotation()

    def _way(self, lag: float) -> complex:
        """Return the direction in which a phase lag [deg] is drawn."""
        return complex(np.exp(1j * (self._zero - self._sense * math.radians(lag))))

    def _to_view(self, xy: ArrayLike) -> NDArray[np.float64]:
        """Return the view's coordinates (point, 2) of places x + jy (point,) in the unit."""
        at = np.asarray(xy, dtype=complex)
        return self._panel.place(at.real, at.imag)

    def _labels(
        self, radii: Sequence[float], lags: NDArray[np.float64], *, clear: float
    ) -> list[tuple[float, float, str]]:
        """Return the labels of the spokes, and of the circles along the lag `clear` [deg], and the title."""
        spokes = [(1.12 * self._reach * self._way(lag), f"{lag:g}°") for lag in lags]
        circles = [(radius * self._way(clear), f"{radius:g}") for radius in radii]
        places = self._to_view(np.array([at for at, _ in (*spokes, *circles)]))
        labels = [(x, y, words) for (x, y), (_, words) in zip(places, (*spokes, *circles), strict=True)]
        return [*labels, (50.0, -15.0, self._title)]

    def _draw_rotation(self) -> None:
        """Draw an arrow on an arc outside the circle, in the sense of rotation, at the lower left."""
        arc = np.radians(225.0 + self._sense * np.linspace(-9.0, 9.0, 10))
        line = 1.36 * self._reach * np.exp(1j * arc)
        out = np.exp(1j * arc[-1])
        along = 1j * self._sense * out
        head = line[-1] + 0.05 * self._reach * np.array([0.7 * out - along, 0.0, -0.7 * out - along])
        strips = [self._to_view(line), self._to_view(head)]
        self._log("axes/rotation", rr.LineStrips2D(strips, colors=SOFT, radii=-0.9, draw_order=-10))
        ((x, y),) = self._to_view(np.array([1.36 * self._reach * np.exp(1j * np.radians(225.0))]))
        self._log("axes/rotation/word", texts([(x + 1.0, y + 11.0, "rotation")]))

    def _speeds(self, z: NDArray[np.complex128], rpm: NDArray[np.float64], colour: Colour) -> rr.Points2D:
        """Return marks with the speed at them, where the path passes multiples of EVERY rpm."""
        x, y = self._xy(z)
        at = speed_marks(rpm, x + 1j * y, apart=APART * self._reach)
        places = self._panel.place(x[at], y[at])
        words = [f"{EVERY * round(float(rpm[i]) / EVERY):.0f}" for i in at]
        return rr.Points2D(places, labels=words, show_labels=True, colors=colour, radii=-2.2, draw_order=4.0)

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=self._static)


def _clear_lag(z: NDArray[np.complex128], lags: NDArray[np.float64]) -> float:
    """Return the one of `lags` [deg] in whose direction the vectors z (point,) reach least far."""
    finite = z[np.isfinite(z)]
    if not finite.size:
        return float(lags[0])
    reach = (np.conj(np.exp(-1j * np.radians(lags)))[:, None] * finite).real.max(axis=1)
    return float(lags[np.argmin(reach)])


def speed_marks(rpm: NDArray[np.float64], xy: NDArray[np.complex128], *, apart: float) -> list[int]:
    """Return the points nearest to whole multiples of EVERY rpm, those left out that lie within `apart` of another.

    >>> path = np.linspace(0, 1, 11) + 0j  # from 1000 to 2000 rpm along a line
    >>> speed_marks(np.linspace(1000, 2000, 11), path, apart=0.35)
    [0, 4, 8]
    """
    finite = np.flatnonzero(np.isfinite(rpm) & np.isfinite(xy))
    if not finite.size:
        return []
    low, high = math.ceil(rpm[finite].min() / EVERY), math.floor(rpm[finite].max() / EVERY)
    kept: list[int] = []
    for speed in EVERY * np.arange(low, high + 1):
        nearest = int(finite[np.argmin(np.abs(rpm[finite] - speed))])
        if all(abs(xy[nearest] - xy[other]) >= apart for other in kept):
            kept.append(nearest)
    return kept
