"""One probe plane in Rerun: orbits to a scale that follows them, with the keyphasor dot."""

from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import MARK, Panel, step_for, texts
from rotorrig.app.viewer.plots.scale import FollowingScale

SMALLEST_ORBIT = 1e-6  # m, half width
Colour = tuple[int, int, int]


class OrbitPicture:
    """One probe plane: x to the right, y up, in a unit of length, with the keyphasor dot."""

    def __init__(self, stream: rr.RecordingStream, path: str, *, unit: AmplitudeUnit = AS_STATED) -> None:
        self._stream = stream
        self._path = path
        self._scale = FollowingScale(SMALLEST_ORBIT * unit.by_length)
        self._captions: dict[str, str] = {}
        self._length = unit.length
        self._panel().log(stream, f"{path}/axes")

    def draw(
        self,
        orbits: Sequence[tuple[str, NDArray[np.float64], Colour]],
        dots: NDArray[np.float64] | Mapping[str, NDArray[np.float64]],
    ) -> None:
        """Draw named orbits (point, 2) in the unit, the last on top, NaN breaks a line, and dots (dot, 2) at edges.

        Dots by the orbits' names stand with their orbit, for a view that shows one orbit alone.
        """
        reach = max((float(np.nanmax(np.abs(xy))) for _, xy, _ in orbits if np.isfinite(xy).any()), default=0.0)
        if self._scale.follow(reach):
            self._panel().log(self._stream, f"{self._path}/axes")
        panel = self._panel()
        for i, (name, xy, colour) in enumerate(orbits):
            line = rr.LineStrips2D(panel.strips(*xy.T), colors=colour, radii=-1.0, draw_order=float(i))
            self._stream.log(f"{self._path}/{name}", line)
        named = dots.items() if isinstance(dots, Mapping) else [("", dots)]
        for name, at in named:
            places = panel.place(*at.T) if len(at) else np.empty((0, 2))
            path = f"{self._path}/{name}/keyphasor" if name else f"{self._path}/keyphasor"
            self._stream.log(path, rr.Points2D(places, radii=-5.0, colors=MARK, draw_order=len(orbits)))

    def caption(self, words: str, *, name: str = "caption") -> None:
        """Write a line below the picture; one of another name is for another view of it."""
        if words != self._captions.get(name):
            self._stream.log(f"{self._path}/{name}", texts([(50.0, 120.5, words)]))
            self._captions[name] = words

    def _panel(self) -> Panel:
        return orbit_panel(self._scale.value, unit=self._length)


def orbit_panel(scale: float, *, unit: str = "µm") -> Panel:
    """Return the axes of an orbit, plus and minus `scale` both ways, in a unit of length."""
    both, step = (-scale, scale), step_for(2 * scale, most=5)
    return Panel(
        left=0, top=0, width=100, height=100, x=both, y=both, x_step=step, y_step=step, x_title=f"x, {unit}",
        title=f"y, {unit}",
    )  # fmt: skip
