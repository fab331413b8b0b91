"""Search from the nameplate: faults of drawn size on drawn rigs, far from every point of a grid."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.parts.blind.rigs.drawn import LAYOUTS, character, draw_rig, layout
from rotorrig.identify.causes import candidates
from rotorrig.identify.causes.candidate_fit import Candidate, fit_candidate, plausible
from rotorrig.identify.causes.nameplate_search import _Search, rescore_from_nameplate, search_from_nameplate
from rotorrig.identify.causes.score_test import Score, scores
from rotorrig.identify.causes.small_amounts import score_small_amounts
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.sims.effects.base import find
from rotorrig.sims.effects.shaft_motion import at_rest
from rotorrig.sims.rotor.model.assembly import assemble
from tests.identify.matched import with_constant_damping
from tests.identify.problems import refine
from tests.identify.swept import swept_response
from tests.parameters import defer_rest

RAMP = 400.0  # rpm/s
SPRINGY = {"one disk": 0, "two disks": 39}  # seeds of rigs that move no less than their weight pushes them, about
SURE = 4.0  # standard deviations


def drawn_rig(form: str) -> RigConfig:
    """Return the first drawn rig of a form."""
    rigs = (draw_rig(seed) for seed in range(50))
    return next(rig for rig in rigs if layout(rig) == form)


def recorded(rk4: RigConfig, rig: RigConfig, label: str, theta: dict[str, float], seed: int) -> ExtendedProblem:
    """Return the base problem of a run of a rig that is a little off its nameplate and has an effect, noise added."""
    rng, plan = np.random.default_rng(seed), rig.plans["default"]
    blank = swept_response(rk4, orders=(1, 2), speeds=(plan.start * RPM, plan.fastest * RPM), ramp=RAMP)
    blank = replace(blank, rig=with_constant_damping(rig))
    bare = ExtendedProblem(ExtendedModel([Recording(blank)]))
    effect = next(e for e in candidates(bare.recordings) if e.label == label)
    whole = bare.extended([effect])
    names = whole.parameters
    p = names.start(np.zeros(0))
    space = names.base.space
    p[names.base.sought] = space.to_working(space.nameplate * (1 + 0.04 * rng.uniform(-1, 1, len(space.nameplate))))
    p[names.base.gain] = 0.008 * rng.standard_normal(len(p[names.base.gain]))
    amounts = [d.unbalance.amount * np.exp(1j * d.unbalance.angle) for d in rig.disks if d.unbalance]
    p[names.base.unbalance] = [part for u in amounts for part in (u.real, u.imag)]
    p[names.own] = [theta.get(q.name, q.at_zero) / q.size for q in effect.parameters]
    (z,) = whole.model.predict(p)
    (blank_recording,) = bare.recordings
    noisy = {order: z[order] + measured.noise(rng) for order, measured in blank_recording.measured.items()}
    problem = ExtendedProblem(ExtendedModel([blank_recording.instead(noisy)]))
    return problem.expecting_error(problem.parameters.start(p[: problem.parameters.own.start]))


def base_fit(problem: ExtendedProblem) -> Solution:
    """Fit the base from the nameplate; the cause it lacks biases it."""
    return refine(problem, problem.parameters.base.space.nameplate)


def best_fit(problem: ExtendedProblem, base: Solution, scores: Sequence[Score]) -> Candidate:
    """Return the best fit from where the scores begin, a plausible one first, as the selection ranks them."""
    fits = [fit_candidate(problem, base, None, score, leader=-np.inf) for score in scores]
    return max((fit for fit in fits if fit is not None), key=lambda fit: (plausible(fit), fit.evidence))


def assert_reached(candidate: Candidate, theta: dict[str, float]) -> None:
    """Check that a fit is at the truth within its sigmas."""
    names = candidate.problem.parameters
    got, sigma = (names.of_effect(part, 0) for part in (candidate.polished.p, candidate.polished.sigma))
    assert candidate.polished.chi2 < 1.5 * candidate.polished.dof
    for name, value in theta.items():
        assert abs(got[name] - value) < SURE * sigma[name], (name, got[name], value, sigma[name])
        assert sigma[name] < 0.5 * abs(value), name


@pytest.mark.campaign
@pytest.mark.parametrize("form", LAYOUTS)
def test_a_pedestal_of_any_frequency_is_found_under_any_rotor(rig_config: RigConfig, form: str) -> None:
    rig = drawn_rig(form)
    rng = np.random.default_rng([3, LAYOUTS.index(form)])
    critical, k = character(rig).critical, character(rig).stiffness
    omega = critical * rng.uniform(0.55, 1.2)
    lightness = omega**2 / (k * rng.uniform(0.5, 4.0))
    theta = {"lightness": lightness, "omega": omega, "damping ratio": rng.uniform(0.02, 0.06), "compliance across": 0.2}
    problem = recorded(rig_config, rig, "pedestal, x", theta, seed=11)
    base = base_fit(problem)
    first, second, *_ = search_from_nameplate(problem, base, candidates(problem.recordings), biased=True)
    best = best_fit(problem, base, [first, second])
    assert best.effect.label == "pedestal, x"
    assert_reached(best, {"omega": omega})


@pytest.mark.parametrize("hertz", [20.5, 33.0])
def test_a_pedestal_that_gives_way_by_little_is_found_at_its_frequency(rig_config: RigConfig, hertz: float) -> None:
    """By a hundredth of the bearing's own compliance: a full amount, begun anywhere, does not come down to that."""
    rig = draw_rig(SPRINGY["one disk"])
    omega, k = 2 * np.pi * hertz, character(rig).stiffness
    theta = {"lightness": omega**2 * 0.015 / k, "omega": omega, "damping ratio": 0.04, "compliance across": 0.0}
    problem = recorded(rig_config, rig, "pedestal, x", theta, seed=13)
    base = base_fit(problem)
    (score,) = score_small_amounts(problem, base.p, [find(rig, "pedestal, x")])
    names = problem.extended([score.effect]).parameters
    assert score.begin is not None
    assert names.of_effect(score.begin, 0)["omega"] == pytest.approx(omega, rel=0.07)
    best = best_fit(problem, base, [score])
    assert best.lam > 15
    assert_reached(best, {"omega": omega, "lightness": theta["lightness"]})


@pytest.mark.parametrize(
    ("form", "cause"),
    defer_rest([("two disks", "cubic_spring"), ("one disk", "cubic_spring"), ("one disk", "clearance")]),
)
def test_a_force_law_of_a_drawn_size_is_found(rig_config: RigConfig, form: str, cause: str) -> None:
    """A spring of 10 to 25 % of the stiffness at the peak; stronger ones end in other valleys (docs/diagnosis.md)."""
    is_spring = cause == "cubic_spring"
    rig = draw_rig(SPRINGY[form]) if is_spring else drawn_rig(form)
    rng = np.random.default_rng([4, LAYOUTS.index(form), len(cause)])
    peak, k = character(rig).peak, character(rig).stiffness
    gap, steepness = peak * rng.uniform(0.1, 0.3), k / (peak + sag(rig)) ** 2 * rng.uniform(0.1, 0.25)
    theta = {"k3": steepness} if is_spring else {"gap": gap}
    problem = recorded(rig_config, rig, cause, theta, seed=12)
    base = base_fit(problem)
    found = search_from_nameplate(problem, base, [find(rig, cause)], biased=True)
    best = best_fit(problem, base, found)
    assert best.lam > 15
    assert_reached(best, theta)


def test_beside_a_base_that_is_far_off_a_fit_begins_where_the_search_from_the_nameplate_led(
    rig_config: RigConfig,
) -> None:
    rig, theta = drawn_rig("one disk"), {"bow re": 60e-6, "bow im": 20e-6}
    problem = recorded(rig_config, rig, "bow", theta, seed=14)
    names = problem.parameters.base
    twice = problem.begin(names.space.nameplate)
    twice[names.sought] += np.log(2.0)
    held = dict(zip(range(len(twice))[names.sought], twice[names.sought], strict=True))
    base = problem.solve(twice, fixed=held)  # at twice the stiffness and damping
    scored = scores(problem, base.p, [find(rig, "bow"), find(rig, "couple")])
    best, other = rescore_from_nameplate(problem, base, scored)
    assert best.effect.label == "bow" and best.lam > scored[0].lam
    assert other is scored[1]  # which came near nothing
    assert best.begin is not None and best.begins_at_full_amount, "it comes by what the search says of it"
    assert best.visible == scored[0].visible
    assert_reached(best_fit(problem, base, [best]), theta)


def test_a_wall_that_is_out_of_reach_is_no_start(rig_config: RigConfig) -> None:
    """It promises what the base does, and took the place of walls that the rotor touches."""
    rig = drawn_rig("one disk")
    problem = recorded(rig_config, rig, "cubic_spring", {"k3": 0.0}, seed=14)
    base = base_fit(problem)
    search = _Search.of(problem, base.p, biased=True)
    moved = np.abs(
        problem.model.motion_at(problem.recordings[0], base.p, problem.model.rotor(base.p).disk("disk").rows[:2])
    ).max()
    rub = find(rig, "rub, at disk")
    gaps = tuple(float(moved * share) for share in (0.3, 0.6, 2.0, 4.0, 8.0, 16.0))
    rub = replace(rub, parameters=(replace(rub.parameters[0], starts=gaps), *rub.parameters[1:]))
    reached = [start.p[-3] * rub.parameters[0].size for start in search.gather(rub)]
    assert reached
    assert max(reached) < 2.0 * moved


def sag(rig: RigConfig) -> float:
    """Return how far the rotor's weight pushes a sprung bearing, the most [m]."""
    model = assemble(rig)
    rest = at_rest(model, rig.gravity)
    return max(float(np.linalg.norm(model.bearing(b.name).rows @ rest)) for b in rig.bearings if not b.rigid)
