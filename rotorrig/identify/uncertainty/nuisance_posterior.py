"""Pull of nuisances: how far a fit has moved them from what the config says, in standard deviations of that.

All in units of the priors: x is a deviation over its prior's standard deviation, P the covariance of x after the fit.
If the config is right within its priors, the fitted x scatters with I - P (Gaussian prior and noise, linear model);
where the variance of the noise is e times what is stated, with (I - P)(I + (e - 1) P). The pull is x over the root of
that: one on average, large where the data insist on what the prior forbids. An estimate and one that is more efficient
differ by the difference of their variances: Hausman, Econometrica 46 (1978) 1251.

What the data alone would say along a direction u, its prior taken away and all others kept, follows from the same
numbers: value u.x / (1 - u.P.u) and variance u.P.u / (1 - u.P.u). The pull squared is by how much chi2 falls then.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc, ndtri

from rotorrig.identify.extended_model import EXTENDED_MODEL

Reals = NDArray[np.float64]

WIDER = EXTENDED_MODEL.wider  # prior sigmas: standard deviation of a statement that is wrong
KNOWN = 0.5  # share of a prior variance that the data have to take away: a direction less known shows no pull
ROUNDING = 1e-9  # of a prior variance: the data say nothing at all


@dataclass(frozen=True, slots=True)
class AlongDirection:
    """A direction of unit length in units of the priors: what the data say of it."""

    pull: float  # signed, in standard deviations
    value: float  # prior sigmas, by the data alone; 0 where they say nothing
    sigma: float  # one standard deviation of that; infinite where they say nothing
    evidence: float  # twice the logarithm of how much likelier the data are if the prior is `WIDER` times as wide


@dataclass(frozen=True, slots=True)
class NuisancePosterior:
    """Nuisances after a fit."""

    x: Reals  # (nuisance,) prior sigmas
    covariance: Reals  # (nuisance, nuisance) of x, noise as stated
    prior: Reals  # (nuisance, nuisance) inverse covariance of the priors: the identity, less directions without one
    excess: float = 1.0  # variance of the noise over what is stated

    def along(self, direction: Reals) -> AlongDirection:
        """Return what the data say along a direction (nuisance,) of any length that has its prior."""
        u = direction / np.linalg.norm(direction)
        told = 1 - float(u @ self.covariance @ u)
        if told < ROUNDING:
            return AlongDirection(pull=0.0, value=0.0, sigma=np.inf, evidence=0.0)
        value, square = float(u @ self.x) / told, float(u @ self._scatter() @ u) / told**2
        wider = square + WIDER**2 - 1
        return AlongDirection(
            pull=float(value / np.sqrt(square)),
            value=value,
            sigma=float(np.sqrt(max(square - 1, 0.0))),
            evidence=float(value**2 * (1 / square - 1 / wider) - np.log(wider / square)),
        )

    def joint_pull(self, directions: Sequence[Reals]) -> float:
        """Return the pull of several directions (nuisance,) together, as standard deviations of one as improbable.

        Tested are all at once, by the eigen-directions that the data know better than the prior, and each alone, as a
        single wrong statement would be lost among many right ones; the number of tests is paid for.
        """
        members = np.flatnonzero(np.any([u != 0 for u in directions], axis=0)) if len(directions) else np.zeros(0, int)
        left, vectors = np.linalg.eigh(self.covariance[np.ix_(members, members)])
        known = vectors[:, left < 1 - KNOWN]
        alone = [self.along(u) for u in directions]
        tests = [(each.pull**2, 1) for each in alone if np.isfinite(each.sigma)]
        if known.shape[1] > 1:
            moved = known.T @ self.x[members]
            scatter = known.T @ self._scatter()[np.ix_(members, members)] @ known
            tests.append((float(moved @ np.linalg.solve(scatter, moved)), known.shape[1]))
        return most_improbable(tests)

    def with_stated_prior(self, nuisance: int) -> "NuisancePosterior":
        """Return the nuisances of a fit in which one had a prior `WIDER` times as wide, with that prior as stated."""
        more = 1 - 1 / WIDER**2
        spread = self.covariance[nuisance]
        share = more / (1 + more * spread[nuisance])
        return replace(
            self,
            x=self.x - share * self.x[nuisance] * spread,
            covariance=self.covariance - share * np.outer(spread, spread),
        )

    def without_prior(self, direction: Reals) -> "NuisancePosterior":
        """Return the nuisances of a fit that has no prior along a direction (nuisance,), all others kept.

        By a rank-one update (Sherman and Morrison); chi2 counts as a parabola.
        """
        u = direction / np.linalg.norm(direction)
        spread = self.covariance @ u
        told = max(1 - float(u @ spread), ROUNDING)
        return replace(
            self,
            x=self.x + spread * float(u @ self.x) / told,
            covariance=self.covariance + np.outer(spread, spread) / told,
            prior=self.prior - np.outer(u, u),
        )

    def _scatter(self) -> Reals:
        """Return the covariance of x if the config is right within its priors, where they have one."""
        P, D = self.covariance, self.prior
        of_priors = P @ D @ P
        return D - D @ P - P @ D + of_priors + self.excess * (P - of_priors)


def most_improbable(tests: Sequence[tuple[float, int]]) -> float:
    """Return the most improbable of some (chi2, degrees of freedom) as standard deviations of one normal variable.

    Two-sided; that it is the worst of so many is paid for (Sidak, J. Am. Stat. Assoc. 62 (1967) 626).

    >>> round(most_improbable([(9.0, 1)]), 3), round(most_improbable([(9.0, 3)]), 3)
    (3.0, 2.18)
    >>> round(most_improbable([(9.0, 1), (0.0, 1)]), 3)
    2.783
    """
    if not tests:
        return 0.0
    p = min(float(chdtrc(freedom, square)) for square, freedom in tests)
    if p == 0:  # less than can be told: no number of tests makes it probable
        return float(np.sqrt(max(square for square, _ in tests)))
    return float(-ndtri(-np.expm1(len(tests) * np.log1p(-min(p, 1 - ROUNDING))) / 2))
