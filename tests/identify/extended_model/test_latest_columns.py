"""Responses that are asked for again are not computed again."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model.latest_columns import LatestColumns
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.sims.rotor.model import Load, assemble

PUSH = Load(np.array([1.0, -1j]), "unbalance")


def test_the_same_loads_on_the_same_rotor_are_answered_once(short: OrderTrackedResponse) -> None:
    model, latest, computed = assemble(short.rig), LatestColumns(), []

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


def test_only_the_latest_are_kept(short: OrderTrackedResponse) -> None:
    model, latest = assemble(short.rig), LatestColumns()
    first = latest.get(model, [PUSH], lambda: np.zeros((1, 1, 1), complex))
    for order in range(2, 2 + EXTENDED_MODEL.recent):
        latest.get(model, [replace(PUSH, order=order)], lambda: np.zeros((1, 1, 1), complex))
    assert latest.get(model, [PUSH], lambda: np.ones((1, 1, 1), complex)) is not first


def test_fewer_rows_have_responses_of_their_own(short: OrderTrackedResponse, hidden: np.ndarray) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(short)]))
    p = problem.parameters.start(hidden)
    (whole,) = problem.model.predict(p)
    thin = problem.recordings[0].thinned(np.array([3, 8]))
    assert len(problem.on([thin]).model.predict(p[: len(problem.on([thin]).parameters)])[0][1]) == 3
    assert len(whole[1]) == len(problem.recordings[0].rows) + 1
