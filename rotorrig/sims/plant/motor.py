"""Drive and rotation of the shaft: following a ramp with a small lag and some hunting, or a coast-down under drag.

The shaft angle is the integral of the speed by the trapezoidal rule, so that the two never part.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

LAG = 0.05  # s, first order, from the ramp generator to the shaft
HUNTING_TIME = 2.0  # s, correlation time of the speed hunting
DRAG_CONSTANT = 3.0  # rad/s^2, brushes and bearing friction over the rotor's inertia
DRAG_LINEAR = 0.0225  # 1/s, windage and grease; with the constant 45 s from 3600 to 480 rpm


class Motor:
    """Speed and angle of the shaft; unsigned, the sense of rotation is the plant's business."""

    def __init__(self, *, step: float, hunting: float, rng: np.random.Generator) -> None:
        self.speed = 0.0  # rad/s
        self._step = step
        self._hunting = hunting  # relative rms
        self._rng = rng
        self._command = np.zeros(3)  # setpoint, ramp, powered
        # angle, speed, ramp generator, its output with hunting, hunting (unit variance);
        # at rest half a turn from the keyphasor's edge
        self._state = np.array([-math.pi, 0.0, 0.0, 0.0, 0.0])

    def command(self, setpoint: float, ramp: float, powered: bool) -> None:
        """Go to `setpoint` [rad/s] at `ramp` [rad/s^2], or coast if not powered; on power-up from the speed it has.

        Raises ValueError on a negative or infinite setpoint or ramp.
        """
        if not (0.0 <= setpoint < math.inf and 0.0 <= ramp < math.inf):
            raise ValueError(f"setpoint {setpoint} rad/s at {ramp} rad/s^2, want both finite and not negative")
        self._command[:] = setpoint, ramp, powered

    def run(self, steps: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return angle [rad], speed [rad/s] and acceleration [rad/s^2] at the end of each of the next `steps`."""
        shocks = self._rng.standard_normal(steps)
        rotation = np.empty((3, steps))
        _run(self._state, self._command, self._step, self._hunting, shocks, rotation)
        self.speed = float(self._state[1])
        return rotation[0], rotation[1], rotation[2]


@njit(cache=True)
def _run(state: NDArray, command: NDArray, h: float, hunting: float, shocks: NDArray, rotation: NDArray) -> None:
    setpoint, ramp, powered = command
    angle, speed, reference, target, wander = state
    memory = math.exp(-h / HUNTING_TIME)
    fresh = math.sqrt(1.0 - memory * memory)
    follow = math.exp(-h / LAG)
    for i in range(len(shocks)):
        before = speed
        wander = memory * wander + fresh * shocks[i]
        if powered:
            reference += min(max(setpoint - reference, -ramp * h), ramp * h)
            last, target = target, reference * (1.0 + hunting * wander)
            late = LAG * (target - last) / h  # the exact answer to a target that moves evenly within the step
            speed = max(target - late + (speed - last + late) * follow, 0.0)
            alpha = (target - speed) / LAG
        else:
            alpha = -(DRAG_CONSTANT + DRAG_LINEAR * speed) if speed > 0.0 else 0.0
            speed = max(speed + h * alpha, 0.0)
            reference = target = speed  # where the drive takes over when power comes back
        angle += h * (before + speed) / 2.0
        rotation[0, i], rotation[1, i], rotation[2, i] = angle, speed, alpha
    state[:] = angle, speed, reference, target, wander
