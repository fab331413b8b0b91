"""Where an effect that was fitted would rather be."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.causes.candidate_fit import better_guess
from rotorrig.identify.least_squares.solve import Solution
from rotorrig.rig.errors import DataError
from rotorrig.sims.effects.base import Effect, Parameter

PLACES = (1.0, 2.0, 4.0)


def problem(guesses: tuple[float, ...]) -> SimpleNamespace:
    """A base of one unknown, and an effect at a place: two valleys, about 1 and 4, the second one deeper."""
    place = Parameter(name="place", unit="m", low=0.0, high=5.0, size=0.5)
    effect = replace(Effect(), parameters=(place,), initial_guesses=tuple({"place": z} for z in guesses))

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        z = p[1] * place.size
        return np.array([p[0] - 10 * z, (z - 1) * (z - 4), 3.0 - z / 2])

    return SimpleNamespace(effects=(effect,), parameters=SimpleNamespace(theta=[slice(1, 2)]), residual=residual)


def fit(of: SimpleNamespace, z: float) -> Solution:
    """The least squares of the base with the effect at z."""
    p = np.array([10 * z, 2 * z])
    jacobian = np.array([[1.0, -5.0], [0.0, (2 * z - 5) / 2], [0.0, -0.25]])
    r = of.residual(p)
    return Solution(p=p, covariance=np.zeros((2, 2)), jacobian=jacobian, chi2=float(r @ r), dof=1)


def test_the_deeper_valley_is_seen_from_the_other_although_the_base_has_not_followed() -> None:
    of = problem(PLACES)
    found = better_guess(of, fit(of, 1.0))
    assert found is not None
    assert found.tolist() == [10.0, 8.0]  # the place alone has moved
    assert np.sum(of.residual(found) ** 2) > 100 * fit(of, 1.0).chi2, "as it stands it looks far worse"


def test_from_the_deeper_valley_there_is_nowhere_better() -> None:
    of = problem(PLACES)
    assert better_guess(of, fit(of, 4.0)) is None


def test_an_effect_without_beginnings_stays_where_it_is() -> None:
    of = problem(())
    assert better_guess(of, fit(of, 1.0)) is None


def test_a_place_where_there_is_no_motion_is_passed_over() -> None:
    of = problem(PLACES)
    fitted, known = fit(of, 1.0), of.residual

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        if p[1] == 4.0:
            raise DataError("no motion, want one")
        return known(p)

    of.residual = residual
    found = better_guess(of, fitted)
    assert found is not None and found[1] == 8.0
