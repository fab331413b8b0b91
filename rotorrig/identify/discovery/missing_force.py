"""`MissingForce`: what a model lacks though no known cause explains it, where it acts and how it goes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy import Adequacy
from rotorrig.identify.causes import SELECTION, Candidate, plausible
from rotorrig.identify.discovery.force_over_speed import ForceOverSpeed, reconstruct_force
from rotorrig.identify.discovery.force_search import grid
from rotorrig.identify.discovery.place_probability import (
    PlaceProfile,
    estimate_place,
    place_probability,
    profile_place,
)
from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty import check_nameplate
from rotorrig.identify.verdict import VERDICT, Predictions
from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects import LAWS, FoundForce, FoundReading, Law

BESIDE = 0.025  # m: a part so near to a place is named with it


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival:
    """Another force or reading that explains nearly as much."""

    words: str
    evidence: float  # BIC by which it is behind the one that was found


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingForce:
    """A force at a place of the shaft, or what a probe reads besides, that the model lacks."""

    kind: Literal["force", "moment", "reading"]
    words: str  # where and how, in a sentence
    laws: tuple[str, ...]
    like: tuple[str, ...]  # what in textbooks has such a law
    place: float  # m from the coupling; NaN of a reading
    place_sigma: float  # m, one standard deviation, for this law
    places: NDArray[np.float64]  # (place,) m, along the shaft; empty of a reading
    probability: NDArray[np.float64]  # (place,) that it is there, of this law or one that explains nearly as much
    rivals: tuple[Rival, ...]
    over_speed: ForceOverSpeed | None  # of a reading: None
    shortfall: str  # why it does not count as found, in words; "": it does

    @property
    def is_described(self) -> bool:
        """Whether it counts as found: real, with a law that predicts what no fit saw, and somewhere."""
        return not self.shortfall


def missing_force(
    problem: ExtendedProblem,
    tried: Sequence[Candidate],
    fit: Solution,
    profile: PlaceProfile | None,
    *,
    profiled: bool = True,
) -> MissingForce:
    """Return what was found, the first of `tried` in its final fit; `problem` is that without it.

    `profile` is that of its place; None of a reading. Its rivals' places are `profiled` as well, or estimated.
    """
    best, effect = replace(tried[0], polished=fit), tried[0].effect
    rivals = [c for c in tried[1:] if plausible(c) and best.evidence - c.evidence < VERDICT.nameable]
    told = tuple(Rival(words=_words_of(c), evidence=best.evidence - c.evidence) for c in rivals)
    if not isinstance(effect, FoundForce) or profile is None:
        return MissingForce(
            kind="reading",
            words=_words_of(best),
            laws=effect.laws if isinstance(effect, FoundReading) else (),
            like=("a fault of that probe, its cable or its mounting",),
            place=np.nan,
            place_sigma=np.nan,
            places=np.zeros(0),
            probability=np.zeros(0),
            rivals=told,
            over_speed=None,
            shortfall="",
        )
    rig, laws = problem.recordings[0].rig, [LAWS[name] for name in effect.laws]
    theta = _theta(best)
    place, sigma = effect.place(theta), _place_sigma(best, profile)
    how = " and ".join(f"{law.words(theta)} (± {_relative_sigma(law, best):.0f} %)" for law in laws)
    return MissingForce(
        kind="moment" if all(law.tilts for law in laws) else "force",
        words=f"at {1e3 * place:.0f} ± {1e3 * sigma:.0f} mm from the coupling{_beside(rig, place)} acts {how}",
        laws=effect.laws,
        like=tuple(law.textbook for law in laws if law.textbook),
        place=place,
        place_sigma=sigma,
        places=grid(rig),
        probability=place_probability(profile, _profiles(rivals, best, profiled=profiled), grid(rig)),
        rivals=told,
        over_speed=reconstruct_force(problem, best),
        shortfall="",
    )


def shortfall(
    before: Solution, found: Candidate, missing: MissingForce, after: Adequacy, predictions: Predictions, *, tries: int
) -> str:
    """Return why what was found does not count: it is not sure, no law, predicts nothing, or is nowhere; "": it counts.

    `found` is in its final fit; `tries` are the laws and places that were looked at.
    """
    price = SELECTION.detected + 2 * float(np.log(tries))
    if not plausible(found) or found.evidence < SELECTION.enough or found.lam < price:
        return "it explains no more than chance might"
    if leaves_too_much(before, found, after):
        return f"it leaves {100 * min(_left(before, found), 1.0):.0f} % of the misfit"
    lower = predictions.better and predictions.after.error < predictions.before.error
    if not lower or predictions.after.over_expected > DISCOVERY.over_expected:
        return (
            f"data no fit saw are {predictions.after.over_expected:.1f} times as far off as noise and the model's own "
            "error would be"
        )
    pulls = [finding.sigmas for finding in check_nameplate(found.polished, found.problem).findings]
    wrong = [sigmas for sigmas in pulls if sigmas > VERDICT.pulled]
    if sum(sigmas**2 for sigmas in wrong) > DISCOVERY.beside * found.lam:
        return f"beside it the config would be wrong in {len(wrong)} thing{'s' if len(wrong) > 1 else ''}"
    if missing.places.size and not (spread := _spread(missing)) <= DISCOVERY.widest:
        return f"where it acts is not known: {1e3 * spread:.0f} mm, one standard deviation over all laws as good"
    return ""


def leaves_too_much(before: Solution, found: Candidate, after: Adequacy) -> bool:
    """Say whether what was found leaves more of the misfit than a law may."""
    return not after.adequate and _left(before, found) > 1 - DISCOVERY.explained


def _left(before: Solution, found: Candidate) -> float:
    """Return the share of the misfit that is left."""
    return (found.polished.chi2 - found.polished.dof) / max(before.chi2 - before.dof, 1.0)


def _spread(missing: MissingForce) -> float:
    """Return the standard deviation of the place over all laws, no less than that of its own."""
    mean = missing.places @ missing.probability
    return max(float(np.sqrt((missing.places - mean) ** 2 @ missing.probability)), missing.place_sigma)


def _place_sigma(found: Candidate, profile: PlaceProfile) -> float:
    """Return one standard deviation of a place, for the law it was found with."""
    return min(profile.sigma * profile.scale**0.5, found.problem.recordings[0].rig.shaft.length)


def _profiles(rivals: Sequence[Candidate], best: Candidate, *, profiled: bool) -> list[tuple[float, PlaceProfile]]:
    """Return the profiles of other forces that explain nearly as much, with how far each is behind in evidence."""
    rig = best.problem.recordings[0].rig
    forces = [each for each in rivals if isinstance(each.effect, FoundForce)]
    return [
        (best.evidence - each.evidence, profile_place(each, grid(rig)) if profiled else estimate_place(each))
        for each in forces
    ]


def _relative_sigma(law: Law, found: Candidate) -> float:
    """Return one standard deviation of a law's amount, in percent of it."""
    names, last = found.problem.parameters, len(found.problem.effects) - 1
    size, sigma = (
        float(np.linalg.norm([values[name] for name in law.unknowns]))
        for values in (_theta(found), names.of_effect(found.polished.sigma, last))
    )
    return 100 * sigma / np.sqrt(len(law.unknowns)) / max(size, 1e-300)


def _theta(found: Candidate) -> dict[str, float]:
    return found.problem.parameters.of_effect(found.polished.p, len(found.problem.effects) - 1)


def _words_of(found: Candidate) -> str:
    return found.effect.words(_theta(found))


def _beside(rig: RigConfig, place: float) -> str:
    """Return the part that is nearest, in brackets; nothing where none is near."""
    parts = [(f"bearing {b.name}", b.position) for b in rig.bearings]
    parts += [(d.name if "disk" in d.name else f"disk {d.name}", d.position) for d in rig.disks]
    name, position = min(parts, key=lambda part: abs(part[1] - place))
    return f" ({name} is at {1e3 * position:.0f} mm)" if abs(position - place) < BESIDE else ""
