"""A stiffness that turns with the shaft: a closed form in the rotor's own axes, and integration in time."""

import cmath

import numpy as np
import pytest

from rotorrig.rig.config.description import from_si
from rotorrig.sims.rotor.model.assembly import Added, RotorModel, assemble, with_added
from rotorrig.sims.rotor.model.derivatives import finite_difference
from rotorrig.sims.rotor.model.loads import Load, unbalance_pattern
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.steady.conjugate_solve import solve_with_conjugate
from rotorrig.sims.rotor.steady.derivatives import steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import load_columns
from rotorrig.sims.rotor.swept.swept_response import swept_columns, swept_derivatives
from rotorrig.sims.rotor.swept.timeline import Timeline
from rotorrig.sims.rotor.swept.tracking_windows import tracked_rows
from tests.sims.rotor.collocation import RPM, Ramp
from tests.sims.rotor.off_nameplate import CHANGES as OFF

V = 900.0 * np.exp(0.7j)  # N/m, of some 41 kN/m at the disk
U = 8e-6 * np.exp(0.4j)  # kg m


def stiffer(model: RotorModel, v: complex = V) -> RotorModel:
    """The disk held by +-|v| along and across a diameter that turns with the shaft."""
    f = model.disks[0].rows[0] - 1j * model.rotation * model.disks[0].rows[1]
    return with_added(model, Added(T=v * np.outer(f, f)))


def unbalance(model: RotorModel, amount: complex = U) -> Load:
    return Load(unbalance_pattern(model, {"disk": amount}), "unbalance")


def jeffcott(*, c: float = 0.0) -> RotorModel:
    """A mass of 0.8 kg on two springs of 20 kN/m and dampers of c each, on a shaft that hardly weighs or bends."""
    rotor = assemble(
        from_si(
            {
                "name": "by hand",
                "shaft": {"length": 0.4, "diameter": 0.2, "density": 1e-3, "youngs_modulus": 210e9},
                "disks": [
                    {"name": "disk", "position": 0.2, "mass": 0.8, "polar_inertia": 0.0, "transverse_inertia": 1e-9}
                ],
                "bearings": [
                    {"name": n, "position": z, "kxx": 20e3, "kyy": 20e3, "cxx": c, "cyy": c}
                    for n, z in (("A", 0.0), ("B", 0.4))
                ],
                "probes": [
                    {"name": n, "position": 0.2, "angle": a, "channel": i}
                    for i, (n, a) in enumerate((("x", 0.0), ("y", np.pi / 2)))
                ],
            }
        ),
        max_element=0.2,
    )
    return reduce(rotor, modes=4)


@pytest.mark.parametrize("ratio", [0.3, 0.9, 0.95, 1.05, 1.2, 2.0])
def test_in_its_own_axes_the_rotor_has_two_stiffnesses(ratio: float) -> None:
    """(k + v - m W^2) xi = W^2 U cos, (k - v - m W^2) eta = W^2 U sin: Tondl (1965), ch. 2."""
    k, v, s = 40e3, 1200.0, 0.35
    omega = ratio * np.sqrt(k / 0.8)
    model = stiffer(jeffcott(), v * np.exp(2j * s))
    along = U * np.exp(-1j * s)
    xi = omega**2 * along.real / (k + v - 0.8 * omega**2)
    eta = omega**2 * along.imag / (k - v - 0.8 * omega**2)
    r = (xi + 1j * eta) * np.exp(1j * s)
    z = load_columns(model, np.array([omega]), [unbalance(model)])[0, :, 0]
    assert z == pytest.approx([r, -1j * r], rel=3e-3)  # the shaft's own flexibility


def test_a_steady_speed_shows_the_steady_response(small: RotorModel) -> None:
    omega = 231.0
    rows = tracked_rows(Timeline(2 * np.pi / omega * np.arange(300)), t=[4.0], revolutions=8, window="hann")
    model = stiffer(small)
    loads = [unbalance(model), unbalance(model, 1j * U), Load(model.disks[0].rows[1].astype(complex), "constant")]
    want = load_columns(model, np.array([omega]), loads)
    got = swept_columns(model, rows, loads=loads)
    assert np.abs(got - want).max(axis=(0, 1)) == pytest.approx(0, abs=1e-9 * np.abs(want).max())


def test_it_is_felt_at_1x_alone(small: RotorModel) -> None:
    rows = Ramp(900 * RPM, 60 * RPM, 8.0)
    tracked = tracked_rows(rows.timeline, t=rows.rows, revolutions=8, window="hann")
    load = [Load(small.disks[0].rows[0].astype(complex), "constant", order=2)]
    a, b = (swept_columns(model, tracked, loads=load, order=2) for model in (small, stiffer(small)))
    np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("rate", [60.0, -60.0])
def test_through_the_resonance_it_is_as_integrated_in_time(rate: float) -> None:
    """m r'' + c r' + k r + v e^{2 j theta} r* = (W^2 - j a) U e^{j theta}, r = x + j y, theta a parabola."""
    k, c, v = 40e3, 10.0, 900.0 * np.exp(0.7j)
    start, seconds = (1700, 16.0) if rate > 0 else (2600, 16.0)
    ramp = Ramp(start * RPM, rate * RPM, seconds)
    model = stiffer(jeffcott(c=c / 2), v)
    begin = load_columns(model, np.array([ramp.start]), [unbalance(model)])[0, 0, 0]
    t, r = integrated(ramp, begin, k=k, c=c, v=v)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    got, plain = (swept_columns(each, rows, loads=[unbalance(each)])[:, 0, 0] for each in (model, jeffcott(c=c / 2)))
    want = np.array([windowed(r * np.exp(-1j * ramp.theta(t)), ramp, t, middle) for middle in ramp.rows])
    assert np.abs(got - plain).max() > 0.2 * np.abs(plain).max()
    assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


def integrated(ramp: Ramp, begin: complex, *, k: float, c: float, v: complex) -> tuple[np.ndarray, np.ndarray]:
    """r (step,) of a mass of 0.8 kg at times (step,), by Runge and Kutta's fourth-order method."""
    h, m = 5e-4, 0.8

    def slope(t: float, r: complex, u: complex) -> tuple[complex, complex]:
        w, turn = ramp.start + ramp.rate * t, cmath.exp(1j * ramp.theta(t))
        return u, ((w * w - 1j * ramp.rate) * U * turn - c * u - k * r - v * turn * turn * r.conjugate()) / m

    found, r, u = [], complex(begin), 1j * ramp.start * complex(begin)
    times = h * np.arange(round(ramp.seconds / h))
    for t in map(float, times):
        found.append(r)
        r1, u1 = slope(t, r, u)
        r2, u2 = slope(t + h / 2, r + h / 2 * r1, u + h / 2 * u1)
        r3, u3 = slope(t + h / 2, r + h / 2 * r2, u + h / 2 * u2)
        r4, u4 = slope(t + h, r + h * r3, u + h * u3)
        r, u = r + h / 6 * (r1 + 2 * r2 + 2 * r3 + r4), u + h / 6 * (u1 + 2 * u2 + 2 * u3 + u4)
    return times, np.array(found)


def windowed(a: np.ndarray, ramp: Ramp, t: np.ndarray, middle: float) -> complex:
    """The mean of a (step,) over 8 turns about a time, weighed by 1 + cos in angle."""
    psi = ramp.theta(t) - ramp.theta(middle)
    weight = np.where(np.abs(psi) < 8 * np.pi, (1 + np.cos(psi / 8)) * ramp.omega(t), 0.0)
    return complex(a @ weight / weight.sum())


@pytest.mark.parametrize("v", [0.0, V])
def test_derivatives_are_the_limit_of_differences(small: RotorModel, v: complex) -> None:
    ramp = Ramp(1800 * RPM, 60 * RPM, 12.0)
    rows = tracked_rows(ramp.timeline, t=ramp.rows, revolutions=8, window="hann")
    model, h = stiffer(small, v), 20.0
    loads = [unbalance(model), unbalance(model, 1j * U)]
    omega = np.linspace(1900, 2500, 7) * RPM
    for step in (h, 1j * h):
        up, down = stiffer(small, v + step), stiffer(small, v - step)
        direction = finite_difference(model, stiffer(small, v + step), h)
        got = swept_derivatives(model, rows, loads=loads, directions=[direction]).by[0]
        want = (swept_columns(up, rows, loads=loads) - swept_columns(down, rows, loads=loads)) / (2 * h)
        assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()
        got = steady_derivatives(model, omega, loads=loads, directions=[direction]).by[0]
        want = (load_columns(up, omega, loads) - load_columns(down, omega, loads)) / (2 * h)
        assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


@pytest.mark.parametrize("name", ["disk position", "probe position"])
def test_so_are_those_by_positions_under_it(adjustable: RotorModel, name: str) -> None:
    changed, direction = OFF[name]
    model, load = stiffer(changed(adjustable, 0.0)), unbalance(adjustable)
    theta, start, rate = 2 * np.pi * np.arange(500), 1900 * RPM, 30 * RPM
    timeline = Timeline((np.sqrt(start**2 + 2 * rate * theta) - start) / rate)
    rows = tracked_rows(timeline, t=np.linspace(timeline.t[6], timeline.t[-7], 40), revolutions=8, window="hann")
    omega = np.array([190.0, 231.0, 250.0])
    h = 1e-2
    near, far = (stiffer(changed(adjustable, p)) for p in (-h, h))
    for got, want in (
        (
            swept_derivatives(model, rows, loads=[load], directions=[direction(model)]).by[0],
            (swept_columns(far, rows, loads=[load]) - swept_columns(near, rows, loads=[load])) / (2 * h),
        ),
        (
            steady_derivatives(model, omega, loads=[load], directions=[direction(model)]).by[0],
            (load_columns(far, omega, [load]) - load_columns(near, omega, [load])) / (2 * h),
        ),
    ):
        assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


def test_an_equation_with_the_conjugate_is_solved(rng: np.random.Generator) -> None:
    Z, C, right = (rng.normal(size=(5, n, m)) + 1j * rng.normal(size=(5, n, m)) for n, m in ((3, 3), (3, 3), (3, 2)))
    q = solve_with_conjugate(Z, C, right)
    np.testing.assert_allclose(Z @ q + C @ q.conj(), right, atol=1e-12)
