"""Agreement of disjoint parts of the data on one rotor."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_fit import fit_base
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.verdict.disjoint_parts import Agreement, measure_agreement
from rotorrig.identify.verdict.settings import VERDICT
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from tests.identify.swept import swept_response

PEAK = 238.0  # rad/s, of this rotor's motion


def agreed(response: OrderTrackedResponse) -> Agreement:
    fit = fit_base([Recording(response)])
    return measure_agreement(fit.problem, fit.polished.p)


def with_down_run_of(response: OrderTrackedResponse, other: OrderTrackedResponse) -> OrderTrackedResponse:
    down = response.run == 1
    return replace(response, z=np.where(down[:, None, None], other.z, response.z))


@pytest.mark.parametrize("seed", range(4))
def test_parts_of_what_one_rotor_did_agree(rig: RigConfig, seed: int) -> None:
    assert agreed(swept_response(rig, rng=np.random.default_rng(seed))).p > VERDICT.agreeing


@pytest.mark.campaign
def test_a_rotor_that_was_another_in_the_second_run_is_none(rig: RigConfig) -> None:
    """Unbalance of 11 g mm that is 10 % more and 10 degrees further round on the way down."""
    first, second = (
        swept_response(rig, rng=np.random.default_rng(5), unbalance=11e-6 * factor)
        for factor in (1.0, 1.1 * np.exp(0.17j))
    )
    found = agreed(with_down_run_of(first, second))
    assert found.p < VERDICT.agreeing
    assert found.between == "runs"


@pytest.mark.campaign
def test_planes_that_tell_of_two_rotors_do_not_agree(rig: RigConfig) -> None:
    """The second plane is shown the motion of a rotor whose unbalance is 30 % larger: no gain is so far off."""
    first, second = (
        swept_response(rig, rng=np.random.default_rng(6), unbalance=11e-6 * factor) for factor in (1.0, 1.3)
    )
    positions = np.array([rig.probe(name).position for name in first.probes])
    other = positions != positions[0]
    found = agreed(replace(first, z=np.where(other[None, :, None], second.z, first.z)))
    assert found.p < VERDICT.agreeing
    assert found.between == "planes of probes"


@pytest.mark.parametrize(("above", "agrees"), [(0.06, True), (0.0, False)])
def test_a_cause_that_is_of_another_size_above_the_peak_is_none(rig: RigConfig, above: float, agrees: bool) -> None:
    """Hysteresis of a loss factor of 0.06, and of none in the rows of higher speeds; with 0.02 there it is p = 0.06."""
    effect = find(rig, "hysteresis")
    slow, fast = (
        swept_response(rig, rng=np.random.default_rng(7), hidden=[(effect, {"eta": eta})], unbalance=22e-6)
        for eta in (0.06, above)
    )
    response = replace(slow, z=np.where((slow.omega < PEAK)[:, None, None], slow.z, fast.z))
    base = fit_base([Recording(response)])
    problem = base.problem.extended((*base.problem.effects, effect))
    fit = problem.solve(np.append(base.polished.p, 0.0))
    found = measure_agreement(problem, fit.p)
    assert (found.p > VERDICT.agreeing) is agrees
    assert agrees or found.between == "speeds below and above the peak"


@pytest.mark.parametrize(("explained", "agrees"), [(1e2, False), (1e6, True)])
def test_what_explains_much_may_be_of_a_law_that_is_a_little_wrong(
    rig: RigConfig, explained: float, agrees: bool
) -> None:
    """An unbalance 10 % larger on the way down; of a million of chi2 a law wrong by 1 % leaves a hundred."""
    first, second = (
        swept_response(rig, rng=np.random.default_rng(5), unbalance=11e-6 * factor) for factor in (1.0, 1.1)
    )
    fit = fit_base([Recording(with_down_run_of(first, second))])
    found = measure_agreement(fit.problem, fit.polished.p, explained=explained)
    assert (found.p > VERDICT.agreeing) is agrees
