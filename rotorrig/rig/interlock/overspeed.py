"""Overspeed: the limit of [limits], else 5 % above motor.max_speed, which no plan may exceed."""

import math

from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.errors import LimitExceeded

OVERSHOOT = 1.05  # of motor.max_speed: a drive that arrives there may overshoot; API 670 leaves the margin to the maker


def overspeed_limit(rig: RigConfig) -> float:
    """Return the speed [rad/s] above which the rotor is stopped; infinite for a rig without limits and motor."""
    if rig.limits:
        return rig.limits.overspeed
    return OVERSHOOT * rig.motor.max_speed if rig.motor else math.inf


def check_overspeed(speed: float, *, limit: float, source: str) -> None:
    """Compare a speed [rad/s] with the limit. Raises LimitExceeded."""
    if speed > limit:
        raise LimitExceeded(f"overspeed: {speed * RPM:.0f} rpm by the {source}, limit {limit * RPM:.0f} rpm")
