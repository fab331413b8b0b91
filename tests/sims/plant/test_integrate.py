"""The time integration against closed forms and against the frequency domain."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at, law
from rotorrig.sims.plant.integrate import ShaftMotion
from rotorrig.sims.plant.shaft import MATERIAL_DAMPING, Rotor, build

from .by_hand import RPM

H = 1e-4  # s


def undamped(rig: RigConfig) -> RigConfig:
    return rig.model_copy(update={"bearings": rig.bearings[:2]})


def at_rest(steps: int) -> tuple[NDArray, NDArray, NDArray]:
    return np.zeros(steps), np.zeros(steps), np.zeros(steps)


def turning(omega: float, steps: int) -> tuple[NDArray, NDArray, NDArray]:
    return omega * H * np.arange(1, steps + 1), np.full(steps, omega), np.zeros(steps)


def release(motion: ShaftMotion, rotor: Rotor, place: float, deflection: float) -> None:
    """Hold the shaft bent by a force at `place` in x, then let go."""
    force = np.zeros(2 * rotor.n)
    force[rotor.station(place)] = 1.0
    shape = np.linalg.solve(rotor.K, force)
    motion.state[0] = shape * deflection / shape[rotor.station(place)]
    motion.state[2] = np.linalg.solve(rotor.M, -rotor.K @ motion.state[0])


def test_a_released_disk_rings_at_the_root_of_k_over_m(jeffcott: RigConfig) -> None:
    rig = undamped(jeffcott)
    rotor = build(rig, nameplate(rig))
    motion = ShaftMotion(rotor, step=H, watched=(0.2,))
    release(motion, rotor, 0.2, 1e-4)
    x = motion.run(*at_rest(40_000))[:, 0, 0]
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossing = up - x[up] / (x[up + 1] - x[up])
    period = H * (crossing[-1] - crossing[0]) / (len(crossing) - 1)
    # k / m in the closed form, the shaft's 2e-5 kg and Newmark's (w h)^2 / 12 = 6.1e-5 within the tolerance
    assert period == pytest.approx(2 * np.pi / np.sqrt(73.631e3), rel=1e-4)
    # the material's damping k MATERIAL_DAMPING on 1 kg, and none of the integrator's; the last period ends at 4 s
    left = 1e-4 * np.exp(-MATERIAL_DAMPING * 73.631e3 / 2 * 3.99)
    assert np.abs(x[-232:]).max() == pytest.approx(left, rel=2e-3)


def test_the_rk4_s_period_is_long_by_less_than_1e_4(rk4: RigConfig) -> None:
    """The first mode in x, from a ring-down of four seconds against the eigenvalue at standstill."""
    rotor = build(rk4, nameplate(rk4))
    motion = ShaftMotion(rotor, step=H, watched=(0.2805,))
    release(motion, rotor, 0.2805, 1e-4)
    x = motion.run(*at_rest(10_000))[2000:, 0, 0]  # higher modes have died by then
    up = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossing = up - x[up] / (x[up + 1] - x[up])
    measured = 2 * np.pi * (len(crossing) - 1) / (H * (crossing[-1] - crossing[0]))
    n = rotor.n
    M, C, K = rotor.M[:n, :n], rotor.C[:n, :n], rotor.K[:n, :n]
    inverse = np.linalg.inv(M)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ K, -inverse @ C]])
    damped = min(w for w in np.linalg.eigvals(A).imag if w > 1.0)
    assert measured == pytest.approx(damped, rel=1e-4)


def test_a_jeffcott_rotor_answers_unbalance_as_the_closed_form(jeffcott: RigConfig) -> None:
    """z = e W^2 / (w^2 - W^2 + 2 j zeta w W), Friswell et al. (2010) ch. 6: in phase below, opposed far above."""
    rotor = build(jeffcott, nameplate(jeffcott))
    w, zeta, e = np.sqrt(73.631e3), 27.13 / (2 * np.sqrt(73.631e3)), 20e-6
    for omega in (0.3 * w, 0.9 * w, w, 1.1 * w, 1.6 * w):
        motion = ShaftMotion(rotor, step=H, unbalances=((0.2, 20e-6, 0.0),), watched=(0.2,))
        theta, speed, alpha = turning(omega, 12_000)
        seen = motion.run(theta, speed, alpha)[-6000:, 0]
        last = np.exp(-1j * theta[-6000:])
        window = np.hanning(6000) / np.hanning(6000).sum()
        z_x, z_y = (2 * np.sum(window * seen[:, k] * last) for k in (0, 1))
        expected = e * omega**2 / (w**2 - omega**2 + 2j * zeta * w * omega)
        assert abs(z_x - expected) < 2e-3 * abs(expected)
        assert abs(z_y + 1j * expected) < 2e-3 * abs(expected)


def test_angular_acceleration_pushes_the_heavy_spot_back(jeffcott: RigConfig) -> None:
    """At angle zero and no speed, d2/dt2 (cos, sin) is (0, alpha), so the unbalance U pulls by (0, -U alpha)."""
    rotor = build(jeffcott, nameplate(jeffcott))
    motion = ShaftMotion(rotor, step=H, unbalances=((0.2, 20e-6, 0.0),), watched=(0.2,))
    steps = 10_000
    seen = motion.run(np.zeros(steps), np.zeros(steps), np.full(steps, 500.0))[-1, 0]
    assert seen == pytest.approx([0.0, -20e-6 * 500.0 / 73.631e3], rel=1e-4, abs=1e-12)


def test_gyroscopic_and_rotating_damping_terms_agree_with_the_frequency_domain(rk4: RigConfig) -> None:
    """Steady unbalance response from K - W^2 (M - j G2) + W (j C + D2), with a disk heavy enough in Ip to show."""
    top = rk4.disks[0].model_copy(update={"polar_inertia": 2e-2, "transverse_inertia": 1e-2, "position": 0.4})
    rig = rk4.model_copy(update={"disks": (top,), "gravity": "none"})
    rotor = build(rig, nameplate(rig))
    omega, U, n = 2000 * RPM, 15e-6, rotor.n
    cross = np.zeros((2, 2 * n, 2 * n))
    for k, A in enumerate((rotor.G, rotor.D)):
        cross[k, :n, n:], cross[k, n:, :n] = A, -A
    Z = rotor.K - omega**2 * (rotor.M - 1j * cross[0]) + omega * (1j * rotor.C + cross[1])
    force = np.zeros(2 * n, complex)
    force[[rotor.station(0.4), n + rotor.station(0.4)]] = omega**2 * U * np.array([1.0, -1j])
    expected = np.linalg.solve(Z, force)[[rotor.station(0.3805), n + rotor.station(0.3805)]]
    without = np.linalg.solve(Z - omega**2 * 1j * cross[0], force)[rotor.station(0.3805)]
    assert abs(without / expected[0] - 1) > 0.05  # the test can see gyroscopics

    motion = ShaftMotion(rotor, step=H, unbalances=((0.4, U, 0.0),), watched=(0.3805,))
    theta, speed, alpha = turning(omega, 60_000)
    seen = motion.run(theta, speed, alpha)[-30_000:, 0]
    z = 2 * np.mean(seen * np.exp(-1j * theta[-30_000:])[:, None], axis=0)
    assert z == pytest.approx(expected, rel=2e-3)


@law
def spring(turn: Turn, motion: Motion, p: NDArray, before: NDArray, after: NDArray) -> tuple[float, float]:
    return -p[0] * motion.x, -p[0] * motion.y - p[1] * motion.vy


def test_a_spring_as_a_force_law_moves_the_shaft_as_a_bearing_of_that_stiffness(jeffcott: RigConfig) -> None:
    damper = jeffcott.bearings[2]
    sprung = damper.model_copy(update={"kxx": 2e4, "kyy": 2e4, "cyy": damper.cyy + 10.0})
    rig = jeffcott.model_copy(update={"bearings": (*jeffcott.bearings[:2], sprung)})
    load = {"step": H, "unbalances": ((0.2, 20e-6, 0.0),), "watched": (0.2,)}
    as_bearing = ShaftMotion(build(rig, nameplate(rig)), **load)
    force = Force(on=at(0.2), law=spring, constants=(2e4, 10.0))
    as_law = ShaftMotion(build(jeffcott, nameplate(jeffcott)), forces=(force,), **load)
    a, b = (motion.run(*turning(300.0, 5000)) for motion in (as_bearing, as_law))
    assert np.abs(a - b).max() < 1e-4 * np.abs(a).max()


def test_a_force_too_stiff_for_the_step_is_refused_rather_than_wrong(jeffcott: RigConfig) -> None:
    """Iterating a spring k on mass m converges while (h / 2)^2 k / m < 1: here it is 25."""
    wall = Force(on=at(0.2), law=spring, constants=(1e10, 0.0))
    unbalance = ((0.2, 20e-6, 0.0),)
    motion = ShaftMotion(build(jeffcott, nameplate(jeffcott)), step=H, unbalances=unbalance, forces=(wall,))
    with pytest.raises(DataError, match="did not settle in 50 iterations of a 100 us step, want a softer fault"):
        motion.run(*turning(300.0, 100))


def test_a_rotor_begins_at_rest_under_its_weight_and_stays_there(rk4: RigConfig) -> None:
    rotor = build(rk4, nameplate(rk4))
    motion = ShaftMotion(rotor, step=H, gravity=(0.0, -9.81), watched=(0.2505,))
    sag = rotor.static_sag((0.0, -9.81))[rotor.n + rotor.station(0.2505)]
    seen = motion.run(*at_rest(2000))
    assert seen[:, 0, 1] == pytest.approx(sag, rel=1e-9)
    assert np.abs(seen[:, 0, 0]).max() < 1e-15
    assert math.isclose(sag, -167e-6, rel_tol=0.02)  # about 170 um: 8.3 N on the shaft's 50 kN/m
