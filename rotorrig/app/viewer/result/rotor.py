"""The rotor of a result in 3D: its deflection over speed, the measured orbits, and its mode shapes.

Two time lines turn it: `speed_rpm`, at the keyphasor edge of every speed, the mode shapes stepping on; and `phase_deg`,
one turn at the speed of the largest deflection.
"""

import math

import numpy as np
import rerun as rr

from rotorrig.app.viewer.plots import UP, RotorPicture
from rotorrig.app.viewer.result.data import Result
from rotorrig.app.viewer.result.rotor_motion import RotorMotion
from rotorrig.rig.config import RPM
from rotorrig.sims.rotor.modes import Mode

DRAWN = 0.09  # of the shaft's length: the largest deflection in the picture
STEP = math.radians(30.0)  # a mode shape turns on by it from one speed to the next
PHASES = range(0, 360, 10)


class RotorScene:
    """Draws the motion of one result's rotor into a stream."""

    def __init__(self, stream: rr.RecordingStream, result: Result, motion: RotorMotion) -> None:
        self._stream = stream
        self._result = result
        self._motion = motion
        self._reach = DRAWN * result.response.rig.shaft.length
        largest = float(np.abs(motion.deflection).max(initial=0.0)) or _largest(result)
        self._scale = exaggeration(largest, self._reach)
        self._deflection = RotorPicture(stream, "deflection", result.response.rig)
        self._modes = [RotorPicture(stream, f"mode/{i}", result.response.rig) for i in range(len(motion.modes))]
        for mode, picture in zip(motion.modes, self._modes, strict=True):
            picture.whirl(motion.z, mode.shape, scale=self._mode_scale(mode), static=True)

    def at_speed(self, step: int) -> None:
        """Draw the deflection at the row number `step` of the motion, and the mode shapes so many steps on."""
        self._draw_deflection(step, 0.0)
        self._draw_modes(step * STEP)

    def turning(self) -> None:
        """Draw one turn of the deflection where it is largest, and of the mode shapes, over `phase_deg`."""
        if not self._motion.rows:
            return
        largest = int(np.argmax(np.abs(self._motion.deflection).max(axis=(1, 2))))
        for degrees in PHASES:
            self._stream.set_time("phase_deg", sequence=degrees)
            self._draw_deflection(largest, math.radians(degrees))
            self._draw_modes(math.radians(degrees))
        self._stream.reset_time()

    def _draw_deflection(self, step: int, angle: float) -> None:
        motion, row = self._motion, self._motion.rows[step]
        shape = motion.deflection[step]
        self._deflection.whirl(motion.z, shape, scale=self._scale)
        self._deflection.bend(motion.z, shape, angle=angle, scale=self._scale)
        if planes := self._result.planes:
            seen = np.array([plane.to_xy @ self._result.z[row, columns] for plane, columns in planes]).T
            places = [plane.position for plane, _ in planes]
            self._deflection.orbits("measured", places, seen, UP, scale=self._scale)
        rpm = self._result.response.omega[row] * RPM
        self._deflection.say(
            f"{rpm:.0f} rpm: 1X of the {motion.model} model, drawn {self._scale:g} times larger; blue: measured orbits"
        )

    def _draw_modes(self, angle: float) -> None:
        for mode, picture in zip(self._motion.modes, self._modes, strict=True):
            picture.bend(self._motion.z, mode.shape, angle=angle, scale=self._mode_scale(mode))

    def _mode_scale(self, mode: Mode) -> float:
        """Return what a mode shape is multiplied by: it has no size of its own."""
        return self._reach / float(np.abs(mode.shape).max())


def exaggeration(largest: float, drawn: float) -> float:
    """Return the round factor that brings `largest` to `drawn` or a little below; 1 where there is nothing to bring.

    >>> exaggeration(200e-6, 0.05), exaggeration(0.0, 0.05)
    (200.0, 1.0)
    """
    if not largest > 0:
        return 1.0
    factor = drawn / largest
    decade = 10.0 ** math.floor(math.log10(factor))
    return float(max(m * decade for m in (1, 1.5, 2, 3, 4, 5, 6, 8) if m * decade <= factor * (1 + 1e-9)))


def _largest(result: Result) -> float:
    size = np.abs(result.z)
    return float(np.nanmax(size)) if np.isfinite(size).any() else 0.0
