"""The swept response against integration in time, in two ways that share no code with it.

One integrates Jeffcott's rotor as a vibration and tracks its waveform as an instrument does; the other integrates the
envelope equation of the whole reduced model by Gauss's fourth-order collocation.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from rotorrig.rig.description import from_si
from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.assembly import assemble, matrices, with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.reduction import reduce
from rotorrig.sims.rotor.sweep import Timeline, swept_response

RPM = np.pi / 30
U = {"disk": 15e-6 * np.exp(0.6j)}


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


def integrated(model, ramp: Ramp, *, step: float) -> CubicSpline:
    """Return A(t) at the probes: Gauss collocation, order 4, of y' = (S - j Omega) y + b (Omega^2 - j alpha)."""
    M, C, G, K = matrices(model)
    n, unit = model.dof, np.eye(2 * model.dof)
    rows = model.disk("disk").rows
    load = np.append(np.zeros(n), np.linalg.solve(M, U["disk"] * (rows[0] - 1j * rows[1])))

    def slow(omega):
        lower = -np.linalg.solve(M, np.hstack([K, C + omega * G]))
        return np.vstack([np.eye(n, 2 * n, n), lower]) - 1j * omega * unit

    t = np.arange(0, ramp.seconds, step)
    y = np.empty((len(t), 2 * n), dtype=complex)
    y[0] = np.linalg.solve(slow(ramp.omega(0)), -load * (ramp.omega(0) ** 2 - 1j * ramp.rate))
    root = math.sqrt(3) / 6
    for i in range(len(t) - 1):
        (A1, f1), (A2, f2) = (
            (slow(omega), load * (omega**2 - 1j * ramp.rate))
            for omega in (ramp.omega(t[i] + step * (0.5 - root)), ramp.omega(t[i] + step * (0.5 + root)))
        )
        system = np.block(
            [[unit - step / 4 * A1, -step * (0.25 - root) * A1], [-step * (0.25 + root) * A2, unit - step / 4 * A2]]
        )
        k1, k2 = np.split(np.linalg.solve(system, np.append(A1 @ y[i] + f1, A2 @ y[i] + f2)), 2)
        y[i + 1] = y[i] + step / 2 * (k1 + k2)
    return CubicSpline(t, y[:, :n] @ model.probes.T)


@pytest.fixture(scope="module", params=[(1800, 30, 24.0), (2800, -60, 18.0)], ids=["up", "down"])
def passage_through_resonance(request, full):
    start, rate, seconds = request.param  # rpm, rpm/s, s
    ramp = Ramp(start * RPM, rate * RPM, seconds)
    model = reduce(full, modes=2)
    return model, ramp, integrated(model, ramp, step=0.01)


@pytest.mark.parametrize(("turns", "window"), [(8, "hann"), (16, "rectangular"), (12.5, "hann")])
def test_a_passage_through_resonance_is_that_of_integration_in_time(passage_through_resonance, turns, window):
    model, ramp, amplitude = passage_through_resonance
    when, _, weight = ramp.window(turns, window)
    want = np.einsum("p,rpk->rk", weight, amplitude(when))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=turns, window=window, unbalance=U)
    peak = np.abs(want).max()
    assert np.abs(got - want).max() < 1e-4 * peak
    steady = probe_response(model, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(steady - want).max() > 0.05 * peak  # what is being modelled


@pytest.mark.parametrize("rate", [30 * RPM, -60 * RPM], ids=["up", "down"])
def test_jeffcotts_rotor_tracked_from_its_waveform(rate):
    m, kx, ky, c = 0.8, 3.4e4, 3.6e4, 12.0
    rig = from_si(
        {
            "name": "Jeffcott",
            "shaft": {"length": 0.4, "diameter": 0.08, "density": 1e-3, "youngs_modulus": 2e13},
            "disks": [
                {
                    "name": "disk",
                    "position": 0.2,
                    "mass": m,
                    "polar_inertia": 5e-4,
                    "transverse_inertia": 3e-4,
                }
            ],
            "bearings": [
                {"name": name, "position": z, "kxx": kx / 2, "kyy": ky / 2, "cxx": c / 2, "cyy": c / 2}
                for name, z in (("a", 0.0), ("b", 0.4))
            ],
            "probes": [
                {"name": "x", "position": 0.2, "angle": 0.0, "channel": 0},
                {"name": "y", "position": 0.2, "angle": math.pi / 2, "channel": 1},
            ],
        }
    )
    start = 1700 * RPM if rate > 0 else 2400 * RPM
    ramp = Ramp(start, rate, 22.0 if rate > 0 else 12.0)
    phase = np.angle(U["disk"])

    def motion(t, state):
        x, y, u, v = state
        omega, angle = ramp.omega(t), ramp.theta(t) + phase
        fx = abs(U["disk"]) * (omega**2 * np.cos(angle) + rate * np.sin(angle))  # -d2/dt2 (U cos angle)
        fy = abs(U["disk"]) * (omega**2 * np.sin(angle) - rate * np.cos(angle))
        return [u, v, (fx - c * u - kx * x) / m, (fy - c * v - ky * y) / m]

    first = ramp.omega(0)
    Z = [k - first**2 * m + 1j * first * c for k in (kx, ky)]
    A = np.array([1 / Z[0], -1j / Z[1]]) * U["disk"] * first**2
    waveform = solve_ivp(
        motion, (0, ramp.seconds), [*A.real, *(1j * first * A).real], "DOP853", dense_output=True, rtol=1e-7, atol=1e-11
    ).sol
    when, angle, weight = ramp.window(10, "hann", points=400)
    seen = waveform(when.ravel())[:2].reshape(2, *when.shape)
    want = 2 * np.einsum("p,krp,rp->rk", weight, seen, np.exp(-1j * angle))  # z = 2 mean(x e^{-j theta})
    model = reduce(assemble(rig, max_element=0.1))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=10, window="hann", unbalance=U)
    assert np.abs(got - want).max() < 2e-4 * np.abs(want).max()


def test_at_constant_speed_it_is_the_steady_response(small):
    omega = 210.0
    timeline = Timeline(2 * np.pi / omega * np.arange(300))
    got = swept_response(small, timeline, t=[3.0, 5.0], revolutions=8, window="hann", unbalance=U)
    want = probe_response(small, [omega, omega], unbalance=U)
    np.testing.assert_allclose(got, want, atol=1e-8 * np.abs(want).max())


def test_very_slow_ramps_come_down_to_the_steady_response(small):
    ramp = Ramp(2000 * RPM, 0.02 * RPM, 60.0)
    got = swept_response(small, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    want = probe_response(small, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


def test_the_peak_lags_behind_on_the_way_up_and_on_the_way_down(small):
    speeds = []
    for ramp in (Ramp(1800 * RPM, 60 * RPM, 15.0), Ramp(2700 * RPM, -60 * RPM, 15.0)):
        z = swept_response(small, ramp.timeline, t=ramp.rows, revolutions=4, window="hann", unbalance=U)
        speeds.append(ramp.omega(ramp.rows)[np.argmax(np.abs(z[:, 0]))])
    up, down = np.array(speeds) / RPM
    assert down < 2226 < up


def test_a_heavily_damped_bearing_is_no_exception(small):
    """All poles far from the passed speeds: nothing lags, whatever is counted as passed."""
    damped = with_bearing(small, "spring", np.eye(2) * 34e3, np.eye(2) * 1e3)
    ramp = Ramp(600 * RPM, 30 * RPM, 60.0)
    got = swept_response(damped, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    want = probe_response(damped, ramp.omega(ramp.rows), unbalance=U)
    assert np.abs(got - want).max() < 2e-3 * np.abs(want).max()


def test_x_and_y_modes_that_coincide_are_passed_together(full):
    model = with_bearing(reduce(full, modes=2), "spring", np.eye(2) * 34e3, np.eye(2) * 15)
    ramp = Ramp(2000 * RPM, 60 * RPM, 8.0)
    amplitude = integrated(model, ramp, step=0.01)
    when, _, weight = ramp.window(8, "hann")
    want = np.einsum("p,rpk->rk", weight, amplitude(when))
    got = swept_response(model, ramp.timeline, t=ramp.rows, revolutions=8, window="hann", unbalance=U)
    assert np.abs(got - want).max() < 1e-4 * np.abs(want).max()


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (
            {"t": [0.01]},
            DataError,
            "row 0: its window of 8 turns about 0.01 s is not within the keyphasor pulses, 0 to",
        ),
        ({"t": [2.0, np.nan]}, DataError, "row 1: .* about nan s is not within"),
        ({"window": "flat"}, ValueError, "window is 'flat', want 'hann' or 'rectangular'"),
        ({"unbalance": {"disc": 1.0}}, ValueError, "no disk 'disc'"),
    ],
)
def test_what_cannot_be_answered_is_said(small, change, error, message):
    timeline = Timeline(0.03 * np.arange(200))
    asked = {"t": [2.0], "revolutions": 8, "window": "hann", "unbalance": U} | change
    with pytest.raises(error, match=message):
        swept_response(small, timeline, **asked)
