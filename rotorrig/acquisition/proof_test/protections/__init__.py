"""Protections that a proof test provokes, a file each, in this order.

The emergency stop comes first, as it ends every part that fails; those after which a drive remembers a trip come last.
"""

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.protections.emergency_stop import EMERGENCY_STOP
from rotorrig.acquisition.proof_test.protections.guardian import GUARDIAN
from rotorrig.acquisition.proof_test.protections.keyphasor_loss import KEYPHASOR_LOSS
from rotorrig.acquisition.proof_test.protections.link_loss import LINK_LOSS
from rotorrig.acquisition.proof_test.protections.overspeed import OVERSPEED
from rotorrig.acquisition.proof_test.protections.watchdog import WATCHDOG

__all__ = ["PROTECTIONS"]

PROTECTIONS: tuple[Protection, ...] = (EMERGENCY_STOP, OVERSPEED, KEYPHASOR_LOSS, GUARDIAN, WATCHDOG, LINK_LOSS)
