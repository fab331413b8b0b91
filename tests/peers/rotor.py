"""The peer's own rotor: it follows the drive's output, coasts by friction, and bends by unbalance."""

import math
from dataclasses import dataclass

FOLLOWS = 0.03  # s, time constant of a motor behind its drive's output
FRICTION = 120.0  # rpm/s, dry: a rotor that coasts from 1200 rpm is at rest after 5.5 s
DRAG = 0.2  # 1/s, of the speed


@dataclass(slots=True)
class Rotor:
    """Speed [rpm] and angle [rad] of the shaft."""

    rpm: float = 0.0
    angle: float = 0.0

    def advance(self, seconds: float, *, output: float | None) -> tuple[float, float]:
        """Turn for `seconds`, driven at `output` rpm or coasting (None); return speeds before and after, rad/s."""
        before = self.rpm
        if output is None:
            self.rpm = max(0.0, self.rpm - (FRICTION + DRAG * self.rpm) * seconds)
        else:
            self.rpm += (output - self.rpm) * -math.expm1(-seconds / FOLLOWS)
        first, last = before * math.pi / 30, self.rpm * math.pi / 30
        self.angle = (self.angle + (first + last) / 2 * seconds) % math.tau
        return first, last
