"""Responses that are asked for again are not computed again."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.model.latest_responses import LatestResponses
from rotorrig.sims.rotor.model.loads import Load
from tests.sims.rotor import jeffcott

PUSH = Load(np.array([1.0, -1j]), "unbalance")
KEEP = 4


def test_the_same_loads_on_the_same_rotor_are_answered_once() -> None:
    model, latest = assemble(jeffcott.rig()), LatestResponses(keep=KEEP)
    computed: list[int] = []

    def compute() -> np.ndarray:
        computed.append(1)
        return np.zeros((1, 1, 1), complex)

    first = latest.get(model, [PUSH], compute)
    assert latest.get(model, [replace(PUSH, pattern=PUSH.pattern.copy())], compute) is first
    assert len(computed) == 1
    others = [replace(PUSH, pattern=2 * PUSH.pattern), replace(PUSH, since=1.0), replace(PUSH, order=2)]
    for other in (*others, replace(PUSH, law="constant")):
        latest.get(model, [other], compute)
    latest.get(replace(model), [PUSH], compute)
    latest.get(model, [PUSH, PUSH], compute)
    assert len(computed) == 7
    with pytest.raises(ValueError, match="read-only"):
        first += 1


def test_only_the_latest_are_kept() -> None:
    model, latest = assemble(jeffcott.rig()), LatestResponses(keep=KEEP)
    first = latest.get(model, [PUSH], lambda: np.zeros((1, 1, 1), complex))
    for order in range(2, 2 + KEEP):
        latest.get(model, [replace(PUSH, order=order)], lambda: np.zeros((1, 1, 1), complex))
    assert latest.get(model, [PUSH], lambda: np.ones((1, 1, 1), complex)) is not first
