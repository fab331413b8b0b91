"""Profile intervals against those known in closed form: of measurements that are linear in something else."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rotorrig.identify.chea.residuals import Point, minimize_squares
from rotorrig.identify.least_squares.solve import Solution, inverse_information
from rotorrig.identify.uncertainty.profile_likelihood import profile_interval
from rotorrig.identify.uncertainty.quantities import Amount, Phase

RISE = 3.841459  # 95 % of chi2 with one degree of freedom
HALF = 1.959964


@dataclass
class Known:
    """A least-squares problem whose residual is `model(p)` less nothing; the part of `Problem` that is asked for."""

    model: Any  # p -> residual, Jacobian
    low: list[float]
    high: list[float]

    @property
    def parameters(self) -> SimpleNamespace:
        return SimpleNamespace(bounds=(np.array(self.low), np.array(self.high)))

    def residual(self, p: np.ndarray) -> np.ndarray:
        return self.model(p)[0]

    def jacobian(self, p: np.ndarray) -> np.ndarray:
        return self.model(p)[1]

    def solve(self, start: np.ndarray, *, fixed: dict[int, float]) -> Solution:
        p = start.copy()
        p[list(fixed)] = list(fixed.values())
        return self._solution(p)

    def best(self, start: list[float]) -> Solution:
        def evaluate(p: np.ndarray) -> Point:
            return Point(p, self.residual(p), lambda: self.jacobian(p))

        first = evaluate(np.array(start))
        found = minimize_squares(evaluate, first, bounds=self.parameters.bounds, tolerance=1e-12).point
        return self._solution(found.p)

    def _solution(self, p: np.ndarray) -> Solution:
        r, J = self.model(p)
        return Solution(p=p, covariance=inverse_information(J), jacobian=J, chi2=float(r @ r), dof=100)


@dataclass
class Logarithm:
    """A quantity whose logarithm is the first parameter."""

    name: str = "c"
    low: float = 0.0
    high: float = 10.0

    def read(self, p: np.ndarray) -> float:
        return float(p[0])

    def gradient(self, p: np.ndarray) -> np.ndarray:
        return np.eye(len(p))[0]

    def scale(self, p: np.ndarray) -> float:
        return 1.0

    def si(self, coordinate: float) -> float:
        return float(np.exp(coordinate))


def of_a_mean(value: float, sigma: float, *, correlation: float = 0.0, misfit: float = 0.0) -> Known:
    """exp(p0) was measured as `value` ± `sigma`; a second parameter is correlated with it. Nothing mends `misfit`."""
    mix = np.array([[1.0, 0.0], [correlation, np.sqrt(1 - correlation**2)]])
    whiten = np.linalg.inv(np.linalg.cholesky(mix @ mix.T))

    def model(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        off = np.array([(np.exp(p[0]) - value) / sigma, p[1]])
        J = whiten @ np.diag([np.exp(p[0]) / sigma, 1.0])
        return np.append(whiten @ off, misfit), np.vstack([J, [0.0, 0.0]])

    return Known(model, [0.0, -50.0], [10.0, 50.0])


@pytest.mark.parametrize("correlation", [0.0, 0.95])
def test_the_interval_is_that_of_the_measured_value_whatever_the_coordinate(correlation: float) -> None:
    problem = of_a_mean(10.0, 2.0, correlation=correlation)
    best = problem.best([2.0, 0.0])
    assert profile_interval(problem, best, Logarithm(), rise=RISE) == pytest.approx(
        (10.0 - HALF * 2, 10.0 + HALF * 2), abs=0.01 * HALF * 2
    )


def test_an_end_that_the_bound_forestalls_is_the_bound() -> None:
    problem = of_a_mean(3.0, 2.0)
    low, high = profile_interval(problem, problem.best([2.0, 0.0]), Logarithm(), rise=RISE) or (0, 0)
    assert low == 1.0
    assert high == pytest.approx(3.0 + HALF * 2, abs=0.04)


def test_an_estimate_at_its_bound_has_the_limit_that_chi2_allows_from_there() -> None:
    problem = of_a_mean(0.2, 1.0)
    best = problem.best([2.0, 0.0])
    assert best.p[0] == 0.0
    low, high = profile_interval(problem, best, Logarithm(), rise=RISE) or (0, 0)
    assert low == 1.0
    assert ((high - 0.2) ** 2 - 0.8**2) == pytest.approx(RISE, rel=0.02)


def test_another_parameter_at_its_bound_does_not_stop_the_way() -> None:
    problem = of_a_mean(10.0, 2.0, correlation=0.99)
    problem.low[1] = -0.1  # the lower end would take it to -1.94
    low, _ = profile_interval(problem, problem.best([2.0, 0.0]), Logarithm(), rise=RISE) or (0, 0)
    off = (low - 10.0) / 2
    least = off**2 + (-0.1 - 0.99 * off) ** 2 / (1 - 0.99**2)  # of a normal pair, the second held at -0.1
    assert least == pytest.approx(RISE, rel=0.02)


def test_where_the_fit_is_worse_than_the_noise_the_interval_is_wider() -> None:
    problem = of_a_mean(100.0, 2.0, misfit=20.0)  # chi2 is four times the 100 degrees of freedom
    assert profile_interval(problem, problem.best([4.0, 0.0]), Logarithm(), rise=RISE) == pytest.approx(
        (100 - 2 * HALF * 2, 100 + 2 * HALF * 2), abs=0.08
    )


def of_a_vector(re: float, im: float) -> Known:
    """An unbalance measured as re + j im, both ± 1."""
    return Known(lambda p: (p - [re, im], np.eye(2)), [-np.inf] * 2, [np.inf] * 2)


def test_amount_and_phase_of_a_vector_are_those_of_its_circle_of_confidence() -> None:
    problem = of_a_vector(0.0, 5.0)
    best = problem.best([1.0, 1.0])
    at = slice(0, 2)
    amount = profile_interval(problem, best, Amount(name="u", at=at), rise=RISE)
    assert amount == pytest.approx((5 - HALF, 5 + HALF), abs=0.01 * HALF)
    half = np.arcsin(HALF / 5)
    phase = profile_interval(problem, best, Phase(name="phase", at=at, origin=np.pi / 2), rise=RISE)
    assert phase == pytest.approx((np.pi / 2 - half, np.pi / 2 + half), abs=0.01 * half)


def test_a_vector_that_may_be_none_has_an_upper_limit_and_no_phase() -> None:
    problem = of_a_vector(1.5, 0.0)
    best = problem.best([1.0, 1.0])
    at = slice(0, 2)
    assert profile_interval(problem, best, Amount(name="u", at=at), rise=RISE) == pytest.approx(
        (0.0, 1.5 + HALF), abs=0.02
    )
    assert profile_interval(problem, best, Phase(name="phase", at=at, origin=0.0), rise=RISE) is None
