"""Pulls of a fit by groups of the config's statements, and the statements that the data contradict.

A group is judged by its joint pull. Beyond `UNCERTAINTY.pulled` sigmas the one statement is sought that, without its
prior, explains most: that is a finding, and what without its own leaves no pull is an alternative. The rest is judged
with that prior taken away, so one wrong position does not make findings of all that the fit moved to make up for it.

Members at their bound of zero, hubs and tilt stiffness, are not pulled: they are taken to be there. And what the data
would need a statement to be off by may be more than can be, a bearing softer than none at all: that is no finding, for
something else pulls there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedParameters, ExtendedProblem
from rotorrig.identify.identification import Deviation, NameplateCheck, NameplateFinding, Pull
from rotorrig.identify.least_squares import Solution, inverse_information
from rotorrig.identify.uncertainty.nameplate_members import Member, nameplate_groups
from rotorrig.identify.uncertainty.nuisance_posterior import NuisancePosterior
from rotorrig.identify.uncertainty.settings import UNCERTAINTY

MOST = 3  # findings that are looked for
SHARE_OFF = (-1.0, 2.0)  # of what is stated: from nothing to three times as much
SHOWN = {"m": ("mm", 1e3), "rad": ("deg", 180 / math.pi), "": ("%", 100.0)}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Statement:
    """A member, and its direction among the nuisances kept."""

    member: Member
    direction: Reals

    @property
    def possible(self) -> tuple[float, float]:
        """How far it may be off, in units of its nuisances."""
        is_share = not self.member.unit and not self.member.one_sided
        return SHARE_OFF if is_share else (-math.inf, math.inf)


Groups = Mapping[str, Mapping[str, _Statement]]  # group -> title -> statement


def check_nameplate(best: Solution, problem: ExtendedProblem) -> NameplateCheck:
    """Return the pulls of a fit, the largest first, and what of the config they say is wrong."""
    kept, posterior = nuisance_posterior(best, problem.parameters)
    groups = _directions(problem, kept)
    pulls = [_pull(posterior, name, members) for name, members in groups.items()]
    return NameplateCheck(
        pulls=tuple(sorted(pulls, key=lambda pull: -pull.sigmas)), findings=tuple(_findings(posterior, groups))
    )


def nuisance_pulls(best: Solution, names: ExtendedParameters) -> dict[str, float]:
    """Return the pull of every nuisance alone, by name; one at its bound of zero has 0."""
    kept, posterior = nuisance_posterior(best, names)
    pulls = {name: posterior.along(u).pull for name, u in zip(kept, np.eye(len(kept)), strict=True)}
    return {names.names[i]: pulls.get(names.names[i], 0.0) for i in names.priors}


def nuisance_posterior(best: Solution, names: ExtendedParameters) -> tuple[list[str], NuisancePosterior]:
    """Return the names of the nuisances that are not at a bound, and what the fit makes of them.

    Nothing at a bound counts as free, a cause's unknown neither: the fit is no minimum along it, which the posterior
    takes it for.
    """
    at_bound = names.at_bound(best.p)
    free = np.setdiff1d(np.arange(len(names)), at_bound)
    mine = np.setdiff1d(names.priors, at_bound)
    sigma = names.stated_sigma[mine]
    places = np.searchsorted(free, mine)
    covariance = inverse_information(best.jacobian[:, free])[np.ix_(places, places)] / np.outer(sigma, sigma)
    x = names.prior_residual(best.p)[np.searchsorted(names.priors, mine)] * names.prior_sigma[mine] / sigma
    excess = max(1.0, best.chi2 / max(best.dof, 1))
    posterior = NuisancePosterior(x, covariance, np.eye(len(x)), excess)
    for i in np.flatnonzero(names.prior_sigma[mine] > sigma):
        posterior = posterior.with_stated_prior(int(i))
    return [names.names[i] for i in mine], posterior


def _directions(problem: ExtendedProblem, kept: list[str]) -> Groups:
    """Return by group and title the members of which no nuisance is at its bound."""
    names = problem.parameters
    sigma = dict(zip(names.names, names.stated_sigma, strict=True))
    return {
        group: {
            m.title: _Statement(
                member=m,
                direction=np.array([1 / sigma[name] if name in m.nuisances else 0.0 for name in kept]),
            )
            for m in members
            if set(m.nuisances) <= set(kept)
        }
        for group, members in nameplate_groups(names, problem.recordings[0].rig).items()
    }


def _pull(posterior: NuisancePosterior, group: str, members: Mapping[str, _Statement]) -> Pull:
    """Return the joint pull of a group and what the data say of each member alone."""
    deviations = [_describe_deviation(posterior, each) for each in members.values()]
    deviations.sort(key=lambda deviation: -abs(deviation.pull))
    return Pull(group=group, sigmas=_joint_pull(posterior, members), deviations=tuple(deviations))


def _joint_pull(posterior: NuisancePosterior, members: Mapping[str, _Statement]) -> float:
    return posterior.joint_pull([each.direction for each in members.values()])


def _describe_deviation(posterior: NuisancePosterior, of: _Statement) -> Deviation:
    """Return what the data alone say of one member; without pull or evidence if it cannot be off by as much."""
    member, along, length = of.member, posterior.along(of.direction), float(np.linalg.norm(of.direction))
    value, sigma = along.value / length, along.sigma / length
    off, spread = member.deviation(value), sigma * member.slope(value)
    low, high = of.possible
    possible = max(low - value, value - high) < UNCERTAINTY.unsure * sigma and (value > 0 or not member.one_sided)
    return Deviation(
        kind=member.kind,
        where=member.where,
        title=member.title,
        words=member.words(_write_size(member, value, sigma)),
        value=off,
        sigma=spread,
        unit=member.unit,
        nameplate=member.nameplate,
        nameplate_unit=member.nameplate_unit,
        pull=along.pull if possible else 0.0,
        evidence=along.evidence if possible else 0.0,
        nuisances=member.nuisances,
        parameter=member.parameter,
    )


def _write_size(member: Member, value: float, sigma: float) -> str:
    """Return how far a member is off; at least how far, where its nuisances are sure and what they stand for is not.

    A hub that takes all flexibility away is as stiff as a shaft of any thickness.
    """
    shown, factor = SHOWN.get(member.unit, (member.unit, 1.0))
    off, spread = member.deviation(value) * factor, sigma * member.slope(value) * factor
    sure = value - UNCERTAINTY.unsure * sigma
    if member.one_sided and spread > off and sure > 0:
        return f"+at least {member.deviation(sure) * factor:.2g} {shown}"
    return _size(off, spread, shown)


def _size(value: float, sigma: float, unit: str) -> str:
    """Return "+2.10 ± 0.20 mm", as many digits as the sigma warrants.

    >>> _size(-2.104, 0.31, "mm"), _size(21.04, 3.4, "%")
    ('-2.10 ± 0.31 mm', '+21.0 ± 3.4 %')
    """
    if not (0 < sigma < math.inf):
        return f"{value:+.3g} {unit}"
    digits = max(0, 1 - math.floor(math.log10(sigma)))
    return f"{value:+.{digits}f} ± {sigma:.{digits}f} {unit}"


def _findings(posterior: NuisancePosterior, groups: Groups) -> list[NameplateFinding]:
    """Return the findings one after the other, the priors of those before taken away."""
    found: list[NameplateFinding] = []
    while len(found) < MOST:
        pulls = {group: _joint_pull(posterior, members) for group, members in groups.items()}
        told = [
            (group, _describe_deviation(posterior, each))
            for group, members in groups.items()
            for each in members.values()
        ]
        ranked = sorted((each for each in told if each[1].evidence > 0), key=lambda each: -each[1].evidence)
        best = next((each for each in ranked if pulls[each[0]] > UNCERTAINTY.pulled), None)
        if best is None:
            break
        group, deviation = best
        instead = [
            other
            for name, other in ranked
            if other is not deviation and _explains(posterior, groups[name][other.title].direction, groups[group])
        ]
        found.append(
            NameplateFinding(group=group, sigmas=pulls[group], deviation=deviation, alternatives=tuple(instead))
        )
        posterior = posterior.without_prior(groups[group][deviation.title].direction)
        groups = {name: {t: of for t, of in part.items() if t != deviation.title} for name, part in groups.items()}
    return found


def _explains(posterior: NuisancePosterior, direction: Reals, group: Mapping[str, _Statement]) -> bool:
    """Say whether a group is pulled no more once the prior along a direction is taken away."""
    return _joint_pull(posterior.without_prior(direction), group) <= UNCERTAINTY.pulled
