"""Watchdog of the drive: nothing is said to it until it has stopped the rotor by itself."""

import math

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage

LATE = 1.0  # s that a drive may act late
LONGEST = 3600.0  # s of silence; it ends with the first stop


def wait_for_watchdog(stage: Stage) -> float:
    """Return the seconds within which the drive's watchdog has to act."""
    return stage.watchdog + LATE if stage.watchdog else math.inf


def has_no_watchdog(stage: Stage) -> str:
    """Return why there is none to be tested; empty: there is one."""
    return "" if stage.watchdog else "the drive has no watchdog: if this computer dies, only its own switch stops it"


WATCHDOG = Protection(
    name="watchdog",
    provocation="nothing said to the drive",
    provoke=lambda stage: stage.control.fall_silent(LONGEST),
    answers_within=wait_for_watchdog,
    reason="",
    missing=has_no_watchdog,
)
