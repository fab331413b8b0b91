"""A Bode plot of one probe in Rerun: amplitude above phase lag against speed."""

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import lag_degrees, nice
from rotorrig.app.text import AS_STATED, AmplitudeUnit
from rotorrig.app.viewer.plots.axes import Panel, below_one_another, legend, step_for
from rotorrig.rig.config import RPM, RigConfig

SMALLEST_BODE = 10e-6  # m
FASTEST = 4000.0  # rpm, where the config sets no limit
MARKED = 52.0, 6.0  # view units: the middle of the first line of what marks say
Colour = tuple[int, int, int]
Panels = tuple[Panel, Panel]  # amplitude, phase lag


class BodePicture:
    """One probe: amplitude above phase lag against speed; the axes grow with what is drawn."""

    def __init__(
        self,
        stream: rr.RecordingStream,
        path: str,
        *,
        title: str,
        fastest: float,
        static: bool = False,
        unit: AmplitudeUnit = AS_STATED,
    ) -> None:
        self._stream = stream
        self._by = unit.by
        self._path = path
        self._title = title
        self._static = static
        self._largest = SMALLEST_BODE * unit.by
        self._fastest = fastest
        self._drawn: Panels | None = None

    def panels(self, largest: float, fastest: float, *, lag_from: float = 0.0) -> Panels:
        """Return amplitude and phase axes that hold `largest` [m] and `fastest` [rpm], drawn where they are new."""
        self._largest, self._fastest = max(self._largest, nice(largest * self._by)), max(self._fastest, fastest)
        wide: tuple[float, float] = (0.0, self._fastest)
        step = step_for(self._fastest, most=8)
        amplitude = Panel(
            left=0, top=0, width=186, height=52, x=wide, y=(0.0, self._largest), x_step=step,
            y_step=step_for(self._largest, most=5), title=self._title,
        )  # fmt: skip
        lag = Panel(
            left=0, top=66, width=186, height=34, x=wide, y=(lag_from, lag_from + 360), x_step=step,
            y_step=90,
            y_turn=360, title="phase lag, °", x_title="speed, rpm",
        )  # fmt: skip
        if (amplitude, lag) != self._drawn:
            amplitude.log(self._stream, f"{self._path}/amplitude/axes", static=self._static)
            lag.log(self._stream, f"{self._path}/phase/axes", static=self._static)
            self._drawn = (amplitude, lag)
        return amplitude, lag

    def line(
        self,
        name: str,
        panels: Panels,
        rpm: NDArray[np.float64],
        z: NDArray[np.complex128],
        colour: Colour,
        *,
        order: float = 2.0,
    ) -> None:
        """Draw z (point,) [m] as a line called `name` in both panels; a higher `order` lies on top."""
        amplitude, lag = panels
        lags = lag_degrees(z, start=lag.y[0])
        self._strips(f"amplitude/{name}", amplitude.strips(rpm, np.abs(z) * self._by), colour, order)
        self._strips(f"phase/{name}", lag.strips(rpm, lags, jump=180.0), colour, order)

    def dots(
        self,
        name: str,
        panels: Panels,
        rpm: NDArray[np.float64],
        z: NDArray[np.complex128],
        colour: Colour,
        *,
        radius: float = 1.5,
        order: float = 1.0,
        moving: bool = False,
    ) -> None:
        """Draw z (point,) [m] as dots called `name` in both panels; a higher `order` lies on top.

        Those that are `moving` stand at the stream's time in a static picture too.
        """
        amplitude, lag = panels
        values = np.abs(z) * self._by, lag_degrees(z, start=lag.y[0])
        for part, panel, y in zip(("amplitude", "phase"), (amplitude, lag), values, strict=True):
            places = panel.place(rpm, y)
            places = places[np.isfinite(places).all(axis=1)]
            dots = rr.Points2D(places, colors=colour, radii=-radius, draw_order=order)
            self._stream.log(f"{self._path}/{part}/{name}", dots, static=self._static and not moving)

    def mark_speeds(self, name: str, panels: Panels, marks: Sequence[tuple[float, str, Colour]]) -> None:
        """Draw an upright line through both panels at each speed [rpm]; what they say stands at the top left."""
        strips = [panel.place(np.array([rpm, rpm]), np.array(panel.y)) for rpm, _, _ in marks for panel in panels]
        colours = [colour for _, _, colour in marks for _ in panels]
        lines = rr.LineStrips2D(strips, colors=colours, radii=-0.6)
        self._stream.log(f"{self._path}/{name}/lines", lines, static=self._static)
        words = legend([(words, colour) for _, words, colour in marks], below_one_another(*MARKED))
        self._stream.log(f"{self._path}/{name}/words", words, static=self._static)

    def _strips(self, path: str, strips: list[NDArray[np.float64]], colour: Colour, order: float) -> None:
        lines = rr.LineStrips2D(strips, colors=colour, radii=-0.9, draw_order=order)
        self._stream.log(f"{self._path}/{path}", lines, static=self._static)


def fastest_rpm(rig: RigConfig) -> float:
    """Return the speed a Bode plot of this rig should reach [rpm]: its fastest plan, else its limit."""
    speeds = [plan.fastest for plan in rig.plans.values()]
    speeds += [rig.limits.overspeed] if rig.limits and not speeds else []
    return 100.0 * np.ceil(max(speeds) * RPM / 100.0 - 1e-6) if speeds else FASTEST
