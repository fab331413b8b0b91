"""Other matrices, against bearings given so and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import Effect, catalogue, find
from rotorrig.sims.effects.shaft_motion import pairwise_map
from rotorrig.sims.rotor.model.assembly import (
    RotorModel,
    assemble,
    hysteretic,
    matrices,
    speed_stiffness,
    with_bearing,
)
from tests.sims.effects.predicted import OMEGA, Complex, base_load, motion, pair_at, simple_rig

SPRING, NAMES = 40e3, ("A", "B")


@pytest.fixture(params=["x-to-y", "y-to-x"])
def rig(request: pytest.FixtureRequest) -> RigConfig:
    return simple_rig(pair_at(0.15), k=SPRING, rotation=request.param)


def sought(rig: RigConfig, name: str) -> Effect:
    """The effect of that name at bearing A."""
    return find(rig, f"{name}, bearing A")


def unbalance_response(model: RotorModel, omega: float) -> Complex:
    return motion(model, (base_load(model),), 1, np.array([omega]))[0]


def test_turned_axes_are_stiffest_between_x_and_y(rig: RigConfig) -> None:
    model = assemble(rig)
    added = matrices(sought(rig, "cross_stiffness").change_matrices(model, {"k": 3e3})).K - matrices(model).K
    rows = model.bearing("A").rows
    assert rows @ added @ rows.T == pytest.approx(np.array([[0, 3e3], [3e3, 0]]), abs=1e-6)
    assert np.linalg.matrix_rank(added, tol=1.0) == 2


@pytest.mark.parametrize("omega", OMEGA[:-1])
def test_skew_stiffness_is_negative_damping_of_a_forward_orbit(rig: RigConfig, omega: float) -> None:
    model = assemble(rig)
    skewed = unbalance_response(sought(rig, "skew_stiffness").change_matrices(model, {"k": 400.0}), omega)
    c = 10.0 - 400.0 / omega
    damped = replace_damping(model, "A", c)
    assert skewed == pytest.approx(unbalance_response(damped, omega), rel=1e-9)


def replace_damping(model: RotorModel, name: str, c: float) -> RotorModel:
    """The model with a bearing of another damping, below zero too."""
    other = (replace(b, damping=c * np.eye(2)[None]) if b.name == name else b for b in model.bearings)
    return replace(model, bearings=tuple(other))


def test_a_forward_circular_orbit_does_not_feel_internal_damping(rig: RigConfig) -> None:
    model = assemble(rig)
    damped = find(rig, "internal_damping").change_matrices(model, {"beta": 1e-4, "exponent": 0.5})
    for omega in OMEGA:
        assert unbalance_response(damped, omega) == pytest.approx(unbalance_response(model, omega), rel=1e-6)


@pytest.mark.parametrize("exponent", [0.3, 0.5, 1.0, 1.1])
def test_a_backward_whirl_bends_the_shaft_by_a_power_of_twice_the_speed(rig: RigConfig, exponent: float) -> None:
    model, middle = assemble(rig), 2000.0 * np.pi / 30  # rad/s, where no drive says how fast it turns
    damped = find(rig, "internal_damping").change_matrices(model, {"beta": 1e-4, "exponent": exponent})
    for omega in (0.4 * middle, middle, 1.7 * middle):
        change = dynamic_stiffness(damped, omega) - dynamic_stiffness(model, omega)
        lags = 1e-4 * 2 * middle * (1j * omega / middle) ** exponent
        for x, y in zip(*model.centreline, strict=True):  # pushed there, the shaft bends as a whole
            backward = np.linalg.solve(model.shaft.K + 1e5 * model.shaft.M, x + 1j * model.rotation * y)
            bending = float((backward.conj() @ model.shaft.K @ backward).real)
            assert backward.conj() @ change @ backward == pytest.approx(lags * bending, rel=0.01)
            assert abs(backward @ change @ backward.conj()) < 1e-4 * abs(lags) * bending, "a forward one is at rest"


def dynamic_stiffness(model: RotorModel, omega: float) -> Complex:
    """Z of a motion at 1X."""
    M, C, G, K = matrices(model, omega)
    H, S = speed_stiffness(model)
    return K + 1j * hysteretic(model) + omega * H + omega**2 * (S - M) + 1j * omega * (C + omega * G)


def test_an_orbit_that_is_not_circular_feels_internal_damping() -> None:
    rig = simple_rig(pair_at(0.15))
    model = with_bearing(assemble(rig), "A", np.diag([20e3, 60e3]), np.zeros((2, 2)))
    damped = find(rig, "internal_damping").change_matrices(model, {"beta": 1e-4})
    assert abs(unbalance_response(damped, 200.0) - unbalance_response(model, 200.0)).max() > 1e-7


def test_internal_damping_drives_the_rotor_unstable_where_theory_says() -> None:
    outer, beta = 4.0, 1e-4  # 1/s of C = outer M; s
    shaft = {"length": 0.4, "diameter": 0.01, "density": 7800.0, "youngs_modulus": 210e9, "rayleigh": {"mass": outer}}
    pinned = [{"name": name, "position": z, "rigid": True} for name, z in (("A", 0.0), ("B", 0.4))]
    light = [{"name": "d", "position": 0.2, "mass": 1e-9, "polar_inertia": 0.0, "transverse_inertia": 0.0}]
    rig = simple_rig(pair_at(0.1), shaft=shaft, bearings=pinned, disks=light)
    model = find(rig, "internal_damping").change_matrices(assemble(rig, element="lumped"), {"beta": beta})
    model = replace(model, shaft=model.shaft._replace(G=0 * model.shaft.G))  # the theory has none
    critical = np.sqrt(np.min(linalg.eigvals(model.shaft.K, model.shaft.M + 1e-12 * np.eye(model.dof)).real))
    threshold = critical * (1 + (outer / critical) / (beta * critical))  # 1 + zeta_outer / zeta_inner; Genta, eq. 2.52
    assert growth(model, 0.999 * threshold) < 0 < growth(model, 1.001 * threshold)


def growth(model: RotorModel, omega: float) -> float:
    """The largest real part of an eigenvalue."""
    M, C, G, K = matrices(model, omega)
    H, S = speed_stiffness(model)
    n, inverse = model.dof, np.linalg.inv(M)
    A = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-inverse @ (K + omega * H + omega**2 * S), -inverse @ (C + omega * G)]]
    )
    return float(np.linalg.eigvals(A).real.max())


@pytest.mark.parametrize("which", ["full", "small"])
def test_a_map_of_the_shafts_planes_is_known_without_its_coordinates(
    which: str, request: pytest.FixtureRequest
) -> None:
    model: RotorModel = request.getfixturevalue(which)
    x, y = model.centreline
    J = pairwise_map(model, ((0, 1), (-1, 0)))
    assert np.abs(x @ J - y).max() < 4e-4 * np.abs(y).max()
    assert np.abs(y @ J + x).max() < 4e-4 * np.abs(x).max()


def test_disk_inertia_is_that_of_a_rig_given_so(rig: RigConfig) -> None:
    changed = find(rig, "disk_inertia").change_matrices(assemble(rig), {"polar": 0.2, "transverse": -0.1})
    disk = rig.disks[0].model_copy(update={"polar_inertia": 6e-4, "transverse_inertia": 2.7e-4})
    for got, want in zip(matrices(changed), matrices(assemble(rig.model_copy(update={"disks": (disk,)}))), strict=True):
        assert got == pytest.approx(want, rel=1e-12, abs=1e-18)


def test_stiffness_grows_with_the_square_of_the_speed(rig: RigConfig) -> None:
    model, effect = assemble(rig), sought(rig, "stiffness_over_speed")
    changed = effect.change_matrices(model, {"growth": 0.1})
    for omega, k in ((effect.reference, 1.1 * SPRING), (effect.reference / 2, 1.025 * SPRING)):
        given = with_bearing(model, "A", k * np.eye(2), 10.0 * np.eye(2))
        assert unbalance_response(changed, omega) == pytest.approx(unbalance_response(given, omega), rel=1e-9)


@pytest.mark.parametrize(("share", "error"), [(0.7, 2e-4), (1.0, 1e-9), (1.4, 2e-4)])
def test_hysteretic_damping_is_viscous_damping_over_the_frequency(rig: RigConfig, share: float, error: float) -> None:
    model, effect = assemble(rig), sought(rig, "hysteresis")
    omega, eta = share * effect.reference, 0.02
    k = SPRING * (1 + 2 * eta / np.pi * np.log(share))
    given = with_bearing(model, "A", k * np.eye(2), (10.0 + eta * SPRING / omega) * np.eye(2))
    changed = effect.change_matrices(model, {"eta": eta})
    assert unbalance_response(changed, omega) == pytest.approx(unbalance_response(given, omega), rel=error)


def test_a_loss_factor_makes_a_bearing_stiffer_with_frequency_as_causality_asks(rig: RigConfig) -> None:
    """Of rubber as springs in series with dashpots, relaxation times a factor 1.1 apart from 1 us to 1000 s."""
    effect = sought(rig, "hysteresis")
    tau = 1.1 ** np.arange(-145, 73)
    omega = effect.reference * np.array([0.7, 1.0, 1.4])
    chain = np.sum(1j * omega[:, None] * tau / (1 + 1j * omega[:, None] * tau), axis=1)
    stiffness, eta = 1 + 0.02 * (chain.real - chain[1].real) / chain[1].imag, 0.02
    plain = np.zeros((assemble(rig).dof,) * 2)
    for got, w in zip(stiffness, omega, strict=True):
        K, H, S = (plain if A is None else A for A in effect.change_matrices(assemble(rig), {"eta": eta}).added[3:6])
        grown = (K.real + w * H + w**2 * S)[np.abs(K.imag) > 0] / K.imag[np.abs(K.imag) > 0] * eta
        assert grown == pytest.approx(got - 1, abs=0.02 * eta)


def test_softer_bearings_are_as_given_so(rk4: RigConfig) -> None:
    model = assemble(rk4)
    changed = find(rk4, "soft_left_bearing").change_matrices(model, {"softness": 3.0})
    given = with_bearing(model, ["left A", "left B"], 0.5e6 * np.eye(2), np.zeros((2, 2)))
    got, want = matrices(changed).K, matrices(given).K
    assert got == pytest.approx(want, rel=1e-12, abs=1e-6)


def test_rigid_bearings_cannot_give_way(rk4: RigConfig) -> None:
    left = tuple(type(b)(name=b.name, position="65 mm", rigid=True) for b in rk4.bearings[:1])
    rig = rk4.model_copy(update={"bearings": (*left, rk4.bearings[-1])})
    assert "soft_left_bearing" not in {e.name for e in catalogue(rig)}


MASS, FREQUENCY, DAMPING = 6.0, 2 * np.pi * 25, 0.04
PEDESTAL = {"lightness": 1 / MASS, "omega": FREQUENCY, "damping ratio": DAMPING}


@pytest.mark.parametrize("omega", [1.0, 100.0, FREQUENCY, 400.0])
@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("across", [0.0, 0.37])
def test_a_pedestal_is_in_series_with_its_bearing(rig: RigConfig, axis: int, omega: float, across: float) -> None:
    model = assemble(rig)
    theta = PEDESTAL | {"compliance across": across}
    changed = find(rig, f"pedestal, bearing A, {'xy'[axis]}").change_matrices(model, theta)
    spring = SPRING + 10.0j * omega
    k, c = (np.diag([SPRING, SPRING]), np.diag([10.0, 10.0]))
    supports = {axis: (MASS, MASS * FREQUENCY**2)}
    if across:
        supports[1 - axis] = MASS, MASS * FREQUENCY**2 / across
    for i, (mass, own) in supports.items():
        ground = own - mass * omega**2 + 2j * DAMPING * np.sqrt(own * mass) * omega
        both = 1 / (1 / spring + 1 / ground)
        k[i, i], c[i, i] = both.real, both.imag / omega
    bearings = (replace(b, stiffness=k[None], damping=c[None]) if b.name == "A" else b for b in model.bearings)
    given = replace(model, bearings=tuple(bearings))
    assert unbalance_response(changed, omega) == pytest.approx(unbalance_response(given, omega), rel=1e-8)


def test_far_above_its_resonance_a_pedestal_stands_still(rig: RigConfig) -> None:
    model = assemble(rig)
    heavy = {"lightness": 1 / 40.0, "omega": 2 * np.pi * 8, "damping ratio": 0.02}
    changed = find(rig, "pedestal, bearing A, x").change_matrices(model, heavy)
    assert unbalance_response(changed, 2000.0) == pytest.approx(unbalance_response(model, 2000.0), rel=1e-3)
