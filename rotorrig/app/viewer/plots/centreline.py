"""The shaft centreline of one probe plane in Rerun: mean position over speed, within the bearing's clearance.

A journal at rest lies at the bottom of its bearing, so the clearance circle stands on the point the path is counted
from (Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002, ch. 6). That is right at a plain bearing;
a plane of probes away from it sees the bending of the shaft as well.
"""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import BEYOND, SMALLEST_PATH, nice
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import INK, MARK, SOFT, Panel, step_for
from rotorrig.rig.config import UM

ROUND = np.radians(np.linspace(0.0, 360.0, 181))
UPWARDS = {"-y": (0.0, 1.0), "-x": (1.0, 0.0), "none": (0.0, 0.0)}  # by the config's `gravity`
Colour = tuple[int, int, int]
Label = tuple[float, float, str]  # x, y in the unit, words


class CentrelinePicture:
    """One probe plane: mean position in a unit of length from where the shaft lay first, x to the right, y up."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        path: str,
        *,
        clearance: float | None,
        gravity: str = "-y",
        title: str = "",
        static: bool = False,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        """`clearance` is the bearing's, diametral, in the unit; None draws no circle. `gravity` as in the config."""
        self._stream = stream
        self._path = path
        self._length = unit.length
        self._title = title or f"y, {unit.length}"
        self._static = static
        self._radius = (clearance or 0.0) / 2
        self._middle = np.array(UPWARDS[gravity]) * self._radius  # of circle and axes, from the reference
        self._reach = BEYOND * self._radius or SMALLEST_PATH / UM * unit.by_length
        self._panel = self._draw_axes()

    def draw(self, paths: Sequence[tuple[str, NDArray[np.float64], Colour]], *, labels: Sequence[Label] = ()) -> None:
        """Draw named paths (point, 2) in the unit, NaN breaks one, and marked points with words beside them."""
        self._grow(max((_reach(xy - self._middle) for _, xy, _ in paths), default=0.0))
        for name, xy, colour in paths:
            strips = self._panel.strips(*xy.T)
            self._log(name, rr.LineStrips2D(strips, colors=colour, radii=-1.0, draw_order=2.0))
        if labels:
            places = np.vstack([self._panel.place([x], [y]) for x, y, _ in labels])
            words = [words for *_, words in labels]
            marks = rr.Points2D(places, labels=words, show_labels=True, colors=INK, radii=-2.2, draw_order=3.0)
            self._log("labels", marks)

    def dot(self, xy: NDArray[np.float64]) -> None:
        """Draw one point (2,) in the unit as a dot on top: where the shaft is."""
        self._grow(_reach(xy - self._middle))
        place = self._panel.place(xy[:1], xy[1:])
        self._stream.log(f"{self._path}/now", rr.Points2D(place, radii=-4.5, colors=MARK, draw_order=4.0))

    def _grow(self, reach: float) -> None:
        if reach > self._reach:
            self._reach = nice(1.05 * reach)
            self._panel = self._draw_axes()

    def _draw_axes(self) -> Panel:
        """Draw the axes anew, and the circle of the bearing if it has one."""
        panel = centreline_panel(self._reach, middle=self._middle, title=self._title, unit=self._length)
        panel.log(self._stream, f"{self._path}/axes", static=self._static)
        if self._radius:
            x, y = self._middle[:, None] + self._radius * np.array([np.cos(ROUND), np.sin(ROUND)])
            circle = rr.LineStrips2D([panel.place(x, y)], colors=SOFT, radii=-1.2, draw_order=1.0)
            self._log("clearance", circle)
        return panel

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=self._static)


def centreline_panel(reach: float, *, middle: NDArray[np.float64], title: str, unit: str = "µm") -> Panel:
    """Return axes of `reach` either way about `middle` (2,), in a unit of length."""
    step = step_for(2 * reach, most=5)
    x, y = middle
    return Panel(
        left=0, top=0, width=100, height=100, x=(x - reach, x + reach), y=(y - reach, y + reach),
        x_step=step, y_step=step, x_title=f"x, {unit}", title=title,
    )  # fmt: skip


def _reach(xy: NDArray[np.float64]) -> float:
    """Return the largest |x| or |y| that is a number, 0 without any."""
    return float(np.nanmax(np.abs(xy))) if np.isfinite(xy).any() else 0.0
