"""How probable every place of the shaft is for a force: its profile likelihood, all other unknowns fitted anew.

Source: any text on profile likelihood; Venzon, Moolgavkar, Applied Statistics 37 (1988) 87.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import Candidate, refit
from rotorrig.identify.discovery.robust_sigma import robust_sigma
from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.rig import DataError
from rotorrig.sims.effects import FoundForce


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceProfile:
    """Fits of one force with its place held, and the one with its place free."""

    chi2: dict[float, float]  # place [m] -> chi2
    p: dict[float, Reals]  # place [m] -> unknowns
    sigma: float  # m, one standard deviation at the free fit, by its curvature
    scale: float  # of chi2: what a difference counts less than in a fit that only noise is left of

    @property
    def best(self) -> float:
        """The place of least chi2."""
        return min(self.chi2, key=self.chi2.__getitem__)


def move_to_best_place(
    found: Candidate, places: Reals, *, profiled: bool = True
) -> tuple[Candidate, PlaceProfile | None]:
    """Return a fit at the best place of its profile, and the profile; None for a reading.

    Law and place bend each other, and a fit may end beside the best place. Without being `profiled` it stays where it
    is. Raises LinAlgError.
    """
    if not isinstance(found.effect, FoundForce):
        return found, None
    if not profiled:
        return found, estimate_place(found)
    profile = profile_place(found, places)
    for _ in range(DISCOVERY.moves):
        if found.polished.chi2 - profile.chi2[profile.best] < DISCOVERY.within * profile.scale:
            break
        fit = refit(found.problem, profile.p[profile.best])
        if not fit.chi2 < found.polished.chi2:
            break
        found = replace(found, polished=fit)
        profile = profile_place(found, places)
    return found, profile


def place_probability(best: PlaceProfile, rivals: Sequence[tuple[float, PlaceProfile]], places: Reals) -> Reals:
    """Return the probability (place,) over the laws that were found; `rivals` are (evidence below the best's, profile).

    A fit that is worse than the noise knows the place less well.
    """
    total = np.zeros(len(places))
    for behind, profile in ((0.0, best), *rivals):
        weight = np.exp(-_interpolate(profile, places) / (2 * profile.scale))
        total += np.exp(-behind / (2 * best.scale)) * weight / weight.sum()
    return total / total.sum()


def profile_place(found: Candidate, places: Reals) -> PlaceProfile:
    """Fit at places on both sides of that of a fit, until none further on is likely. Raises LinAlgError.

    These fits end where no more is to be gained than tells: of a fit that is worse than the noise chi2 tells less.
    """
    known, index = estimate_place(found), found.problem.parameters.theta[-1].start
    size, free = found.effect.parameters[0].size, known.best
    step = float(np.clip(known.sigma, DISCOVERY.step / 2, (places[-1] - places[0]) / (DISCOVERY.fits - 2)))
    for way in (-1, 1):
        p, z = found.polished.p.copy(), free
        for _ in range(DISCOVERY.fits // 2):
            z = float(np.clip(z + way * step, places[0], places[-1]))
            p[index] = z / size
            try:
                fit = found.problem.solve(
                    p, fixed={index: z / size}, tolerance=DISCOVERY.within * known.scale, max_steps=DISCOVERY.rounds
                )
            except (DataError, np.linalg.LinAlgError):
                break  # no motion is found there
            if not np.isfinite(fit.chi2):
                break
            p, known.chi2[z], known.p[z] = fit.p.copy(), fit.chi2, fit.p
            behind = fit.chi2 - min(known.chi2.values())
            if behind > DISCOVERY.unlikely * known.scale or z in (places[0], places[-1]):
                break
    return known


def estimate_place(found: Candidate) -> PlaceProfile:
    """Return the profile of a place by the curvature at its fit alone. Raises LinAlgError."""
    effect, names = found.effect, found.problem.parameters
    assert isinstance(effect, FoundForce)
    index = names.theta[-1].start
    spread = robust_sigma(found.problem, found.polished, index) / float(found.polished.sigma[index])
    scale = max(found.polished.chi2 / found.polished.dof, spread**2, 1.0)
    place = effect.place(names.of_effect(found.polished.p, len(names.effects) - 1))
    sigma = float(found.polished.sigma[index]) * effect.parameters[0].size
    return PlaceProfile(chi2={place: found.polished.chi2}, p={place: found.polished.p}, sigma=sigma, scale=scale)


def _interpolate(profile: PlaceProfile, places: Reals) -> Reals:
    """Return chi2 above the least: between places known by straight lines of its root, beyond them by a parabola."""
    z = np.array(sorted(profile.chi2))
    chi2 = np.array([profile.chi2[each] for each in z])
    root = np.sqrt(chi2 - chi2.min())
    inside = np.interp(places, z, root)
    beyond = np.maximum(np.maximum(z[0] - places, places - z[-1]), 0.0)
    return (inside + beyond / max(profile.sigma, DISCOVERY.step / 2)) ** 2
