"""Swept response with forces that depend on the motion nonlinearly: a stop, a rub, dry friction, a cubic spring.

The passed modes are stepped with the first harmonic of the force and its mean, solved for at every turn, so the branch
taken through a fold, up or down, is that of the time before. Its overtones have their linear response; what the second
and third do to the motion at the place acts back on it, as in steady motion.

Jeffcott's rotor through its resonance, against integration in time: a cubic spring of a tenth of the rotor's stiffness
is within 0.01 % of the peak; dry friction 0.1 %; a stop of half the rotor's stiffness, jump included, 4 %. A hard stop
(six times) is within 1 % in contact, but may enter it at another turn.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig import DataError
from rotorrig.sims.rotor.model import Load, RotorModel, matrices
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import overtones
from rotorrig.sims.rotor.nonlinear.swept_motion import LawSweep, place_rows, quasistatic_average
from rotorrig.sims.rotor.swept import (
    TrackedRows,
    fit_passed_modes,
    polynomial,
    project_to_probes,
    solve_sweep,
    swept_columns,
)

Complex = NDArray[np.complex128]


def swept_with_law(
    model: RotorModel,
    rows: TrackedRows,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    orders: Sequence[int] = (1,),
) -> Complex:
    """Return the response of the rows to the loads times their amounts (load,) and the laws, (row, probe, order) m.

    `orders` are 0 and above: of order 0 it is the shift of the mean by the mean force, real. Loads of other orders than
    1 have their linear response. Raises as swept_response, DataError if the force does not converge at too many turns
    or is beyond bounds at an order.
    """
    amounts = np.asarray(amounts, dtype=complex)
    first = [i for i, load in enumerate(loads) if load.order == 1]
    sweep = LawSweep(model, rows, [loads[i] for i in first], amounts[first], laws)
    motion = sweep.solve()
    by_order = []
    for order in orders:
        if order == 1:
            by_order.append(sweep.at_probes(motion))
            continue
        same = [i for i, load in enumerate(loads) if load.order == order]
        linear = swept_columns(model, rows, loads=[loads[i] for i in same], order=order) @ amounts[same] if same else 0
        F = overtones(laws, rows.turns.omega, motion.u, motion.F, order)
        if not np.isfinite(F).all():
            raise DataError(f"law: its force at {order}X is beyond bounds, want a bounded motion")
        by_order.append(linear + _overtone_response(model, rows, laws, F, order))
    return np.stack(by_order, axis=-1)


def _overtone_response(
    model: RotorModel, rows: TrackedRows, laws: Sequence[ForceLaw], F: Complex, order: int
) -> Complex:
    """Return the response to known forces at the laws' places, F (turn, place) of that order, (row, probe)."""
    at = place_rows(laws)
    if order == 0:
        flexibility = model.probes @ np.linalg.solve(matrices(model).K, at.T)
        return quasistatic_average(rows, flexibility[None].astype(complex), F[..., None])[..., 0]
    over_time, rows = CubicSpline(rows.turns.t, F), rows.of_order(order)
    passed = solve_sweep(model, rows)
    modes = fit_passed_modes(passed.spectra, at.T.astype(complex))
    t = rows.turns.t
    there, halfway = over_time(t), over_time((t[1:] + t[:-1]) / 2)
    force = polynomial(rows.power, modes.g) @ there[..., None]
    force_mid = polynomial(rows.power_mid, modes.g) @ halfway[..., None]
    motion = passed.envelope.step(force, force_mid)
    return (project_to_probes(modes.shape, motion.average) + quasistatic_average(rows, modes.others, there[..., None]))[
        ..., 0
    ]
