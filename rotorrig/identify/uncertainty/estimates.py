"""From a refined parameter vector to values with uncertainties, as people ask for them."""

import math

import numpy as np

from rotorrig.identify.base_model import Unknown
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.identification import Estimate
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.nameplate_pulls import nuisance_pulls
from rotorrig.identify.uncertainty.settings import UNCERTAINTY
from rotorrig.rig.config import Unbalance

_UNITS = {"angle": "rad", "runout": "m", "keyphasor": "rad", "hum": "m", "position": "m", "tilt": "N m/rad"}


def estimate_unknowns(best: Solution, problem: ExtendedProblem, *, unseen: str) -> tuple[Estimate, ...]:
    """Return the unknowns of the [identify] table, then amount and phase of the unbalance plane by plane.

    `unseen` names the axes no probe looks along: coefficients of these are not determined.
    """
    names = problem.parameters.base
    space = names.space
    values = names.values(best.p)
    sigma = best.sigma[names.sought] * space.slopes(values)
    at_bound = set(problem.parameters.at_bound(best.p))
    estimates = []
    for i, unknown in enumerate(space.unknowns):
        hidden = any(axis in unseen for axis in unknown.axes)
        certain = sigma[i] < UNCERTAINTY.determined * space.references(values)[i]
        determined = bool(certain and not hidden and i not in at_bound)
        estimates.append(
            Estimate(
                name=unknown.name,
                value=float(values[i]),
                sigma=float(sigma[i]) if determined else math.inf,
                unit=unknown.unit,
                nameplate=unknown.nameplate,
                determined=determined,
                bounds=(unknown.low, unknown.high),
            )
        )
    if problem.model.amplitudes_alone:
        return (*estimates, _amount_alone(best, names.unbalance.start, space.amounts[0]))
    expected = {disk.name: disk.unbalance for disk in problem.recordings[0].rig.disks}
    for i, plane in enumerate(space.planes):
        estimates += _unbalance(
            best,
            names.unbalance.start + 2 * i,
            amount=space.amounts[i],
            phase=space.phases[i],
            expected=expected.get(plane),
        )
    return tuple(estimates)


def estimate_nuisances(best: Solution, problem: ExtendedProblem) -> tuple[Estimate, ...]:
    """Return what the nameplate cannot know exactly, as deviations from it."""
    names = problem.parameters
    sought = (names.base.sought, names.base.unbalance)
    skipped = {i for part in sought for i in range(part.start, part.stop)}
    own = [q for effect in names.effects for q in effect.parameters]
    pulls = nuisance_pulls(best, names)
    sizes = np.append(np.ones(names.own.start), [q.size for q in own])
    units = [*(_unit(name) for name in names.names[: names.own.start]), *(q.unit for q in own)]
    return tuple(
        Estimate(
            name=name,
            value=float(best.p[i] * sizes[i]),
            sigma=float(best.sigma[i] * sizes[i]),
            unit=units[i],
            nameplate=own[i - names.own.start].at_zero if i >= names.own.start else 0.0,
            pull=pulls.get(name, math.nan),
        )
        for i, name in enumerate(names.names)
        if i not in skipped
    )


def _unit(nuisance: str) -> str:
    """Return the unit of a nuisance; "hub disk" and "hum 50 Hz 1 re" begin with what they are. Others are ratios."""
    return _UNITS.get(nuisance.split()[0], "")


def _amount_alone(best: Solution, i: int, amount: Unknown) -> Estimate:
    """Return the amount of the one unbalance, whose phase amplitudes do not tell."""
    value, sigma = abs(float(best.p[i])), float(best.sigma[i])
    determined = sigma < UNCERTAINTY.determined * value
    return Estimate(
        name=amount.name,
        value=value,
        sigma=sigma if determined else math.inf,
        unit=amount.unit,
        nameplate=amount.nameplate,
        determined=determined,
    )


def _unbalance(
    best: Solution, i: int, *, amount: Unknown, phase: str, expected: Unbalance | None
) -> tuple[Estimate, Estimate]:
    """Return amount and phase of the plane whose re stands at `i`, with sigmas from the 2x2 covariance of both."""
    u = complex(best.p[i], best.p[i + 1])
    covariance = best.covariance[i : i + 2, i : i + 2]
    along = np.array([u.real, u.imag]) / abs(u)
    radial = math.sqrt(along @ covariance @ along)
    tangential = math.sqrt(max(np.trace(covariance) - radial**2, 0.0))
    determined = bool(max(radial, tangential) < UNCERTAINTY.determined * abs(u))
    return (
        Estimate(
            name=amount.name,
            value=abs(u),
            sigma=radial if determined else math.inf,
            unit=amount.unit,
            nameplate=amount.nameplate,
            determined=determined,
        ),
        Estimate(
            name=phase,
            value=float(np.angle(u)),
            sigma=tangential / abs(u) if determined else math.inf,
            unit="rad",
            nameplate=expected.angle if expected else math.nan,
            determined=determined,
        ),
    )
