"""A rotor with force laws on its way through the speeds of some rows: what moves the places of the laws, and how far.

The passed modes are marched with the first harmonic of the force and its mean, found anew at every turn, so the branch
taken through a fold, up or down, is that of the time before. The overtones of the force move its place as in steady
motion, and that is part of the motion it is found on.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig import DataError
from rotorrig.sims.rotor.model import Load, RotorModel, matrices, patterns
from rotorrig.sims.rotor.nonlinear.force_harmonics import OVERTONES
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from rotorrig.sims.rotor.nonlinear.harmonic_balance import called, phasor, pointers
from rotorrig.sims.rotor.nonlinear.march import MARCH, march
from rotorrig.sims.rotor.steady import load_columns
from rotorrig.sims.rotor.swept import Spectra, TrackedRows, drive, passage, passing, polynomial, projected

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

MOST_UNSOLVED = 0.01  # of the turns
SPEEDS = 128  # a sweep is divided into for the overtones: 25 rpm each on an RK4, half the width of its resonance


@dataclass(frozen=True, slots=True, kw_only=True)
class Marched:
    """The motion found."""

    a: Complex  # (turn, mode) of the passed modes
    rate: Complex  # (turn, mode) 1/s
    u: Reals  # (turn, part) of the laws' places, as in harmonic_balance.py
    F: Reals  # (turn, part) N, the force on them
    above: Complex  # (turn, overtone, place, place) m/N, how far a unit of the force's overtones moves them


class LawPassage:
    """What moves the places of the laws, x and y of each, under loads of order 1 times their amounts (load,)."""

    def __init__(
        self, model: RotorModel, rows: TrackedRows, loads: Sequence[Load], amounts: Complex, laws: Sequence[ForceLaw]
    ) -> None:
        """Work out the passing of the model and what loads and places do to it. Raises as swept_response."""
        self.at = read_by(laws)
        passed = passing(model, rows)
        self._marches = passed.marches
        self._every = tuple(loads)
        self.model, self.rows, self.amounts, self.laws = model, rows, amounts, laws
        self.probes, self.loads = len(model.probes), len(loads)
        self.spectra: Spectra = replace(passed.spectra, probes=np.concatenate([model.probes, self.at]))
        self.pattern = np.concatenate([patterns(model, loads, order=1), self.at.T], axis=1)  # (dof, load and place)
        self.modes = passage(self.spectra, self.pattern)
        self.drive = drive(loads, rows)
        self.envelope = passed.envelope
        self.mean = self.at @ np.linalg.solve(matrices(model).K, self.at.T)  # (place, place) m/N

    def marched(self) -> Marched:
        """Return the motion; the last one is kept: a fit asks for a response, then for its derivatives.

        Raises DataError if the force is not found at too many turns.
        """
        key = self._moved_by()
        for known, found in self._marches:
            if known == key:
                kept: Marched = found
                return kept
        self._marches[:] = [(key, self._march())]
        return self.marched()

    def _moved_by(self) -> tuple[object, ...]:
        """Return what tells the loads in total, and the laws, from others of the same rotor."""
        acting = [
            (load.law, load.since, (pattern * amount).tobytes())
            for load, pattern, amount in zip(self._every, self.pattern.T, self.amounts, strict=False)
            if amount
        ]
        laws = [
            (law.force, law.overtones, *(part.tobytes() for part in (law.rows, law.constants, law.static)))
            for law in self.laws
        ]
        return (*acting, *laws)

    def _march(self) -> Marched:
        functions, constants = pointers(self.laws)
        above = self._above()
        most = int(MOST_UNSOLVED * len(self.rows.turns.t))
        a, rate, u, F, failed = called(
            march,
            MARCH,
            functions,
            constants,
            np.concatenate([law.static for law in self.laws]).astype(float),
            self.rows.turns.omega,
            self.envelope.operator,
            self.envelope.steps,
            self.envelope.turned,
            *(f @ self.amounts for f in self.envelope.forces(self.modes.g[..., : self.loads], self.drive)),
            self.push,
            self.seen,
            self.base @ self.amounts,
            self.flexibility,
            self.mean,
            above,
            most,
        )
        if failed > most:
            raise DataError(
                f"law: its force is not found at over {most} of {len(a)} turns, want a smoother or weaker one"
            )
        return Marched(a=a, rate=rate, u=u, F=F, above=above)

    def _above(self) -> Complex:
        omega = self.rows.turns.omega
        speeds = np.linspace(omega.min(), omega.max(), SPEEDS)
        return np.ascontiguousarray(CubicSpline(speeds, by_overtones(self.model, speeds, self.laws))(omega))

    def seen_by_rows(self, found: Marched) -> Complex:
        """Return what the rows show of order 1, (row, probe)."""
        others = self.modes.others[:, : self.probes]
        average = self.rows.averages(found.a[..., None], found.rate[..., None], powers=len(others))
        z = projected(self.modes.shape[..., : self.probes], average)[..., 0]
        z += self.drive.averaged(others[..., : self.loads]) @ self.amounts
        return z + at_once(self.rows, others[..., self.loads :], phasor(found.F, len(self.at))[..., None])[..., 0]

    @cached_property
    def push(self) -> Complex:
        """What a unit of force at a place does to the modes, (turn, mode, place)."""
        return polynomial(self.rows.power, self.modes.g[..., self.loads :])

    @cached_property
    def seen(self) -> Complex:
        """What the places see of the modes, (turn, place, mode)."""
        return polynomial(self.rows.power, self.modes.shape[..., self.probes :].swapaxes(1, 2))

    @cached_property
    def flexibility(self) -> Complex:
        """By how much the others let a unit of force move the places, (turn, place, place)."""
        return polynomial(self.rows.power, self.modes.others[:, self.probes :, self.loads :])

    @cached_property
    def base(self) -> Complex:
        """By how much the others let a unit of every load move the places, (turn, place, load)."""
        others = polynomial(self.rows.power, self.modes.others[:, self.probes :, : self.loads])
        return others * self.drive.at[:, None, self.drive.which]


def at_once(rows: TrackedRows, others: Complex, F: Complex) -> Complex:
    """Return the averages of polynomials (power, probe, place) times F (turn, place, column), (row, probe, column)."""
    slope = np.gradient(F, rows.turns.t, axis=0)
    average = rows.averages(F, slope, powers=len(others))  # (row, power, place, column)
    return projected(others.swapaxes(1, 2), average)


def read_by(laws: Sequence[ForceLaw]) -> Reals:
    """Return what reads x and y of every law's place, (place, dof)."""
    return np.concatenate([law.rows for law in laws])


def by_overtones(model: RotorModel, omega: Reals, laws: Sequence[ForceLaw]) -> Complex:
    """Return the steady motion of the places under a unit of every overtone, (speed, overtone, place, place) m/N.

    Nothing of laws without overtones, and no overtone at all where there are none but those.
    """
    at = read_by(laws)
    having = np.repeat([law.overtones for law in laws], 2)
    if not having.any():
        return np.zeros((len(omega), 0, len(at), len(at)), dtype=complex)
    seen = replace(model, probes=at)
    units = [[Load(row.astype(complex), "constant", order) for row in at] for order in OVERTONES]
    found = np.stack([load_columns(seen, omega, loads) for loads in units], axis=1)
    return found * np.outer(having, having)
