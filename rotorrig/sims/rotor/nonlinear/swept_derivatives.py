"""The derivatives of a swept response under force laws, by whatever changes the rotor, its loads or the laws.

At 1X they are those of the march itself, the force being found anew under every change. Above, the change of the
force's harmonic is taken to act as in steady motion at the speed in the middle of a row.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model import Load, RotorModel
from rotorrig.sims.rotor.nonlinear.changes import LawChange, LawDerivatives, overtone_derivatives, settled
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import slopes
from rotorrig.sims.rotor.nonlinear.march_tangent import tangent
from rotorrig.sims.rotor.nonlinear.swept_forcing import Forcing, forcing
from rotorrig.sims.rotor.nonlinear.swept_motion import LawPassage, Marched, at_once
from rotorrig.sims.rotor.swept import TrackedRows, projected

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


def swept_law_derivatives(
    model: RotorModel,
    rows: TrackedRows,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    changes: Sequence[LawChange],
    orders: Sequence[int] = (1,),
) -> LawDerivatives:
    """Return the response of 1X under loads of order 1 and the laws, and its derivatives by `changes`.

    Those at orders 2 and 3 are of the laws' forces alone. Arguments and errors as those of swept_with_law.
    """
    places = LawPassage(model, rows, loads, np.asarray(amounts, dtype=complex), laws)
    found = places.marched()
    driving = forcing(places, found, changes)
    slope = slopes(laws, rows.turns.omega, found.u)
    a, rate, dF, compliance = tangent(
        places.envelope.operator,
        places.envelope.steps,
        places.envelope.turned,
        places.push,
        places.seen,
        places.flexibility,
        places.mean,
        found.above,
        found.u,
        found.F,
        slope,
        driving.force,
        driving.force_mid,
        driving.motion,
        driving.reaction,
        driving.lawful,
    )
    others = places.modes.others[:, : places.probes]
    by = projected(places.modes.shape[..., : places.probes], rows.averages(a, rate, powers=len(others)))
    by = by + at_once(rows, others[..., places.loads :], dF) + driving.at_rows
    higher = [order for order in orders if order > 1]
    above = _above(places, found, driving, slope, compliance, changes, higher) if higher else {}
    return LawDerivatives(places.seen_by_rows(found), {1: by} | above)


def _above(
    places: LawPassage,
    found: Marched,
    driving: Forcing,
    slope: Reals,
    compliance: Complex,
    changes: Sequence[LawChange],
    orders: Sequence[int],
) -> dict[int, Complex]:
    """Return the derivatives of the response at orders above 1, (row, probe, change) each."""
    rows = places.rows
    middle = rows.seen[:, rows.seen.shape[1] // 2]
    omega, u = rows.turns.omega[middle], found.u[middle]
    known, reaction = np.zeros((2, *u.shape, len(changes)))
    known[:, : driving.motion.shape[1]] = driving.motion[middle]
    reaction[..., driving.lawful] = driving.reaction[middle]
    A = np.concatenate([compliance[middle, None], found.above[middle]], axis=1)
    du, dF = settled(A, places.mean, slope[middle], known, reaction)
    return {n: overtone_derivatives(places.model, places.laws, changes, omega, u, du, dF, order=n) for n in orders}
