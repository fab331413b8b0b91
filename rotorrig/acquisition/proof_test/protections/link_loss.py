"""Link loss: the motor's port or socket is closed, and opened again once the drive has stopped the rotor."""

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.protections.watchdog import LONGEST, has_no_watchdog, wait_for_watchdog

LINK_LOSS = Protection(
    name="link loss",
    provocation="motor link closed",
    provoke=lambda stage: stage.control.fall_silent(LONGEST, closed=True),
    answers_within=wait_for_watchdog,
    reason="",
    missing=has_no_watchdog,
)
