"""The time base beside an orbit in Rerun: both probes of a plane over the last turns, with dots at the keyphasor."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import MARK, UP, Panel, step_for, texts
from rotorrig.app.viewer.plots.scale import FollowingScale

SMALLEST = 1e-6  # m
WIDTH, HEIGHT, APART = 150.0, 44.0, 12.0
X_TITLE = "turns, 0 at the last edge"


class TimeBasePicture:
    """Two probes, one above the other, to the same scale; the last edge of the keyphasor is at the right."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        path: str,
        *,
        probes: tuple[str, str],
        turns: int,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        self._stream = stream
        self._path = path
        self._probes = probes
        self._turns = turns
        self._length = unit.length
        self._scale = FollowingScale(SMALLEST * unit.by_length)
        self._draw_axes()

    def draw(self, turn: NDArray[np.float64], x: NDArray[np.float64], dots: NDArray[np.float64], *, words: str) -> None:
        """Draw x (point, 2) in the unit over `turn` (point,), 0 at the last edge, `dots` (turn + 1, 2), and words."""
        if self._scale.follow(float(np.abs(x).max())):
            self._draw_axes()
        edges = np.arange(1.0 - len(dots), 1.0)
        strips, places = [], []
        for panel, values, at_edges in zip(self._panels(), x.T, dots.T, strict=True):
            strips += panel.strips(turn, values)
            places.append(panel.place(edges, at_edges))
        self._stream.log(f"{self._path}/waveforms", rr.LineStrips2D(strips, colors=UP, radii=-1.0))
        marks = rr.Points2D(np.vstack(places), radii=-4.0, colors=MARK, draw_order=1.0)
        self._stream.log(f"{self._path}/keyphasor", marks)
        self._stream.log(f"{self._path}/words", texts([(WIDTH / 2, 2 * HEIGHT + APART + 21.0, words)]))

    def _panels(self) -> list[Panel]:
        """Return the axes of either probe."""
        scale, wide = self._scale.value, (-float(self._turns), 0.0)
        return [
            Panel(
                left=0, top=i * (HEIGHT + APART), width=WIDTH, height=HEIGHT, x=wide, y=(-scale, scale), x_step=0.5,
                y_step=step_for(2 * scale, most=4), title=f"{name}, {self._length}", x_title=X_TITLE if i else "",
            )
            for i, name in enumerate(self._probes)
        ]  # fmt: skip

    def _draw_axes(self) -> None:
        for i, panel in enumerate(self._panels()):
            panel.log(self._stream, f"{self._path}/axes/{i}")
