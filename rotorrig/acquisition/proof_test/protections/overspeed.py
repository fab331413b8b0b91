"""Overspeed: the interlock's limit is lowered below the speed of the rotor."""

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage

LOWERED = 0.9  # of the speed
TURNS, MARGIN = 3.0, 0.1  # docs/sweeps.md: three turns of the keyphasor's median and a block


def _lower_limit(stage: Stage) -> None:
    stage.interlock.overspeed = LOWERED * stage.speed


OVERSPEED = Protection(
    name="overspeed",
    provocation=f"limit lowered to {LOWERED:.0%} of the speed",
    provoke=_lower_limit,
    answers_within=lambda stage: TURNS * stage.turns.turn + MARGIN,
    reason="overspeed:",
)
