"""The problem of a fit, extended by effects."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.extended_model import problem as problem_module
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.parameters import KEYPHASOR
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.extended_model.unit_responses import UnitResponses
from rotorrig.identify.least_squares import Solution
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig import DataError
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, find
from tests.identify.swept import SIGMA, C, K, U, swept_response

NEAR = 0.05 * SIGMA  # 1e-4 of the peak: the recordings are made of more modes than a fit has


def at(problem: ExtendedProblem, hidden: np.ndarray, **theta: float) -> np.ndarray:
    """The unknowns that the recordings were made of, the one effect of `problem` at `theta` (SI, "_" for a blank)."""
    p = problem.parameters.start(hidden)
    values = {name.replace("_", " "): value for name, value in theta.items()}
    p[problem.parameters.base.unbalance] = U.real, U.imag
    p[problem.parameters.base.runout] = 0
    for effect in problem.effects:
        p[problem.parameters.own] = [values.get(q.name, q.at_zero) / q.size for q in effect.parameters]
    return p


@pytest.mark.parametrize(
    ("label", "theta"),
    [
        ("bow", {"bow re": 9e-6, "bow im": -4e-6}),
        ("unbalance_plane, at 160 mm", {"unbalance re": 0.0, "unbalance im": 6e-6}),
        ("coupling", {}),
        ("delay, probe 2y", {"delay": 2e-4}),
        ("probe_gain, probe 1x", {}),
        ("skew_stiffness", {}),
        ("stiffness_over_speed", {}),
        ("shaft_asymmetry", {}),
        ("runout, plane 1, twice per turn", {}),
    ],
)
def test_a_recording_with_an_effect_is_predicted_by_the_model_with_it(
    rig: RigConfig, hidden: np.ndarray, label: str, theta: dict[str, float]
) -> None:
    effect = find(rig, label)
    theta = theta or {q.name: q.at_zero + q.size for q in effect.parameters}
    response = swept_response(rig, hidden=[(effect, theta)], orders=(1, 2, 3), speeds=(900, 2600), ramp=600)
    without, problem = (ExtendedProblem(ExtendedModel([Recording(response)], effects)) for effects in ((), (effect,)))
    p = at(problem, hidden, **{name.replace(" ", "_"): value for name, value in theta.items()})
    assert np.sum(without.residual(at(without, hidden)) ** 2) > 25
    (found,), (recording,) = problem.model.predict(p), problem.recordings
    for order, measured in recording.measured.items():
        np.testing.assert_allclose(found[order], measured.z, rtol=0, atol=NEAR)


def test_a_trial_mass_turned_by_the_mark_is_another_trial_mass(rig: RigConfig, hidden: np.ndarray) -> None:
    turn = 0.1
    made = {"orders": (1,), "speeds": (900, 2600), "ramp": 600}
    told = swept_response(rig, trial=8e-6, **made)
    given = Recording(swept_response(rig, trial=8e-6 * np.exp(1j * turn), **made))
    problem = ExtendedProblem(ExtendedModel([Recording(told)]))
    p = at(problem, hidden)
    p[problem.parameters.names.index(KEYPHASOR)] = turn
    np.testing.assert_allclose(problem.model.predict(p)[0][1], given.measured[1].z, atol=NEAR)


def test_an_effect_of_one_recording_leaves_the_others_alone(short: OrderTrackedResponse, hidden: np.ndarray) -> None:
    recordings = [Recording(short, number=i) for i in range(2)]
    step = find(short.rig, "unbalance_step")
    only = type(step)(plane="disk", parameters=step.parameters, recording=1)
    problem = ExtendedProblem(ExtendedModel(recordings, [only]))
    p = problem.parameters.start(hidden)
    p[problem.parameters.own] = 1.0, 0.0, -1e6  # a size of step, long before
    first, second = problem.model.predict(p)
    base = ExtendedProblem(ExtendedModel(recordings))
    np.testing.assert_allclose(first[1], base.model.predict(base.parameters.start(hidden))[0][1], rtol=1e-9, atol=1e-15)
    assert np.abs(second[1] - first[1]).max() > 10 * SIGMA


def test_the_best_amounts_leave_nothing_of_what_they_can_explain(bare: Recording, hidden: np.ndarray) -> None:
    problem = ExtendedProblem(ExtendedModel([bare]))
    p = at(problem, hidden)
    p[problem.parameters.base.unbalance] = 0
    found = problem.solve_linear(p, np.arange(len(p)))
    assert complex(*found[problem.parameters.base.unbalance]) == pytest.approx(U, rel=1e-3)


def test_the_fit_of_a_quiet_recording_finds_what_made_it(bare: Recording, hidden: np.ndarray) -> None:
    problem = ExtendedProblem(ExtendedModel([bare]))
    names = problem.parameters.base
    start = problem.parameters.start(hidden)
    start[names.sought] += 0.05
    polished = problem.solve(start)
    assert polished.chi2 < 0.1
    np.testing.assert_allclose(names.values(polished.p[: len(names)]), [*K, *C], rtol=0.01)


def test_what_is_held_stays_and_has_no_variance(bare: Recording, hidden: np.ndarray) -> None:
    problem = ExtendedProblem(ExtendedModel([bare]))
    polished = problem.solve(problem.parameters.start(hidden), fixed={0: float(hidden[0]) + 0.1}, max_steps=3)
    assert polished.p[0] == hidden[0] + 0.1
    assert polished.sigma[0] == 0


def test_the_size_counts_figures_and_priors(bare: Recording) -> None:
    problem = ExtendedProblem(ExtendedModel([bare]))
    rows, probes = len(bare.rows) + 1, 4
    assert problem.size == 2 * rows * probes + len(problem.parameters.priors)
    assert len(problem.residual(problem.parameters.start(np.zeros(0)))) == problem.size


def test_effects_that_are_linear_are_known_as_such(bare: Recording) -> None:
    def own(label: str) -> bool:
        effect: Effect = find(bare.response.rig, label)
        problem = ExtendedProblem(ExtendedModel([bare], [effect]))
        return problem.parameters.own.start in problem.model.linear()

    assert own("bow")
    assert own("couple")
    assert not own("coupling")  # its forces are, its stiffness changes the rotor
    assert not own("delay")
    assert not own("cubic_spring")


def test_an_effect_may_need_a_place_that_the_rig_does_not_name(rig: RigConfig, hidden: np.ndarray) -> None:
    """Away from the disk a rub in mid-span acts on a plane of its own."""
    (disk,) = rig.disks
    moved = rig.model_copy(update={"disks": (disk.model_copy(update={"position": 0.2}),)})
    rub = find(moved, "rub, at mid-span")
    assert rub.places
    recording = Recording(swept_response(moved, orders=(1,), speeds=(900, 2000), ramp=600))
    base, problem = ExtendedProblem(ExtendedModel([recording])), ExtendedProblem(ExtendedModel([recording], [rub]))
    (far_off,) = problem.model.predict(at(problem, hidden, gap=1e-3, stiffness=1e5))
    (without,) = base.model.predict(at(base, hidden))
    np.testing.assert_allclose(far_off[1], without[1], rtol=0, atol=NEAR)


def test_linear_unknowns_are_solved_for_to_the_least_sum_of_squares(
    short: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(short)]))
    p = problem.parameters.start(hidden)
    linear = np.sort(problem.model.linear())
    best = problem.solve_linear(p, np.arange(len(p)))
    np.testing.assert_array_equal(np.delete(best, linear), np.delete(p, linear))
    J, r = problem.jacobian(p, linear), problem.residual(p)
    np.testing.assert_allclose(best[linear] - p[linear], -np.linalg.lstsq(J, r, rcond=None)[0], rtol=1e-6, atol=1e-15)
    np.testing.assert_allclose(J.T @ problem.residual(best), 0, atol=1e-6 * np.linalg.norm(J, axis=0).max())


def test_a_rotor_is_made_once_though_a_jacobian_under_a_law_asks_for_many(
    short: OrderTrackedResponse, hidden: np.ndarray
) -> None:
    problem = ExtendedProblem(ExtendedModel([Recording(short)], [find(short.rig, "cubic_spring")]))
    p = at(problem, hidden, k3=1e9)
    rotor = problem.model.rotor(p)
    problem.jacobian(p)
    assert problem.model.rotor(p) is rotor


@pytest.mark.parametrize("lost", [1e200, np.nan, np.inf])
def test_where_the_exact_motion_is_beyond_bounds_a_fit_goes_on_from_its_start(
    rig: RigConfig, hidden: np.ndarray, lost: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Responses to loads above 1X are those of the rotor at the start, until the end of a fit tells them anew."""
    response = swept_response(rig, orders=(1, 2))
    problem = ExtendedProblem(ExtendedModel([Recording(response)], [find(rig, "shaft_asymmetry")]))
    start = problem.parameters.start(hidden)
    astray = problem.solve(start, max_steps=1)
    begun: list[np.ndarray] = []

    def refine(problem: ExtendedProblem, p: np.ndarray, **_: object) -> Solution:
        begun.append(p)
        return replace(astray, p=p + 1.0)

    def residual(self: ExtendedProblem, p: np.ndarray, **more: object) -> np.ndarray:
        gone = begun and np.array_equal(p, begun[0] + 1.0) and not held
        return np.full(3, lost) if gone else np.zeros(3)

    held = [True]
    monkeypatch.setattr(problem_module, "solve", refine)
    monkeypatch.setattr(ExtendedProblem, "residual", residual)
    monkeypatch.setattr(UnitResponses, "seen", property(lambda units: True))
    monkeypatch.setattr(UnitResponses, "release", lambda units: held.clear() if begun else None)
    found = problem.solve(start)
    assert [np.array_equal(p, start) for p in begun] == [True, True]
    assert np.array_equal(found.p, start + 1.0)


def test_a_step_to_where_nothing_holds_the_shaft_has_no_motion(rig: RigConfig, hidden: np.ndarray) -> None:
    """The sag of an asymmetric shaft has no answer there; a trial step of an overhung rotor ended a diagnosis so."""
    asymmetry = find(rig, "shaft_asymmetry")
    response = swept_response(rig, speeds=(900, 1500), ramp=600)
    model = ExtendedModel([Recording(response)], (asymmetry,))
    held = ExtendedProblem(model)
    p = at(held, hidden, asymmetry_re=0.01)
    assert np.isfinite(held.residual(p)).all()
    no_bearings = replace(response, rig=rig.model_copy(update={"bearings": rig.bearings[-1:]}))
    loose = ExtendedProblem(ExtendedModel([Recording(no_bearings)], (asymmetry,)))
    with pytest.raises(DataError, match="no bounded motion"):
        loose.residual(at(loose, hidden, asymmetry_re=0.01))
    with pytest.raises(np.linalg.LinAlgError, match="do not hold the shaft"):
        loose.solve_linear(at(loose, hidden, asymmetry_re=0.01), loose.parameters.free)
