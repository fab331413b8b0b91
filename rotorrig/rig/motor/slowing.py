"""Evidence that a drive obeys a stop: its speed falls by more than that of a steady rotor jitters."""

from rotorrig.rig.config import RPM

JITTER = 5 / RPM  # rad/s; drives that hold their speed report 0.02 Hz more or less, or a few rpm where it is measured
LONGEST_SECONDS = 5.0  # to wait for it, on a ramp so slow (2 rpm/s) that nothing can be said sooner


def falls(speed: float, *, since: float, step: float = 0.0) -> bool:
    """Return whether a speed has fallen since another reading; `step` is one count of it, all in rad/s.

    >>> falls(99.9 / RPM, since=100.0 / RPM), falls(94.0 / RPM, since=100.0 / RPM)
    (False, True)
    """
    return speed < since - max(JITTER, 1.5 * step)


def patience(ramp: float | None, *, least: float) -> float:
    """Return how long to wait [s] for a speed to fall down `ramp` [rad/s^2]: twice the time, but `least`.

    >>> patience(30 / RPM, least=1.0), patience(5 / RPM, least=1.0), patience(None, least=1.0)
    (1.0, 2.0, 1.0)
    """
    return min(max(least, 2 * JITTER / ramp), LONGEST_SECONDS) if ramp else least
