"""A force against the motion of its place in Rerun: dots as measured, and a line through what a law says."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import nice
from rotorrig.app.viewer.plots import Colour, Panel, legend, step_for

WIDTH, HEIGHT = 186.0, 80.0
Reals = NDArray[np.float64]


class ForceOverMotionPicture:
    """One size of a force per speed, against the size of the motion there; drawn once."""

    def __init__(self, stream: rr.RecordingStream, path: str, *, title: str, unit: str) -> None:
        self._stream = stream
        self._path = path
        self._title = title
        self._unit = unit

    def draw(self, motion: Reals, force: Reals, law: Reals, *, colours: tuple[Colour, Colour]) -> None:
        """Draw force and law (speed,) over motion (speed,) in the unit, the law in the order of the motion."""
        right, top = (nice(float(np.nanmax(values))) for values in (motion, np.concatenate([force, law])))
        panel = Panel(
            left=0, top=0, width=WIDTH, height=HEIGHT, x=(0.0, right), y=(0.0, top), x_step=step_for(right, most=8),
            y_step=step_for(top, most=6), title=self._title,
            x_title=f"motion of the place at 1X, {self._unit}",
        )  # fmt: skip
        panel.log(self._stream, f"{self._path}/axes", static=True)
        by_motion = np.argsort(motion)
        line = panel.strips(motion[by_motion], law[by_motion])
        self._log("law", rr.LineStrips2D(line, colors=colours[1], radii=-1.0, draw_order=1.0))
        self._log("measured", rr.Points2D(panel.place(motion, force), colors=colours[0], radii=-3.0, draw_order=2.0))
        words = [("measured", colours[0]), ("by the law", colours[1])]
        self._log("legend", legend(words, [(WIDTH * share, HEIGHT + 20.0) for share in (0.25, 0.75)]))

    def _log(self, name: str, what: rr.AsComponents) -> None:
        self._stream.log(f"{self._path}/{name}", what, static=True)
