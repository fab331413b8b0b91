"""The swept response with forces that depend on the motion nonlinearly: a stop, a rub, dry friction, a cubic spring.

The passed modes are marched with the first harmonic of the force and its mean, found anew at every turn, so the branch
taken through a fold, up or down, is that of the time before. Higher harmonics of the force have their linear response,
which does not act back on it.

Jeffcott's rotor through its resonance, against integration in time: a cubic spring of a tenth of the rotor's stiffness
is within 0.6 % of the peak, of which the march itself has 0.013 %; dry friction 0.2 %; a stop of half the rotor's
stiffness, jump included, 4 %. A hard stop (six times) is within 1 % in contact, but may enter it at another turn.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.assembly import RotorModel, matrices
from rotorrig.sims.rotor.describing import OVERTONE, called, overtone, pointers
from rotorrig.sims.rotor.drive import drive
from rotorrig.sims.rotor.envelope import polynomial
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.law_march import MARCH, march
from rotorrig.sims.rotor.loads import Load, patterns
from rotorrig.sims.rotor.passage import passage
from rotorrig.sims.rotor.passing import passing
from rotorrig.sims.rotor.sweep import projected, swept_columns
from rotorrig.sims.rotor.tracking import TrackedRows

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

MOST_UNSOLVED = 0.01  # of the turns


def swept_with_law(
    model: RotorModel,
    rows: TrackedRows,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    orders: Sequence[int] = (1,),
) -> Complex:
    """Return what the rows show under the loads times their amounts (load,) and the laws, (row, probe, order) m.

    `orders` are 0 and above: of order 0 it is the shift of the mean by the mean force, real. Loads of other orders than
    1 have their linear response. Raises as swept_response, DataError if the force is not found at too many turns.
    """
    amounts = np.asarray(amounts, dtype=complex)
    first = [i for i, load in enumerate(loads) if load.order == 1]
    place = _Places(model, rows, [loads[i] for i in first], amounts[first], laws)
    u, z = place.marched()
    found = []
    for order in orders:
        if order == 1:
            found.append(z)
            continue
        same = [i for i, load in enumerate(loads) if load.order == order]
        linear = swept_columns(model, rows, loads=[loads[i] for i in same], order=order) @ amounts[same] if same else 0
        found.append(linear + _forced(model, rows, laws, place.force(u, order), order).sum(axis=-1))
    return np.stack(found, axis=-1)


def law_columns(
    model: RotorModel,
    rows: TrackedRows,
    loads: Sequence[Load],
    amounts: ArrayLike,
    laws: Sequence[ForceLaw],
    *,
    order: int = 1,
) -> Complex:
    """Return what the force of each law on the motion without it adds to the response, (row, probe, law) m.

    That is the response to a unit of a small law: the column of a score test. `loads` as in swept_with_law. Raises as
    swept_response.
    """
    first = [i for i, load in enumerate(loads) if load.order == 1]
    place = _Places(model, rows, [loads[i] for i in first], np.asarray(amounts, dtype=complex)[first], laws)
    return _forced(model, rows, laws, place.force(place.linear(), order), order)


class _Places:
    """The places of the laws in a sweep under loads of order 1: what moves them."""

    def __init__(
        self, model: RotorModel, rows: TrackedRows, loads: Sequence[Load], amounts: Complex, laws: Sequence[ForceLaw]
    ) -> None:
        at = _rows(laws)
        passed = passing(model, rows)
        whole = replace(passed.spectra, probes=np.concatenate([model.probes, at]))
        pattern = np.concatenate([patterns(model, loads, order=1), at.T], axis=1)
        self._rows, self._amounts, self._probes, self._loads = rows, amounts, len(model.probes), len(loads)
        self._modes = passage(whole, pattern)
        self._drive = drive(loads, rows)
        self._envelope = passed.envelope
        self._functions, self._constants = pointers(laws)
        self._static = np.concatenate([law.static for law in laws]).astype(float)
        self._mean = at @ np.linalg.solve(matrices(model).K, at.T)

    def marched(self) -> tuple[Reals, Complex]:
        """Return the places' motion, (turn, 3 place), and what the rows show of order 1, (row, probe)."""
        rows, others, loads = self._rows, self._modes.others, self._loads
        a, rate, u, F, failed = called(
            march,
            MARCH,
            self._functions,
            self._constants,
            self._static,
            rows.turns.omega,
            self._envelope.operator,
            self._envelope.steps,
            self._envelope.turned,
            *self._forces(),
            polynomial(rows.power, self._modes.g[..., loads:]),
            self._seen,
            self._base,
            polynomial(rows.power, others[:, self._probes :, loads:]),
            self._mean,
        )
        if failed > MOST_UNSOLVED * len(a):
            raise DataError(f"law: its force is not found at {failed} of {len(a)} turns, want a smoother or weaker one")
        average = rows.averages(a[..., None], rate[..., None], powers=len(others))
        z = projected(self._modes.shape[..., : self._probes], average)[..., 0]
        z += self._drive.averaged(others[:, : self._probes, :loads]) @ self._amounts
        z += _at_once(rows, others[:, : self._probes, loads:], _phasor(F)).sum(axis=-1)
        return u, z

    def linear(self) -> Reals:
        """Return the motion without the laws, (turn, 3 place)."""
        motion = self._envelope.driven(*(f[..., None] for f in self._forces()))
        Q = (self._seen @ motion.a)[..., 0] + self._base
        return np.concatenate([np.broadcast_to(self._static, Q.shape), Q.real, Q.imag], axis=1)

    def force(self, u: Reals, order: int) -> Complex:
        """Return the harmonic of the force on that motion, (turn, place) N."""
        omega = self._rows.turns.omega
        return called(overtone, OVERTONE, self._functions, self._constants, omega, u, order)

    def _forces(self) -> list[Complex]:
        """Return what the loads do to the modes at the turns and halfway, (turn, mode) and (turn - 1, mode)."""
        return [f @ self._amounts for f in self._envelope.forces(self._modes.g[..., : self._loads], self._drive)]

    @property
    def _seen(self) -> Complex:
        """What the places see of the modes, (turn, place, mode)."""
        shape = self._modes.shape[..., self._probes :]
        return polynomial(self._rows.power, shape.swapaxes(1, 2))

    @property
    def _base(self) -> Complex:
        """What they see of the others under the loads, (turn, place)."""
        others = polynomial(self._rows.power, self._modes.others[:, self._probes :, : self._loads])
        return (others * self._drive.at[:, None, self._drive.which]) @ self._amounts


def _forced(model: RotorModel, rows: TrackedRows, laws: Sequence[ForceLaw], F: Complex, order: int) -> Complex:
    """Return the response to known forces at the laws' places, F (turn, place) of that order, (row, probe, law)."""
    at = _rows(laws)
    if order == 0:
        flexibility = model.probes @ np.linalg.solve(matrices(model).K, at.T)
        return _of_laws(_at_once(rows, flexibility[None].astype(complex), F))
    over_time, rows = CubicSpline(rows.turns.t, F), rows.of_order(order)
    passed = passing(model, rows)
    modes = passage(passed.spectra, at.T.astype(complex))
    t = rows.turns.t
    there, halfway = over_time(t), over_time((t[1:] + t[:-1]) / 2)
    force = polynomial(rows.power, modes.g) * there[:, None]
    force_mid = polynomial(rows.power_mid, modes.g) * halfway[:, None]
    motion = passed.envelope.driven(_of_laws(force), _of_laws(force_mid))
    return projected(modes.shape, motion.average) + _of_laws(_at_once(rows, modes.others, there))


def _at_once(rows: TrackedRows, others: Complex, F: Complex) -> Complex:
    """Return the averages of polynomials (power, probe, place) times F (turn, place), (row, probe, place)."""
    slope = np.gradient(F, rows.turns.t, axis=0)
    average = rows.averages(F[:, None], slope[:, None], powers=len(others))[:, :, 0]  # (row, power, place)
    return np.einsum("qpi,rqi->rpi", others, average)


def _rows(laws: Sequence[ForceLaw]) -> Reals:
    return np.concatenate([law.rows for law in laws])


def _of_laws(places: Complex) -> Complex:
    """Add x and y of every law, the last axis."""
    return places[..., 0::2] + places[..., 1::2]


def _phasor(u: Reals) -> Complex:
    """Return the first harmonic, (turn, place), of a motion or force (turn, 3 place)."""
    _, re, im = np.split(u, 3, axis=-1)
    return re + 1j * im
