"""1X while the speed moves, as a tracking filter sees it: the lag of a sweep and the smear of the window.

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
from rotorrig.sims.rotor.swept.forcing import Drive, drive
from rotorrig.sims.rotor.swept.passed_modes import Passage, passage
from rotorrig.sims.rotor.swept.passed_modes_derivatives import passage_derivatives
from rotorrig.sims.rotor.swept.rotating_stiffness import Mirror, driven_with_mirror, mirror, mirror_derivatives
from rotorrig.sims.rotor.swept.swept_modes import passing
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
    pattern, passed = patterns(model, every, order=order), passing(model, rows)
    modes, driven = passage(passed.spectra, pattern), drive(every, rows)
    T = model.added.T
    if T is None or order != 1:
        return _at_probes(modes, driven, passed.envelope.response(modes.g, driven).average)
    mirrored = mirror(passed.spectra, modes, pattern, T)
    return _seen_in(mirrored, driven, _under_mirror(passed.envelope, rows, mirrored, driven))


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

    A direction is what a unit of a parameter adds to the model's matrices: derivatives.py. The loads stay as they are:
    where a parameter changes one, add the response to its derivative. The derivatives of the modes are exact; those of
    their motion take the force that a changed mode exerts as quadratic in time over a turn. Against central differences
    on configs/rk4.toml: 4e-6 of the derivative's peak at a damping ratio of 0.02, 2e-5 at 0.0014;
    along a stiffness that turns, 7e-4 where it shifts the peak by a fifth. Raises likewise.
    """
    every = (*unbalance_loads(model, unbalance, order=order), *loads)
    rows = rows.of_order(order)
    pattern, passed = patterns(model, every, order=order), passing(model, rows)
    modes, driven = passage(passed.spectra, pattern), drive(every, rows)
    change = passage_derivatives(passed.spectra, pattern, directions)
    if order == 1 and (model.added.T is not None or any(np.ndim(d.T) for d in directions)):
        T = np.zeros_like(model.shaft.K, dtype=complex) if model.added.T is None else model.added.T
        mirrored = mirror(passed.spectra, modes, pattern, T)
        changed = mirror_derivatives(passed.spectra, change, pattern, T, directions)
        return _mirrored_derivatives(passed.envelope, rows, mirrored, changed, driven)
    motion = passed.envelope.response(modes.g, driven)
    moved = passed.envelope.derivatives(change, motion, driven)
    return Derivatives(_at_probes(modes, driven, motion.average), _moved(modes, change, driven, motion, moved))


def _mirrored_derivatives(
    envelope: Envelope, rows: TrackedRows, mirrored: Mirror, changed: Mirror, driven: Drive
) -> Derivatives:
    """Return the response and its derivatives where a stiffness turns, or would along a direction."""
    motion = _under_mirror(envelope, rows, mirrored, driven)
    back, echoed = motion.conjugate(), driven.conjugate()
    pushes = zip(
        envelope.pushed(changed.direct, motion, driven), envelope.pushed(changed.echo, back, echoed), strict=True
    )
    moved = driven_with_mirror(envelope, mirrored, rows, *(a + b for a, b in pushes))
    by = _moved(mirrored.direct, changed.direct, driven, motion, moved)
    by += _moved(mirrored.echo, changed.echo, echoed, back, moved.conjugate())
    return Derivatives(_seen_in(mirrored, driven, motion), by)


def _under_mirror(envelope: Envelope, rows: TrackedRows, mirrored: Mirror, driven: Drive) -> Motion:
    """Return the motion under the loads, directly and through the others' conjugate, and under its own conjugate."""
    forces = zip(
        envelope.forces(mirrored.direct.g, driven), envelope.forces(mirrored.echo.g, driven.conjugate()), strict=True
    )
    return driven_with_mirror(envelope, mirrored, rows, *(a + b for a, b in forces))


def _seen_in(mirrored: Mirror, driven: Drive, motion: Motion) -> Complex:
    """Return what the probes see of that, (row, probe, load)."""
    direct = _at_probes(mirrored.direct, driven, motion.average)
    return direct + _at_probes(mirrored.echo, driven.conjugate(), motion.average.conj())


def _moved(modes: Passage, change: Passage, driven: Drive, motion: Motion, moved: Motion) -> Complex:
    """Return what the probes see of a change: of the motion, of the modes and of the others, (.., row, probe, load)."""
    by_others = driven.averaged(change.others)  # (direction, row, probe, load)
    directions, rows, probes, loads = by_others.shape
    by_motion = projected(modes.shape, moved.average).reshape(rows, probes, directions, loads)
    by_shape = np.einsum("rqml,qdmp->drpl", motion.average, change.shape, optimize=True)
    return np.moveaxis(by_motion, 2, 0) + by_shape + by_others


def _at_probes(modes: Passage, driven: Drive, average: Complex) -> Complex:
    """Return what the probes see of the passed modes and of the others, (row, probe, load)."""
    return projected(modes.shape, average) + driven.averaged(modes.others)


def projected(shape: Complex, average: Complex) -> Complex:
    """Return the sum over powers and modes of `shape` (power, mode, probe) and averages: (row, probe, column)."""
    powers, modes, probes = shape.shape
    return shape.reshape(-1, probes).T @ average.reshape(len(average), powers * modes, -1)
