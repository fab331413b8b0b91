"""Keyphasor loss: the interlock is fed samples whose keyphasor stands still, until it has stopped the rotor."""

import math
from dataclasses import replace

from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.stage import Stage
from rotorrig.rig.probes import Block

TURNS, SECONDS, MARGIN = 5.0, 2.0, 0.5  # docs/sweeps.md: 2 s and five turns; a reading of the drive, and a block


def _flatten_keyphasor(stage: Stage) -> None:
    assert stage.rig.keyphasor
    channel = stage.rig.keyphasor.channel
    held: list[int] = []

    def flatten(block: Block) -> Block:
        if not math.isnan(stage.control.stopped_at) or not len(block.counts):
            return block  # the run-down is followed on the true samples
        held[:] = held or [int(block.counts[0, channel])]
        counts = block.counts.copy()
        counts[:, channel] = held[0]
        return replace(block, counts=counts)

    stage.daq.alter = flatten


KEYPHASOR_LOSS = Protection(
    name="keyphasor loss",
    provocation="keyphasor's samples held flat",
    provoke=_flatten_keyphasor,
    answers_within=lambda stage: max(SECONDS, TURNS * stage.turns.turn) + MARGIN,
    reason="keyphasor:",
)
