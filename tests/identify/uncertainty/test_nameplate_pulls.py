"""What a fit makes of its nuisances where it stands at a bound, and of what cannot be off by so much."""

import numpy as np
import pytest

from rotorrig.identify.causes.candidates import candidates
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.problem import ExtendedProblem
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.nameplate_pulls import check_nameplate, nuisance_posterior
from rotorrig.processing.response import OrderTrackedResponse

ROWS = 400


@pytest.mark.parametrize("off", [0.0, 1e-12])
def test_what_ended_at_its_bound_counts_as_held_there(
    short: OrderTrackedResponse, hidden: np.ndarray, rng: np.random.Generator, off: float
) -> None:
    """A cause's unknown at its bound, or short of it by rounding, and a tilt stiffness likewise.

    Left free, the unknown would take from the nuisances what the data say of them.
    """
    recording = Recording(short)
    inertia = next(effect for effect in candidates([recording]) if effect.name == "disk_inertia")
    names = ExtendedProblem(ExtendedModel([recording], [inertia])).parameters
    p = names.start(hidden)
    bound = names.names.index("disk_inertia: transverse")
    p[bound] = names.bounds[1][bound] * (1 - off)
    p[names.names.index("tilt left A")] = off
    priors = np.zeros((len(names.priors), len(names)))
    priors[np.arange(len(names.priors)), names.priors] = 1 / names.prior_sigma[names.priors]
    figures = rng.standard_normal((ROWS, len(names))) / names.stated_sigma.clip(max=1.0)
    jacobian = np.concatenate([figures, priors])
    fit = Solution(p=p, covariance=np.eye(len(names)), jacobian=jacobian, chi2=float(ROWS), dof=ROWS)
    kept, posterior = nuisance_posterior(fit, names)

    zero = [i for i, name in enumerate(names.names) if name.startswith(("tilt ", "hub "))]  # they start at their bound
    held = np.delete(np.arange(len(names)), [bound, *zero])
    covariance = np.linalg.inv(jacobian[:, held].T @ jacobian[:, held])
    mine = [i for i in held if i in names.priors]
    assert kept == [names.names[i] for i in mine]
    where = [list(held).index(i) for i in mine]
    sigma = names.stated_sigma[mine]
    expected = covariance[np.ix_(where, where)] / np.outer(sigma, sigma)
    assert posterior.covariance == pytest.approx(expected, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("off", "named"), [(0.3, True), (-0.8, True), (-5.0, False), (5.0, False)])
def test_what_would_have_to_be_off_by_more_than_can_be_is_no_finding(
    short: OrderTrackedResponse, hidden: np.ndarray, off: float, named: bool
) -> None:
    """A bearing of the pair by the coupling, to which the data tell its stiffness alone: 500 % softer is none."""
    problem = ExtendedProblem(ExtendedModel([Recording(short)]))
    names = problem.parameters
    i = names.names.index("bearing left A x")
    sigma = abs(off) / 6  # of the data: a pull of nearly six sigmas
    told = check_nameplate(told_alone(problem, hidden, i, off=off, sigma=sigma), problem)
    (mine,) = (d for pull in told.pulls for d in pull.deviations if d.label == "bearing_stiffness, left A x")
    assert mine.value == pytest.approx(off, rel=0.01)
    assert (mine.label in [finding.deviation.label for finding in told.findings]) is named


@pytest.mark.parametrize(
    ("share", "words"),
    [(0.4, "13.6 ± 3.2 % thicker"), (1.2, "at least 19 % thicker")],
    ids=["within", "more than all of its flexibility"],
)
def test_a_hub_that_takes_all_flexibility_away_is_told_by_how_much_at_least(
    short: OrderTrackedResponse, hidden: np.ndarray, share: float, words: str
) -> None:
    """A shaft of any thickness is as stiff: 1.2 less two sigmas of a third leaves 0.5, and 0.5^-1/4 is 1.19."""
    problem = ExtendedProblem(ExtendedModel([Recording(short)]))
    i = problem.parameters.names.index("hub disk")
    sigma = 0.35 if share > 1 else 0.0675
    told = check_nameplate(told_alone(problem, hidden, i, off=share, sigma=sigma), problem)
    (mine,) = (d for pull in told.pulls for d in pull.deviations if d.kind == "hub")
    assert mine.words == f"under the hub of the disk the shaft is as stiff as one {words} than the config says"


def told_alone(problem: ExtendedProblem, hidden: np.ndarray, i: int, *, off: float, sigma: float) -> Solution:
    """Return the fit of data that tell every unknown as well as its prior does, but number `i` to be `off`."""
    names = problem.parameters
    figures = np.zeros((ROWS, len(names)))
    figures[0, i] = 1 / sigma
    figures[1 : len(names) + 1] = np.eye(len(names)) * (np.arange(len(names)) != i) / names.stated_sigma.clip(max=1.0)
    priors = np.zeros((len(names.priors), len(names)))
    priors[np.arange(len(names.priors)), names.priors] = 1 / names.prior_sigma[names.priors]
    p = names.start(hidden)
    p[i] = off / (1 + (sigma / names.prior_sigma[i]) ** 2)
    jacobian = np.concatenate([figures, priors])
    return Solution(p=p, covariance=np.eye(len(names)), jacobian=jacobian, chi2=float(ROWS), dof=ROWS)
