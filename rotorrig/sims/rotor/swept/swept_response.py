"""Swept response at the probes: 1X while the speed changes, with the lag of the sweep and the smear of the window.

`swept_response` needs no parameter of its own: the keyphasor tells the speed at every instant. Against integration in
time of configs/rk4.toml through its resonance the error is 2e-6 of the peak (30 rpm/s up, 60 rpm/s down, damping ratio
0.02); the steady response would be wrong by 0.13 and 0.24. With a damping ratio of 0.001 it is up to 1e-3: the beat
behind the resonance then lasts until it is too fast to be followed from turn to turn.

Where one recording is asked about many models, `tracked_rows` lays it out once for `swept_columns` and
`swept_derivatives`.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rotorrig.sims.rotor.model import Direction, Load, RotorModel, patterns, unbalance_loads, unbalance_pattern
from rotorrig.sims.rotor.steady import Derivatives
from rotorrig.sims.rotor.swept.envelope import Envelope, Motion
from rotorrig.sims.rotor.swept.excitation import Excitation, sample_excitation
from rotorrig.sims.rotor.swept.passed_modes import PassedModes, fit_passed_modes
from rotorrig.sims.rotor.swept.passed_modes_derivatives import differentiate_passed_modes
from rotorrig.sims.rotor.swept.rotating_stiffness import (
    CoupledModes,
    couple_modes,
    differentiate_coupled_modes,
    step_coupled_modes,
)
from rotorrig.sims.rotor.swept.swept_solution import solve_sweep
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows, Window, tracked_rows

Complex = NDArray[np.complex128]


def swept_response(
    model: RotorModel,
    timeline: Timeline,
    *,
    t: ArrayLike,
    revolutions: ArrayLike,
    window: Window,
    unbalance: Mapping[str, complex],
) -> Complex:
    """Return the 1X amplitudes z [m, 0-peak] at the probes as tracked in rows around the times `t` [s], (row, probe).

    A row averages the amplitude A(t) of Re(A e^{j theta}) over a window of turns: see tracked_rows. The rotor starts
    in the steady state of the first pulse. Give a reduced model: eigenvalues cost dof^3. `unbalance` as in
    steady_response. Raises DataError on a row that is not within the pulses, ValueError on an unknown window.
    """
    rows = tracked_rows(timeline, t=t, revolutions=revolutions, window=window)
    return swept_columns(model, rows, loads=[Load(unbalance_pattern(model, unbalance), "unbalance")])[..., 0]


def swept_columns(
    model: RotorModel,
    rows: TrackedRows,
    *,
    unbalance: Sequence[str] = (),
    loads: Sequence[Load] = (),
    order: float = 1.0,
) -> Complex:
    """Return the response at `order` to 1 kg m at each place of `unbalance`, then to each load, (row, probe, column).

    In m per kg m, and m. At order n the windows are those of the same rows, and z that of x = Re(z e^{j n theta}).
    Where a stiffness turns with the shaft, each is the response to a real amount alone: a load times j is another.
    Raises as swept_response, ValueError on a load of another order.
    """
    every = (*unbalance_loads(model, unbalance, order=order), *loads)
    rows = rows.of_order(order)
    pattern, solution = patterns(model, every, order=order), solve_sweep(model, rows)
    modes, excitation = fit_passed_modes(solution.spectra, pattern), sample_excitation(every, rows)
    T = model.added.T
    if T is None or order != 1:
        return _at_probes(modes, excitation, solution.envelope.response(modes.g, excitation).average)
    coupled = couple_modes(solution.spectra, modes, pattern, T)
    return _coupled_at_probes(coupled, excitation, _step_under_loads(solution.envelope, rows, coupled, excitation))


def swept_derivatives(
    model: RotorModel,
    rows: TrackedRows,
    *,
    unbalance: Sequence[str] = (),
    loads: Sequence[Load] = (),
    directions: Sequence[Direction],
    order: float = 1.0,
) -> Derivatives:
    """Return the response as swept_columns does, and its derivative along each of the directions.

    A direction is the derivative of the model's matrices by a parameter: derivatives.py. The loads stay as they are:
    where a parameter changes one, add the response to its derivative. The derivatives of the modes are exact; those of
    their motion take the force that a changed mode exerts as quadratic in time over a turn. Against central differences
    on configs/rk4.toml: 4e-6 of the derivative's peak at a damping ratio of 0.02, 2e-5 at 0.0014;
    along a stiffness that turns, 7e-4 where it shifts the peak by a fifth. Raises likewise.
    """
    every = (*unbalance_loads(model, unbalance, order=order), *loads)
    rows = rows.of_order(order)
    pattern, solution = patterns(model, every, order=order), solve_sweep(model, rows)
    modes, excitation = fit_passed_modes(solution.spectra, pattern), sample_excitation(every, rows)
    change = differentiate_passed_modes(solution.spectra, pattern, directions)
    if order == 1 and (model.added.T is not None or any(np.ndim(d.T) for d in directions)):
        T = np.zeros_like(model.shaft.K, dtype=complex) if model.added.T is None else model.added.T
        coupled = couple_modes(solution.spectra, modes, pattern, T)
        change_coupled = differentiate_coupled_modes(solution.spectra, change, pattern, T, directions)
        return _coupled_derivatives(solution.envelope, rows, coupled, change_coupled, excitation)
    motion = solution.envelope.response(modes.g, excitation)
    d_motion = solution.envelope.derivatives(change, motion, excitation)
    return Derivatives(
        _at_probes(modes, excitation, motion.average),
        _derivatives_at_probes(modes, change, excitation, motion, d_motion),
    )


def _coupled_derivatives(
    envelope: Envelope, rows: TrackedRows, coupled: CoupledModes, change_coupled: CoupledModes, excitation: Excitation
) -> Derivatives:
    """Return the response and its derivatives with a rotating stiffness in the model, or along a direction."""
    motion = _step_under_loads(envelope, rows, coupled, excitation)
    back, conjugate_excitation = motion.conjugate(), excitation.conjugate()
    pushes = zip(
        envelope.forces_of_change(change_coupled.direct, motion, excitation),
        envelope.forces_of_change(change_coupled.conjugate, back, conjugate_excitation),
        strict=True,
    )
    d_motion = step_coupled_modes(envelope, coupled, rows, *(a + b for a, b in pushes))
    by = _derivatives_at_probes(coupled.direct, change_coupled.direct, excitation, motion, d_motion)
    by += _derivatives_at_probes(
        coupled.conjugate, change_coupled.conjugate, conjugate_excitation, back, d_motion.conjugate()
    )
    return Derivatives(_coupled_at_probes(coupled, excitation, motion), by)


def _step_under_loads(envelope: Envelope, rows: TrackedRows, coupled: CoupledModes, excitation: Excitation) -> Motion:
    """Return the motion under the loads, coupled with its own conjugate; the others' part acts through theirs."""
    forces = zip(
        envelope.forces(coupled.direct.g, excitation),
        envelope.forces(coupled.conjugate.g, excitation.conjugate()),
        strict=True,
    )
    return step_coupled_modes(envelope, coupled, rows, *(a + b for a, b in forces))


def _coupled_at_probes(coupled: CoupledModes, excitation: Excitation, motion: Motion) -> Complex:
    """Return that motion at the probes, (row, probe, load)."""
    direct = _at_probes(coupled.direct, excitation, motion.average)
    return direct + _at_probes(coupled.conjugate, excitation.conjugate(), motion.average.conj())


def _derivatives_at_probes(
    modes: PassedModes, change: PassedModes, excitation: Excitation, motion: Motion, d_motion: Motion
) -> Complex:
    """Return the derivatives at the probes by motion, mode shapes and the others' response, (.., row, probe, load)."""
    by_others = excitation.average(change.others)  # (direction, row, probe, load)
    directions, rows, probes, loads = by_others.shape
    by_motion = project_to_probes(modes.shape, d_motion.average).reshape(rows, probes, directions, loads)
    by_shape = np.einsum("rqml,qdmp->drpl", motion.average, change.shape, optimize=True)
    return np.moveaxis(by_motion, 2, 0) + by_shape + by_others


def _at_probes(modes: PassedModes, excitation: Excitation, average: Complex) -> Complex:
    """Return the response at the probes of the passed modes and of the others, (row, probe, load)."""
    return project_to_probes(modes.shape, average) + excitation.average(modes.others)


def project_to_probes(shape: Complex, average: Complex) -> Complex:
    """Return mode shapes (power, mode, probe) times averages, summed over powers and modes, (row, probe, column)."""
    powers, modes, probes = shape.shape
    return shape.reshape(-1, probes).T @ average.reshape(len(average), powers * modes, -1)
