"""A force over speed, as the measurement has it at a place and no law supposes it.

The rotor is taken as fitted with the law. What the vectors of one recording are off by is a force besides that of the
law, on the rotor without it; it is found by least squares, as straight lines between knots of speed. Source: the
equivalent loads of Markert, Platz, Seidler, Int. J. Rotating Machinery 7 (2001) 311.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import Candidate
from rotorrig.identify.discovery.force_search import fitted_laws
from rotorrig.identify.discovery.settings import DISCOVERY
from rotorrig.identify.discovery.shaft_forces import ShaftForces, is_first_order
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.sims.effects import LAWS, FoundForce


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceOverSpeed:
    """Phasors of what turns with the shaft and what turns against it, 0-peak, N; of moments N m."""

    omega: NDArray[np.float64]  # (knot,) rad/s
    force: NDArray[np.complex128]  # (knot, 2)
    sigma: NDArray[np.float64]  # (knot, 2) of re or im; of the noise, the rotor taken as fitted
    law: NDArray[np.complex128]  # (knot, 2) what the law says
    motion: NDArray[np.complex128]  # (knot, 2) m, of the place
    recording: int  # whose vectors they are of


def reconstruct_force(problem: ExtendedProblem, found: Candidate) -> ForceOverSpeed:
    """Return that of a force, the last effect of `found`; `problem` is that without it."""
    effect, p = found.effect, found.polished.p
    assert isinstance(effect, FoundForce)
    names, last = found.problem.parameters, len(found.problem.effects) - 1
    theta, shared = names.of_effect(p, last), p[: names.theta[-1].start]
    shaft = ShaftForces(problem, shared, np.array([effect.place(theta)]), moved=(found.problem, p))
    number = max(range(len(problem.recordings)), key=lambda i: len(problem.recordings[i].rows))
    omega = problem.recordings[number].response.omega[problem.recordings[number].rows]
    knots = _knots(omega)
    hats = _hats(omega, knots)
    weights = [
        np.vstack([hats, np.zeros_like(hats[:1])]) if i == number else np.zeros((len(r.rows) + 1, len(knots)))
        for i, r in enumerate(problem.recordings)
    ]
    tilts = all(LAWS[name].tilts for name in effect.laws)
    columns = shaft.turning(weights, tilts=tilts)
    flat = columns.reshape(len(columns), -1)
    residual = found.problem.residual(p)[is_first_order(found.problem)]
    amounts, covariance = _least_squares(flat, residual)
    parts = amounts.reshape(len(knots), 2, 2)
    sigma = np.sqrt(np.diag(covariance)).reshape(len(knots), 2, 2).mean(axis=2)
    laws = [
        shaft.forces(law, np.array([theta[name] for name in law.unknowns]))[number][:-1]
        for law in fitted_laws(effect, found)
        if law.tilts == tilts
    ]
    mean = hats / hats.sum(axis=0)
    of_law = mean.T @ np.sum(laws, axis=0)
    return ForceOverSpeed(
        omega=knots,
        force=of_law + parts[..., 0] + 1j * parts[..., 1],
        sigma=sigma,
        law=of_law,
        motion=mean.T @ shaft.motions[number][:-1],
        recording=number,
    )


def _knots(omega: Reals) -> Reals:
    """Return speeds between which there are about equally many rows."""
    count = int(np.clip(len(omega) // DISCOVERY.rows_per_knot, 2, DISCOVERY.knots))
    return np.unique(np.quantile(omega, np.linspace(0.0, 1.0, count)))


def _hats(omega: Reals, knots: Reals) -> Reals:
    """Return the functions (row, knot) that are 1 at one knot and fall to 0 at its neighbours."""
    return np.stack([np.interp(omega, knots, one) for one in np.eye(len(knots))], axis=-1)


def _least_squares(columns: Reals, residual: Reals) -> tuple[Reals, Reals]:
    """Return the amounts of columns that leave least of a residual, and their covariance."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0] = 1.0
    inverse = np.linalg.pinv(columns / size, rcond=DISCOVERY.determined)
    amounts = -(inverse @ residual) / size
    return amounts, (inverse @ inverse.T) / np.outer(size, size)
