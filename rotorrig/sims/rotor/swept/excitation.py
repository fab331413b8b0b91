"""Excitation over a sweep: the loads' laws at the instants of the integrator, and averaged over every row's window.

Loads of one law that begin together share it. A load may begin within a turn or a window: the step of the integrator
is then given the impulse of the rest of the turn, and each point of a window the part of its surroundings that is
still to come.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model import Load
from rotorrig.sims.rotor.swept.timeline import TURN
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]

TINY = 1e-12  # turns


@dataclass(frozen=True, slots=True, kw_only=True)
class Excitation:
    """Laws of the loads over a sweep, each law once."""

    which: NDArray[np.intp]  # (load,) the law of each
    at: Complex  # (turn, law)
    mid: Complex  # (turn - 1, law) halfway in time
    moments: Complex  # (row, power, law) averages of x^power times the law

    def forces(self, at: Complex, mid: Complex) -> tuple[Complex, Complex]:
        """Multiply forces per unit of a load's law, (turn, ..., load) and halfway, by the laws, in place."""
        between = (1,) * (at.ndim - 2)
        at *= self.at[:, self.which].reshape(len(at), *between, -1)
        mid *= self.mid[:, self.which].reshape(len(mid), *between, -1)
        return at, mid

    def conjugate(self) -> "Excitation":
        """Return the conjugate laws, those of the conjugate motion."""
        return Excitation(which=self.which, at=self.at.conj(), mid=self.mid.conj(), moments=self.moments.conj())

    def average(self, values: Complex) -> Complex:
        """Return averages of polynomials in the speed times the laws, (..., row, probe, load).

        `values` (power, ..., probe, load) are the coefficients.
        """
        powers, *between, probes, loads = values.shape
        out = np.empty((len(self.moments), *between, probes, loads), dtype=complex)
        for law in range(self.moments.shape[-1]):
            of_law = self.which == law
            out[..., of_law] = np.tensordot(self.moments[:, :powers, law], values[..., of_law], 1)
        return np.moveaxis(out, 0, -3)


def sample_excitation(loads: Sequence[Load], rows: TrackedRows) -> Excitation:
    """Sample the laws of the loads, which are all of the rows' order."""
    kinds = list(dict.fromkeys((load.law, load.since) for load in loads))
    laws = [_law(rows, *kind) for kind in kinds] or [_law(rows, "constant", -math.inf)]
    at, mid, moments = (np.stack(parts, axis=-1) for parts in zip(*laws, strict=True))
    which = np.array([kinds.index((load.law, load.since)) for load in loads], dtype=np.intp)
    return Excitation(which=which, at=at, mid=mid, moments=moments)


def _law(rows: TrackedRows, law: str, since: float) -> tuple[Complex, Complex, Complex]:
    """Return one law at the turns, halfway, and averaged, (turn,), (turn - 1,) and (row, power)."""
    turns, points = rows.turns, rows.points
    at, mid, seen = (
        _values(law, omega, alpha)
        for omega, alpha in (
            (turns.omega, turns.alpha),
            (turns.omega_mid, turns.alpha_mid),
            (points.omega, points.alpha),
        )
    )
    if since > turns.t[0]:
        begun = int(np.searchsorted(turns.t, since))  # turns before it
        at[:begun] = 0
        mid[: begun - 1] = 0
        if begun < len(turns.t):
            rest = (turns.t[begun] - since) / (turns.t[begun] - turns.t[begun - 1])
            mid[begun - 1] *= (6 * rest - 1) / 4  # with 0 and 1 at the ends, Simpson's rule gives `rest`
        since = min(since, float(rows.timeline.t[-1]))  # the angle goes astray beyond the pulses
        begins = float(rows.timeline.theta(since)) / TURN * rows.order
        before, after = points.edges[:, :-1], points.edges[:, 1:]
        seen = seen * np.clip((after - begins) / np.maximum(after - before, TINY), 0, 1)
    return at, mid, np.einsum("rp,rpq->rq", seen, points.weighted)


def _values(law: str, omega: Reals, alpha: Reals) -> Complex:
    return np.ones(omega.shape, dtype=complex) if law == "constant" else omega**2 - 1j * alpha
