"""From a refined parameter vector to values with uncertainties, as people ask for them."""

import math

import numpy as np

from rotorrig.identify.base_model import Problem, Unknown
from rotorrig.identify.identification import Estimate
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.settings import UNCERTAINTY
from rotorrig.rig.config import RigConfig

_NUISANCE_UNITS = {"angle": "rad", "runout": "m"}  # the others are ratios


def estimate_unknowns(best: Solution, problem: Problem, rig: RigConfig, *, unseen: str) -> tuple[Estimate, ...]:
    """Return the unknowns of the [identify] table, then amount and phase of the unbalance plane by plane.

    `unseen` names the axes no probe looks along: coefficients of these are not determined.
    """
    space = problem.parameters.space
    values = problem.parameters.values(best.p)
    sigma = best.sigma[problem.parameters.sought] * space.slopes(values)
    estimates = []
    for i, unknown in enumerate(space.unknowns):
        hidden = any(axis in unseen for axis in unknown.axes)
        certain = sigma[i] < UNCERTAINTY.determined * space.references(values)[i]
        determined = bool(certain and not hidden and not problem.at_bound(best.p, i))
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
    for i, plane in enumerate(space.planes):
        estimates += _unbalance(
            best, problem, rig, plane=plane, amount=space.amounts[i], phase=space.phases[i], first=2 * i
        )
    return tuple(estimates)


def estimate_nuisances(best: Solution, problem: Problem) -> tuple[Estimate, ...]:
    """Return what the nameplate cannot know exactly, as deviations from it."""
    names = problem.parameters
    skipped = {*range(*names.sought.indices(len(names))), *range(*names.unbalance.indices(len(names)))}
    return tuple(
        Estimate(
            name=name,
            value=float(best.p[i]),
            sigma=float(best.sigma[i]),
            unit=_NUISANCE_UNITS.get(name.split()[0], ""),
            nameplate=0.0,
        )
        for i, name in enumerate(names.names)
        if i not in skipped
    )


def _unbalance(
    best: Solution, problem: Problem, rig: RigConfig, *, plane: str, amount: Unknown, phase: str, first: int
) -> tuple[Estimate, Estimate]:
    """Return amount and phase of one plane, with sigmas from the 2x2 covariance of its re and im."""
    i = problem.parameters.unbalance.start + first
    u = complex(best.p[i], best.p[i + 1])
    covariance = best.covariance[i : i + 2, i : i + 2]
    along = np.array([u.real, u.imag]) / abs(u)
    radial = math.sqrt(along @ covariance @ along)
    tangential = math.sqrt(max(np.trace(covariance) - radial**2, 0.0))
    determined = bool(max(radial, tangential) < UNCERTAINTY.determined * abs(u))
    expected = {disk.name: disk.unbalance for disk in rig.disks}.get(plane)
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
