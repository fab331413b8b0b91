"""How probable every place of the shaft is for a force: its profile likelihood, all other unknowns fitted anew.

Source: any text on profile likelihood; Venzon, Moolgavkar, Applied Statistics 37 (1988) 87.
"""

from collections.abc import Sequence

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import Candidate
from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.rig import DataError
from rotorrig.sims.effects import FoundForce


def place_probability(found: Sequence[Candidate], places: Reals) -> Reals:
    """Return the probability (place,) over the laws that were found, each by its evidence; fits of readings have none.

    A fit that is worse than the noise knows the place less well.
    """
    scale = max(1.0, found[0].polished.chi2 / found[0].polished.dof)
    total = np.zeros(len(places))
    for each in found:
        if isinstance(each.effect, FoundForce):
            weight = np.exp(-_chi2_above_best(each, places, scale) / (2 * scale))
            total += np.exp((each.evidence - found[0].evidence) / (2 * scale)) * weight / weight.sum()
    return total / total.sum()


def _chi2_above_best(found: Candidate, places: Reals, scale: float) -> Reals:
    """Return by how much chi2 is above that of the fit at each place: fitted at some, between them interpolated."""
    effect, names = found.effect, found.problem.parameters
    assert isinstance(effect, FoundForce)
    index = names.theta[-1].start
    size = effect.parameters[0].size
    best = effect.place(names.of_effect(found.polished.p, len(names.effects) - 1))
    sigma = float(found.polished.sigma[index]) * size
    step = float(np.clip(sigma, DISCOVERY.step / 2, (places[-1] - places[0]) / (DISCOVERY.fits - 2)))
    known = {best: 0.0}
    for way in (-1, 1):
        p, z = found.polished.p.copy(), best
        for _ in range(DISCOVERY.fits // 2):
            z = float(np.clip(z + way * step, places[0], places[-1]))
            p[index] = z / size
            try:
                fit = found.problem.solve(
                    p, fixed={index: z / size}, tolerance=DISCOVERY.within, max_steps=DISCOVERY.rounds
                )
            except (DataError, np.linalg.LinAlgError):
                break  # no motion is found there
            if not np.isfinite(fit.chi2):
                break
            p, known[z] = fit.p.copy(), fit.chi2 - found.polished.chi2
            if known[z] > DISCOVERY.unlikely * scale or z in (places[0], places[-1]):
                break
    return _interpolate(known, places, curvature=1 / max(sigma, DISCOVERY.step / 2) ** 2)


def _interpolate(known: dict[float, float], places: Reals, *, curvature: float) -> Reals:
    """Return chi2 between the places known by straight lines of its root, and beyond them as a parabola goes on."""
    z = np.array(sorted(known))
    root = np.sqrt(np.maximum([known[each] - min(known.values()) for each in z], 0.0))
    inside = np.interp(places, z, root)
    beyond = np.maximum(np.maximum(z[0] - places, places - z[-1]), 0.0)
    return (inside + beyond * np.sqrt(curvature)) ** 2
