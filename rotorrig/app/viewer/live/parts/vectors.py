"""Bode and polar plots of a sweep: 1X of every probe over speed, rising and falling, less the slow roll once known."""

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from rotorrig.app.plot_data import phase_window
from rotorrig.app.text import AmplitudeUnit
from rotorrig.app.viewer.live.data import WAYS, SlowRollSoFar, SpeedCurves
from rotorrig.app.viewer.plots import DOWN, MARK, UP, BodePicture, Panels, PolarPicture, fastest_rpm
from rotorrig.rig.config import RigConfig

NAMES, COLOURS = {1: "up", -1: "down"}, {1: UP, -1: DOWN}


class VectorsPart:
    """A Bode and a polar plot per probe. `static` ones show at all times, for curves that are known beforehand."""

    def __init__(self, stream: rr.RecordingStream, rig: RigConfig, *, static: bool, unit: AmplitudeUnit) -> None:
        self._stream = stream
        self._unit = unit
        self._rig = rig
        self._static = static
        self._compensated = False
        self._make_pictures()

    def draw(self, curves: SpeedCurves, slow_roll: SlowRollSoFar) -> None:
        """Draw the curves as they are now."""
        if slow_roll.known != self._compensated:
            self._compensated = slow_roll.known
            self._make_pictures()
        offset = slow_roll.z if slow_roll.known else 0.0
        drawn = {way: curves.points(way) for way in WAYS if curves.count(way)}
        z = {way: points.z - offset for way, points in drawn.items()}
        every = np.concatenate(list(z.values()))
        fastest = max(float(points.rpm.max()) for points in drawn.values())
        for p, (bode, polar) in enumerate(zip(self._bodes, self._polars, strict=True)):
            largest, lag_from = float(np.abs(every[:, p]).max()), phase_window(every[:, p])
            panels = self._panels[p] = bode.panels(largest, fastest, lag_from=lag_from)
            for way, points in drawn.items():
                bode.line(NAMES[way], panels, points.rpm, z[way][:, p], COLOURS[way], order=2.0 if way > 0 else 3.0)
            polar.draw(
                [(NAMES[way], z[way][:, p], COLOURS[way]) for way in drawn],
                rpm={NAMES[way]: points.rpm for way, points in drawn.items()},
            )

    def now(self, rpm: float, z: NDArray[np.complex128], slow_roll: SlowRollSoFar) -> None:
        """Draw the present vectors z (probe,) [m], raw, as dots on top."""
        shown = z - slow_roll.z if self._compensated else z
        for p, (bode, polar) in enumerate(zip(self._bodes, self._polars, strict=True)):
            bode.dots("now", self._panels[p], np.array([rpm]), shown[[p]], MARK, radius=4.0, order=5.0, moving=True)
            polar.dots("now", shown[[p]], MARK, radius=4.0)

    def _make_pictures(self) -> None:
        """Make the pictures anew, under titles that say what is subtracted."""
        word = "less slow roll" if self._compensated else "raw"
        top = fastest_rpm(self._rig)
        self._bodes, self._polars = [], []
        self._panels: list[Panels] = []
        for probe in self._rig.probes:
            title = f"{probe.name}: 1X amplitude, {word}, {self._unit.name}"
            path, static = f"bode/{probe.name}", self._static
            bode = BodePicture(self._stream, path, title=title, fastest=top, static=static, unit=self._unit)
            self._panels.append(bode.panels(0.0, 0.0))
            self._bodes.append(bode)
            polar = PolarPicture(
                self._stream,
                f"polar/{probe.name}",
                title=f"{probe.name}: 1X, {word}, {self._unit.name}; phase lag, °; marks at rpm",
                probe_angle=probe.angle,
                rotation=self._rig.rotation,
                static=static,
                unit=self._unit,
            )
            self._polars.append(polar)
