"""The amplitudes of the passed modes from turn to turn, and their derivatives: passage.py's equation, stepped."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.march import advanced, propagators, push
from rotorrig.sims.rotor.passage import Passage
from rotorrig.sims.rotor.timeline import TURN
from rotorrig.sims.rotor.tracking import TrackedRows

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """Columns of a modal motion at every whole turn, and what the rows see of it."""

    a: Complex  # (turn, mode, column)
    rate: Complex  # (turn, mode, column) 1/s
    average: Complex  # (row, power, mode, column), see TrackedRows.averages


class Envelope:
    """a' = (L - j Omega - alpha T) a + g (Omega^2 - j alpha) on one timeline; the propagators serve all columns."""

    def __init__(self, modes: Passage, rows: TrackedRows) -> None:
        """Work out what every step does."""
        turns = rows.turns
        self._modes, self._rows = modes, rows
        self._h = np.diff(turns.t)
        self._operator = _still(modes, rows.power, turns.alpha)
        _turn(self._operator, turns.omega)
        middle = _still(modes, rows.power_mid, turns.alpha_mid)
        _turn(middle, turns.omega_mid)
        self._steps = propagators(middle, self._h)
        # Within a step Omega moves on from omega_mid: that phase, known from the pulses, is put into the force.
        phase = np.stack([turns.theta_mid - turns.omega_mid * self._h / 2, TURN - turns.omega_mid * self._h], axis=1)
        self._turned = np.exp(1j * phase)

    def response(self) -> Motion:
        """Return the motion under a unit of each load, steady at the first turn."""
        return self._driven(*self._forces(self._modes.g))

    def derivatives(self, change: Passage, motion: Motion) -> Motion:
        """Return the derivative of the motion along directions, its columns (direction, load).

        da' = (L - j Omega - alpha T) da + (dL - alpha dT) a + dg (Omega^2 - j alpha): moved as a is, and pushed by a.
        """
        a, rate = motion.a, motion.rate
        a_mid = (a[:-1] + a[1:]) / 2 + self._h[:, None, None] / 8 * (rate[:-1] - rate[1:])  # by the cubic
        by_mode = change.g.swapaxes(1, 2)  # (power, mode, direction, load)
        force, force_mid = self._forces(by_mode.reshape(*by_mode.shape[:2], by_mode[0, 0].size))
        push(_flat(change.L), _flat(change.T), self._rows.power, self._rows.turns.alpha, a, a_mid, force, force_mid)
        return self._driven(force, force_mid)

    def _forces(self, g: Complex) -> tuple[Complex, Complex]:
        """Return g (Omega^2 - j alpha) at the turns and halfway in time, (turn, mode, column)."""
        turns, rows = self._rows.turns, self._rows
        force, force_mid = polynomial(rows.power, g), polynomial(rows.power_mid, g)
        force *= (turns.omega**2 - 1j * turns.alpha)[:, None, None]
        force_mid *= (turns.omega_mid**2 - 1j * turns.alpha_mid)[:, None, None]
        return force, force_mid

    def _driven(self, force: Complex, force_mid: Complex) -> Motion:
        """Return the motion under a force at the turns and halfway in time, (turn, mode, column)."""
        start = np.linalg.solve(self._operator[0], -force[0])
        a, rate = advanced(self._operator, self._steps, self._turned, force, force_mid, start)
        return Motion(a=a, rate=rate, average=self._rows.averages(a, rate, powers=len(self._modes.g)))


def polynomial(power: Reals, coefficients: Complex) -> Complex:
    """Return polynomials of `coefficients` (power, ...), (n, ...), where x has these powers, (n, power or more)."""
    flat = _flat(coefficients)  # the powers are real: half the work
    return (power[:, : len(flat)] @ flat).view(complex).reshape(len(power), *coefficients.shape[1:])


def _flat(coefficients: Complex) -> Reals:
    """Return (power, ...) as real (power, n), re and im in turn."""
    return np.ascontiguousarray(coefficients).reshape(len(coefficients), coefficients[0].size).view(float)


def _still(modes: Passage, power: Reals, alpha: Reals) -> Complex:
    """Return L - alpha T, (turn, mode, mode)."""
    found = polynomial(power, modes.L)
    found -= polynomial(alpha[:, None] * power, modes.T)
    return found


def _turn(L: Complex, omega: Reals) -> None:
    """Take j Omega from L (turn, mode, mode): what is seen in a frame that turns with the shaft."""
    i = np.arange(L.shape[1])
    L[:, i, i] -= 1j * omega[:, None]
