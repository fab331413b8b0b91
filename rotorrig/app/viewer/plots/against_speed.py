"""Lines against shaft speed in Rerun: forward and backward whirl, gap voltages, whatever has a value per row."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import nice
from rotorrig.app.viewer.plots.axes import Colour, Panel, legend, step_for

WIDTH, HEIGHT = 186.0, 80.0
FLATTEST = 1.0  # the axis spans no less, unless it is told otherwise
Line = tuple[str, NDArray[np.float64], NDArray[np.float64], Colour]  # name, rpm (point,), value (point,), colour


class SpeedPicture:
    """Values against speed in rpm, every colour with its name; drawn once."""

    def __init__(
        self, stream: rr.RecordingStream, path: str, *, title: str, fastest: float, flattest: float = FLATTEST
    ) -> None:
        self._stream = stream
        self._path = path
        self._title = title
        self._fastest = fastest
        self._flattest = flattest

    def draw(self, lines: Sequence[Line], *, names: Sequence[tuple[str, Colour]] = ()) -> None:
        """Draw the lines, NaN breaks one, and words in their colours."""
        finite = [y[np.isfinite(y)] for _, _, y, _ in lines]
        low = min((float(y.min()) for y in finite if len(y)), default=0.0)
        high = max((float(y.max()) for y in finite if len(y)), default=0.0)
        bottom = -nice(max(-low, self._flattest / 2)) if low < 0 else 0.0
        top = nice(max(high, self._flattest / 2 if low < 0 else self._flattest))
        panel = Panel(
            left=0, top=0, width=WIDTH, height=HEIGHT, x=(0.0, self._fastest), y=(bottom, top),
            x_step=step_for(self._fastest, most=8), y_step=step_for(top - bottom, most=6), x_title="speed, rpm",
            title=self._title,
        )  # fmt: skip
        panel.log(self._stream, f"{self._path}/axes", static=True)
        for name, rpm, y, colour in lines:
            strips = rr.LineStrips2D(panel.strips(rpm, y), colors=colour, radii=-1.0, draw_order=2.0)
            self._stream.log(f"{self._path}/{name}", strips, static=True)
        self._draw_legend(names)

    def _draw_legend(self, words: Sequence[tuple[str, Colour]]) -> None:
        places = [(WIDTH * (i + 0.5) / len(words), HEIGHT + 20.0) for i in range(len(words))]
        self._stream.log(f"{self._path}/legend", legend(words, places), static=True)
