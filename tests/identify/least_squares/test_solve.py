"""The solver of a fit on a line through points, where every figure is known by hand."""

from dataclasses import dataclass

import numpy as np
import pytest

from rotorrig.identify.least_squares.solve import (
    Index,
    Reals,
    Stop,
    inverse_information,
    inverse_information_root,
    solve,
    squared_distance,
)
from rotorrig.rig.errors import DataError


@dataclass(frozen=True)
class Line:
    """Points y of a + b x with sigma 1; a within +-10."""

    x: Reals
    y: Reals

    @property
    def bounds(self) -> tuple[Reals, Reals]:
        return np.array([-10.0, -np.inf]), np.array([10.0, np.inf])

    @property
    def size(self) -> int:
        return len(self.x)

    def residual(self, p: Reals) -> Reals:
        return p[0] + p[1] * self.x - self.y

    def jacobian(self, p: Reals, free: Index | None = None) -> Reals:
        J = np.stack([np.ones_like(self.x), self.x], axis=1)
        return J if free is None else J[:, free]

    def solve_linear(self, p: Reals, free: Index) -> Reals:
        return p


X = np.array([-1.0, 0.0, 1.0, 2.0])
OFF = np.array([0.1, -0.2, 0.1, 0.0])


def test_a_line_is_found_with_the_textbooks_covariance() -> None:
    found = solve(Line(X, 3 + 2 * X + OFF), np.zeros(2))
    slope, offset = np.polyfit(X, 3 + 2 * X + OFF, 1)
    np.testing.assert_allclose(found.p, [offset, slope], rtol=1e-4)
    assert found.dof == 2
    spread = np.sum((X - X.mean()) ** 2)
    np.testing.assert_allclose(found.sigma, [np.sqrt(1 / 4 + X.mean() ** 2 / spread), np.sqrt(1 / spread)], rtol=1e-6)


def test_a_fit_may_end_at_a_share_of_what_noise_does_not_explain() -> None:
    """0.3 of chi2 itself, 7.96, is more than the 1.96 to be gained; of what is beyond its 2 degrees of freedom less."""
    near, line = np.array([3.7, 2.0]), Line(X, 3 + 2 * X + 10 * OFF)
    ended, of_excess = (solve(line, near, share=0.3, of_excess=excess, tolerance=0.0) for excess in (False, True))
    assert ended.chi2 == pytest.approx(7.96)
    assert of_excess.chi2 == pytest.approx(6.0)


def test_a_fit_worse_than_the_noise_widens_its_covariance() -> None:
    quiet, loud = (solve(Line(X, scale * OFF), np.zeros(2)) for scale in (1.0, 100.0))
    assert loud.chi2 == pytest.approx(1e4 * quiet.chi2)
    np.testing.assert_allclose(loud.covariance, quiet.covariance * loud.chi2 / 2)


def test_what_is_held_keeps_its_value_and_costs_no_degree_of_freedom() -> None:
    found = solve(Line(X, 3 + 2 * X), np.zeros(2), fixed={1: 0.0})
    np.testing.assert_allclose(found.p, [np.mean(3 + 2 * X), 0.0], rtol=1e-4)
    assert found.dof == 3
    assert not found.covariance[1].any()
    assert not found.jacobian[:, 1].any()


def test_the_solution_keeps_within_the_bounds() -> None:
    assert solve(Line(X, 50 + X), np.zeros(2)).p[0] == pytest.approx(10.0)


def test_what_no_row_restricts_is_said_to_be_unknown_not_well_known() -> None:
    covariance = inverse_information(np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]))
    assert (np.diag(covariance) > 1e12).all(), "two rows cannot tell three columns apart"
    alone = inverse_information(np.array([[2.0, 0.0], [0.0, 1e-3]]))
    np.testing.assert_allclose(alone, np.diag([0.25, 1e6]))


def test_a_distance_counts_what_is_known_beside_what_is_left_open() -> None:
    root = inverse_information_root(np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1e-6]]))  # of a pair, the sum alone is known
    off = np.array([2.0, 4.0, 2e6])
    assert squared_distance(off, root) == pytest.approx(36.0 + 4.0, rel=1e-6)
    assert squared_distance(off, np.hstack([root, root])) == pytest.approx(20.0, rel=1e-6)
    known = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert squared_distance(off[:2], np.linalg.cholesky(known)) == pytest.approx(
        off[:2] @ np.linalg.solve(known, off[:2])
    )


class Unstable(Line):
    """A rotor that is unstable: whatever the second parameter stands for moves it without bound."""

    def residual(self, p: Reals) -> Reals:
        return p[0] - self.y

    def jacobian(self, p: Reals, free: Index | None = None) -> Reals:
        J = np.stack([np.ones_like(self.x), np.full_like(self.x, 1e200)], axis=1)
        return J if free is None else J[:, free]


@pytest.mark.filterwarnings("error")
def test_along_what_moves_the_model_without_bound_no_step_is_taken() -> None:
    found = solve(Unstable(X, 3 + OFF), np.array([0.0, 5.0]))
    np.testing.assert_allclose(found.p, [3.0, 5.0], rtol=1e-4)
    assert found.stop is Stop.CONVERGED
    assert found.sigma[1] > 1e6  # not known, where a square that overflows would say exactly


class Walled(Line):
    """The same, without an answer beyond a = 2."""

    def residual(self, p: Reals) -> Reals:
        if p[0] > 2.0:
            raise DataError("there is no motion")
        return super().residual(p)


def test_a_step_to_where_the_model_has_no_motion_is_taken_back() -> None:
    assert 0.0 < solve(Walled(X, 3 + 2 * X), np.zeros(2)).p[0] <= 2.0


def test_a_fit_that_begins_where_there_is_none_says_so() -> None:
    with pytest.raises(DataError, match="no motion"):
        solve(Walled(X, 3 + 2 * X), np.array([3.0, 0.0]))


def test_a_jacobian_that_is_known_at_the_start_is_not_taken_again() -> None:
    taken = []

    class Counted(Line):
        def jacobian(self, p: Reals, free: Index | None = None) -> Reals:
            taken.append(p)
            return super().jacobian(p, free)

    line, start = Counted(X, 3 + 2 * X + OFF), np.zeros(2)
    plain = solve(line, start)
    usual, known = len(taken), Line(X, line.y).jacobian(start)
    found = solve(line, start, jacobian=known)
    assert len(taken) - usual == usual - 1
    np.testing.assert_allclose(found.p, plain.p)
    held = solve(line, np.array([0.0, 1.5]), fixed={1: 2.0}, jacobian=known)
    np.testing.assert_allclose(held.p, [np.mean(3 + OFF), 2.0], rtol=1e-6)
