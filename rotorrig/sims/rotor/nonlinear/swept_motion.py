"""Motion of the force laws' places over one sweep, and the forces on them.

The passed modes are stepped with the first harmonic of the force and its mean, solved for at every turn, so the branch
taken through a fold, up or down, is that of the time before. The overtones of the force move its place as in steady
motion, and that is part of the motion it is evaluated on.
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
from rotorrig.sims.rotor.nonlinear.harmonic_balance import call_kernel, pack_laws, phasor
from rotorrig.sims.rotor.nonlinear.law_stepping import STEPPING, step_with_laws
from rotorrig.sims.rotor.steady import load_columns
from rotorrig.sims.rotor.swept import (
    Spectra,
    TrackedRows,
    fit_passed_modes,
    polynomial,
    project_to_probes,
    sample_excitation,
    solve_sweep,
)

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

MOST_UNSOLVED = 0.01  # of the turns
KEPT = 4  # motions under overtones: of the rows and the slow roll, at a point and at that before it
SPEEDS = 128  # a sweep is divided into for the overtones: 25 rpm each on an RK4, half the width of its resonance

_KNOWN: list[tuple[RotorModel, tuple[bytes, bytes], Complex]] = []  # rotor, speeds and places, motion: the latest


@dataclass(frozen=True, slots=True, kw_only=True)
class LawMotion:
    """Solved motion of modes and places, with the forces on the places."""

    a: Complex  # (turn, mode) of the passed modes
    rate: Complex  # (turn, mode) 1/s
    u: Reals  # (turn, part) of the laws' places, as in harmonic_balance.py
    F: Reals  # (turn, part) N, the force on them
    overtones: Complex  # (turn, overtone, place, place) m/N, how far a unit of the force's overtones moves them


class LawSweep:
    """One sweep with force laws, under loads of order 1 times their amounts (load,); a place is x or y of a law."""

    def __init__(
        self, model: RotorModel, rows: TrackedRows, loads: Sequence[Load], amounts: Complex, laws: Sequence[ForceLaw]
    ) -> None:
        """Solve the linear model for loads and unit forces at the places. Raises as swept_response."""
        self.at = place_rows(laws)
        passed = solve_sweep(model, rows)
        self._motions = passed.motions
        self._every = tuple(loads)
        self.model, self.rows, self.amounts, self.laws = model, rows, amounts, laws
        self.probes, self.loads = len(model.probes), len(loads)
        self.spectra: Spectra = replace(passed.spectra, probes=np.concatenate([model.probes, self.at]))
        self.pattern = np.concatenate([patterns(model, loads, order=1), self.at.T], axis=1)  # (dof, load and place)
        self.modes = fit_passed_modes(self.spectra, self.pattern)
        self.excitation = sample_excitation(loads, rows)
        self.envelope = passed.envelope
        self.mean = self.at @ np.linalg.solve(matrices(model).K, self.at.T)  # (place, place) m/N

    def solve(self) -> LawMotion:
        """Solve for the motion; the last one is kept: a fit asks for a response, then for its derivatives.

        Raises DataError if the force does not converge at too many turns.
        """
        key = self._key()
        for known, motion in self._motions:
            if known == key:
                kept: LawMotion = motion
                return kept
        self._motions[:] = [(key, self._step())]
        return self.solve()

    def _key(self) -> tuple[object, ...]:
        """Return the key of the loads in total, and of the laws, among others of the same rotor."""
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

    def _step(self) -> LawMotion:
        functions, constants = pack_laws(self.laws)
        overtones = self._overtone_compliance()
        most = int(MOST_UNSOLVED * len(self.rows.turns.t))
        a, rate, u, F, failed = call_kernel(
            step_with_laws,
            STEPPING,
            functions,
            constants,
            np.concatenate([law.static for law in self.laws]).astype(float),
            self.rows.turns.omega,
            self.envelope.operator,
            self.envelope.steps,
            self.envelope.phases,
            *(f @ self.amounts for f in self.envelope.forces(self.modes.g[..., : self.loads], self.excitation)),
            self.participation,
            self.shapes,
            self.by_loads @ self.amounts,
            self.flexibility,
            self.mean,
            overtones,
            most,
        )
        if failed > most:
            raise DataError(
                f"law: its force is not found at over {most} of {len(a)} turns, want a smoother or weaker one"
            )
        return LawMotion(a=a, rate=rate, u=u, F=F, overtones=overtones)

    def _overtone_compliance(self) -> Complex:
        omega = self.rows.turns.omega
        speeds = np.linspace(omega.min(), omega.max(), SPEEDS)
        return np.ascontiguousarray(CubicSpline(speeds, overtone_compliance(self.model, speeds, self.laws))(omega))

    def at_probes(self, motion: LawMotion) -> Complex:
        """Return the response of order 1 at the probes, (row, probe)."""
        others = self.modes.others[:, : self.probes]
        average = self.rows.averages(motion.a[..., None], motion.rate[..., None], powers=len(others))
        z = project_to_probes(self.modes.shape[..., : self.probes], average)[..., 0]
        z += self.excitation.average(others[..., : self.loads]) @ self.amounts
        return (
            z
            + quasistatic_average(self.rows, others[..., self.loads :], phasor(motion.F, len(self.at))[..., None])[
                ..., 0
            ]
        )

    @cached_property
    def participation(self) -> Complex:
        """Participation of a force at a place in the modes, (turn, mode, place)."""
        return polynomial(self.rows.power, self.modes.g[..., self.loads :])

    @cached_property
    def shapes(self) -> Complex:
        """Mode shapes at the places, (turn, place, mode)."""
        return polynomial(self.rows.power, self.modes.shape[..., self.probes :].swapaxes(1, 2))

    @cached_property
    def flexibility(self) -> Complex:
        """Flexibility of the places through the others, (turn, place, place) m/N."""
        return polynomial(self.rows.power, self.modes.others[:, self.probes :, self.loads :])

    @cached_property
    def by_loads(self) -> Complex:
        """Motion of the places through the others under a unit of every load, (turn, place, load)."""
        others = polynomial(self.rows.power, self.modes.others[:, self.probes :, : self.loads])
        return others * self.excitation.at[:, None, self.excitation.which]


def quasistatic_average(rows: TrackedRows, others: Complex, F: Complex) -> Complex:
    """Return averages of what follows a force at once: polynomials (power, probe, place) times F (turn, place, column).

    (row, probe, column)
    """
    slope = np.gradient(F, rows.turns.t, axis=0)
    average = rows.averages(F, slope, powers=len(others))  # (row, power, place, column)
    return project_to_probes(others.swapaxes(1, 2), average)


def place_rows(laws: Sequence[ForceLaw]) -> Reals:
    """Return the rows that read x and y of every law's place, (place, dof)."""
    return np.concatenate([law.rows for law in laws])


def overtone_compliance(model: RotorModel, omega: Reals, laws: Sequence[ForceLaw]) -> Complex:
    """Return the steady motion of the places under a unit of every overtone, (speed, overtone, place, place) m/N.

    Nothing of laws without overtones, and no overtone at all where there are none but those.
    """
    at = place_rows(laws)
    having = np.repeat([law.overtones for law in laws], 2)
    if not having.any():
        return np.zeros((len(omega), 0, len(at), len(at)), dtype=complex)
    return _overtone_motion(model, omega, at) * np.outer(having, having)


def _overtone_motion(model: RotorModel, omega: Reals, at: Reals) -> Complex:
    """Return the same of laws that have overtones; the last few are kept: they stay while only the laws change."""
    asked = (omega.tobytes(), at.tobytes())
    for known, of, motion in _KNOWN:
        if known is model and of == asked:
            return motion
    seen = replace(model, probes=at)
    units = [[Load(row.astype(complex), "constant", order) for row in at] for order in OVERTONES]
    motion = np.stack([load_columns(seen, omega, loads) for loads in units], axis=1)
    motion.flags.writeable = False
    _KNOWN[:] = [(model, asked, motion), *_KNOWN[: KEPT - 1]]
    return motion
