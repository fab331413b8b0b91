"""A recording of a rotor that turned backwards, against the model of a rig that turns the other way by its config."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording, told_by_falling_angle
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import find
from tests.identify.swept import U, swept_response

FAST = {"speeds": (900, 2600), "ramp": 600}
#: what is fixed to the shaft is told by an angle in the sense of rotation, so its phasor turns over; all else stays
HIDDEN = {
    "bow": ({"bow re": 20e-6, "bow im": 8e-6}, {"bow re": 20e-6, "bow im": -8e-6}),
    "runout, plane 1": ({"runout re": 6e-6, "runout im": -9e-6}, {"runout re": 6e-6, "runout im": 9e-6}),
    "coupling": (
        {"force 1X re": 0.5, "force 1X im": 0.7, "force 2X re": 0.4, "force 2X im": 0.9},
        {"force 1X re": 0.5, "force 1X im": -0.7, "force 2X re": 0.4, "force 2X im": -0.9},
    ),
    "shaft_asymmetry": (
        {"asymmetry re": 0.02, "asymmetry im": 0.03},
        {"asymmetry re": 0.02, "asymmetry im": -0.03},
    ),
    "cross_stiffness": ({"k": 4e3}, {"k": 4e3}),
    "skew_stiffness": ({"k": 1e3}, {"k": 1e3}),
    "internal_damping": ({"beta": 4e-5}, {"beta": 4e-5}),
    "delay, probe 2y": ({"delay": 4e-4}, {"delay": 4e-4}),
    "probe_angle, plane 1": ({"turn": 0.15}, {"turn": 0.15}),
    "cross_talk, plane 2": ({"leak": 0.1}, {"leak": 0.1}),
}


@pytest.mark.parametrize("label", HIDDEN)
def test_it_is_what_the_rig_of_the_other_sense_shows(rig: RigConfig, hidden: NDArray[np.float64], label: str) -> None:
    theta, mirrored = ({q: 0.0 for q in find(rig, label).at_zero} | found for found in HIDDEN[label])
    other_way = rig.turned_over
    made = swept_response(other_way, hidden=[(find(other_way, label), mirrored)], unbalance=np.conj(U), **FAST)
    recording = Recording(made, backward=True)
    effect = find(rig, label)
    problem = ExtendedProblem(ExtendedModel([recording], [effect]))
    p = problem.parameters.start(hidden)
    p[problem.parameters.base.unbalance] = U.real, U.imag
    p[problem.parameters.own] = [theta[q.name] / q.size for q in effect.parameters]
    (predicted,) = problem.model.predict(p)
    for order in (1, 2):
        got, want = (
            recording.as_measured(predicted[order]),
            np.vstack([made.order(order), made.slow_roll[None, :, order - 1]]),
        )
        np.testing.assert_allclose(got, want, atol=2e-4 * np.abs(made.order(1)).max())


def test_its_columns_are_derivatives(rig: RigConfig, hidden: NDArray[np.float64]) -> None:
    other_way = rig.turned_over
    made = swept_response(other_way, unbalance=np.conj(U), **FAST)
    problem = ExtendedProblem(
        ExtendedModel([Recording(made, backward=True)], [find(rig, "internal_damping"), find(rig, "bow")])
    )
    p = problem.parameters.start(hidden)
    p[problem.parameters.base.unbalance] = U.real, U.imag
    p[problem.parameters.own] = 0.5
    J = problem.jacobian(p)
    for i in np.r_[problem.parameters.base.structural.start, problem.parameters.own.start : len(p)]:
        step = np.zeros(len(p))
        step[i] = 1e-5
        slope = (problem.residual(p + step) - problem.residual(p - step)) / 2e-5
        np.testing.assert_allclose(J[:, i], slope, atol=1e-3 * np.abs(slope).max())


def test_told_by_a_falling_angle_twice_it_is_itself(short: OrderTrackedResponse) -> None:
    again = told_by_falling_angle(told_by_falling_angle(short))
    np.testing.assert_array_equal(again.z, short.z)
    np.testing.assert_array_equal(again.covariance, short.covariance)
    assert again.runs == short.runs


def test_a_force_law_is_not_followed_backwards(rig: RigConfig, short: OrderTrackedResponse) -> None:
    effect = find(rig, "cubic_spring")
    problem = ExtendedProblem(ExtendedModel([Recording(short, backward=True)], [effect]))
    p = problem.parameters.start(np.zeros(0))
    p[problem.parameters.own] = 0.1
    with pytest.raises(DataError, match="turns backwards"):
        problem.model.predict(p)
