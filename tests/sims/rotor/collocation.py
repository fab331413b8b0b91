"""The envelope equation of a rotor in a ramp of speed, integrated by Gauss's fourth-order collocation.

With q = Re(A e^{j n theta}) and y = (A, its velocity): y' = (S - j n Omega) y + b law. It shares no code with the
package but the matrices.
"""

import math

import numpy as np
from scipy.interpolate import CubicSpline

from rotorrig.sims.rotor.model.assembly import matrices, speed_stiffness
from rotorrig.sims.rotor.swept.timeline import Timeline

RPM = np.pi / 30


class Ramp:
    """A constant acceleration, as a law of time and as pulses."""

    def __init__(self, start: float, rate: float, seconds: float) -> None:
        self.start, self.rate, self.seconds = start, rate, seconds
        turns = int(self.theta(seconds) / (2 * np.pi))
        self.timeline = Timeline(self.when(2 * np.pi * np.arange(turns + 1)))
        self.rows = np.linspace(1.5, seconds - 1.5, 200)

    def omega(self, t):
        return self.start + self.rate * t

    def theta(self, t):
        return self.start * t + self.rate * t**2 / 2

    def when(self, theta):
        return (np.sqrt(self.start**2 + 2 * self.rate * theta) - self.start) / self.rate

    def window(self, turns: float, window: str, points: int = 200):
        """Return the times (row, point) at equal angles across each row's window, and their weights (point,)."""
        psi = (np.arange(points) + 0.5) / points * 2 - 1
        weight = 1 + np.cos(np.pi * psi) if window == "hann" else np.ones(points)
        angle = self.theta(self.rows)[:, None] + np.pi * turns * psi
        return self.when(angle), angle, weight / weight.sum()


def integrated(model, ramp: Ramp, pattern, *, step: float, law="unbalance", order=1, since=-math.inf) -> CubicSpline:
    """Return A(t) at the probes under one load, steady at the start or at rest until `since`."""
    M, C, G, K = matrices(model)
    H, S = speed_stiffness(model)
    n, unit = model.dof, np.eye(2 * model.dof)
    load = np.append(np.zeros(n), np.linalg.solve(M, pattern))

    def slow(omega):
        lower = -np.linalg.solve(M, np.hstack([K + omega * H + omega**2 * S, C + omega * G]))
        return np.vstack([np.eye(n, 2 * n, n), lower]) - 1j * order * omega * unit

    def force(omega):
        return load * ((order * omega) ** 2 - 1j * order * ramp.rate if law == "unbalance" else 1)

    t = np.arange(max(since, 0), ramp.seconds, step)
    y = np.zeros((len(t), 2 * n), dtype=complex)
    if since < 0:
        y[0] = np.linalg.solve(slow(ramp.omega(0)), -force(ramp.omega(0)))
    root = math.sqrt(3) / 6
    for i in range(len(t) - 1):
        (A1, f1), (A2, f2) = (
            (slow(omega), force(omega))
            for omega in (ramp.omega(t[i] + step * (0.5 - root)), ramp.omega(t[i] + step * (0.5 + root)))
        )
        system = np.block(
            [[unit - step / 4 * A1, -step * (0.25 - root) * A1], [-step * (0.25 + root) * A2, unit - step / 4 * A2]]
        )
        k1, k2 = np.split(np.linalg.solve(system, np.append(A1 @ y[i] + f1, A2 @ y[i] + f2)), 2)
        y[i + 1] = y[i] + step / 2 * (k1 + k2)
    return CubicSpline(t, y[:, :n] @ model.probes.T)
