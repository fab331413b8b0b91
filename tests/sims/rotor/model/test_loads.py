"""Forces, bow, planes and shaft damping against formulas of a massless or static shaft."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.errors import DataError
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble, with_bearing
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.modes import static_sag, whirl_modes
from rotorrig.sims.rotor.steady.harmonic_response import columns, probe_response, steady_response
from rotorrig.sims.rotor.swept.swept_response import Timeline, swept_response

E, MASS, DIAMETER, LENGTH = 2e11, 0.8, 0.01, 0.5


def rotor(*, shaft: dict | None = None, disk: dict | None = None, **more: object) -> RigConfig:
    """Return a disk halfway between two rigid bearings on a shaft almost without mass: Jeffcott's rotor."""
    return from_si(
        {
            "name": "jeffcott",
            "shaft": {
                "length": LENGTH,
                "diameter": DIAMETER,
                "density": 1e-3,
                "youngs_modulus": E,
                "poisson_ratio": 0.3,
            }
            | (shaft or {}),
            "disks": [
                {"name": "disk", "position": LENGTH / 2, "mass": MASS}
                | {"polar_inertia": 1e-4, "transverse_inertia": 6e-5}
                | (disk or {})
            ],
            "bearings": [{"name": name, "position": z, "rigid": True} for name, z in (("l", 0.0), ("r", LENGTH))],
            "probes": [
                {"name": name, "position": LENGTH / 2, "angle": angle, "channel": i}
                for i, (name, angle) in enumerate((("x", 0.0), ("y", math.pi / 2)))
            ],
        }
        | more
    )


def flexibility(pieces: list[tuple[float, float, float, float]]) -> float:
    """Return the midspan flexibility [m/N] of a symmetric simply supported beam by Castigliano's theorem.

    `pieces` are end [m], outer and inner diameter [m], modulus of one half from the support: P/2 x bends, P/2 shears.
    """
    start, total = 0.0, 0.0
    for end, outer, inner, modulus in pieces:
        EI = modulus * math.pi / 64 * (outer**4 - inner**4)
        m2 = (inner / outer) ** 2
        kappa = 6 * 1.3 * (1 + m2) ** 2 / (8.8 * (1 + m2) ** 2 + 23.6 * m2)  # Cowper, nu = 0.3
        kGA = kappa * modulus / 2.6 * math.pi / 4 * (outer**2 - inner**2)
        total += (end**3 - start**3) / (6 * EI) + (end - start) / (2 * kGA)
        start = end
    return total


K = 1 / flexibility([(LENGTH / 2, DIAMETER, 0.0, E)])
OMEGA = np.array([40.0, 150.0, 230.0, 320.0, 600.0])


def test_a_stepped_hollow_shaft_of_two_materials_bends_as_castigliano_says():
    left = [(0.1, 0.010, 0.0, E), (0.25, 0.014, 0.006, E)]
    right = [(0.1, 0.012, 0.0, E / 3), (0.25, 0.014, 0.006, E)]
    sections = [{"length": 0.1, "diameter": 0.010}, {"length": 0.3, "diameter": 0.014, "inner_diameter": 0.006}]
    sections.append({"length": 0.1, "diameter": 0.012, "youngs_modulus": E / 3})
    rig = rotor(shaft={"length": 0.5, "diameter": 0.014, "sections": sections})
    for model in (assemble(rig), assemble(rig, max_element=0.3)):
        x, y = probe_response(model, 0.0, force={"disk": (10.0, 5.0)}, order=0)[0].real
        assert x == pytest.approx(5 * (flexibility(left) + flexibility(right)), rel=1e-9)
        assert y == pytest.approx(x / 2)


def test_a_step_in_the_shaft_is_a_node_and_the_masses_are_the_sections():
    sections = [{"length": 0.123, "diameter": 0.01}, {"length": 0.377, "diameter": 0.02, "density": 2.0}]
    model = assemble(rotor(shaft={"length": 0.5, "diameter": 0.02, "sections": sections}))
    assert np.abs(model.z - 0.123).min() < 1e-12
    free = assemble(
        rotor(
            shaft={"length": 0.5, "diameter": 0.02, "sections": sections},
            bearings=[{"name": n, "position": z, "kxx": 1.0, "kyy": 1.0} for n, z in (("l", 0.0), ("r", LENGTH))],
        )
    )
    weight = free.weight[0].sum()
    assert weight == pytest.approx(math.pi / 4 * (1e-3 * 0.01**2 * 0.123 + 2 * 0.02**2 * 0.377))


def test_unbalance_and_force_move_jeffcotts_disk_as_the_formula_says():
    model = assemble(rotor())
    np.testing.assert_allclose(
        probe_response(model, OMEGA, force={"disk": (3.0, 1.0j)}),
        np.outer(1 / (K - MASS * OMEGA**2), [3.0, 1.0j]),
        rtol=1e-4,
    )
    want = OMEGA**2 * 1e-5j / (K - MASS * OMEGA**2)
    np.testing.assert_allclose(probe_response(model, OMEGA, unbalance={"disk": 1e-5j})[:, 0], want, rtol=1e-4)


@pytest.mark.parametrize("order", [2.0, -1.0, 0.5])
def test_a_force_of_another_order_is_felt_at_that_multiple_of_the_speed(order):
    got = probe_response(assemble(rotor()), OMEGA, force={"disk": (1.0, 0.0)}, order=order)[:, 0]
    np.testing.assert_allclose(got, 1 / (K - MASS * (order * OMEGA) ** 2), rtol=1e-4)


def test_order_0_is_the_static_deflection_whatever_the_speed(full):
    weight = 0.809 * 9.80665
    q = steady_response(full, [0.0, 300.0], force={"disk": (0.0, -weight)}, order=0)
    shaft_alone = static_sag(full, "-y") - (full.centreline @ q[0]).real
    np.testing.assert_array_equal(q[0], q[1])
    assert np.abs(probe_response(full, [200.0], unbalance={"disk": 1.0}, order=0)).max() == 0  # unbalance stands still
    assert -6e-5 < shaft_alone[1].min() < -1e-6  # what is left is the shaft's own 0.34 kg


def test_a_force_over_speed_is_taken_speed_by_speed():
    model = assemble(rotor())
    got = probe_response(model, OMEGA, force={"disk": (OMEGA, 0.0)})
    want = OMEGA[:, None] * probe_response(model, OMEGA, force={"disk": (1.0, 0.0)})
    np.testing.assert_allclose(got, want, rtol=1e-9, atol=1e-12)


def test_turning_backwards_is_the_conjugate_of_the_conjugate_force(full):
    force, mirror = {"spring": (1.0 + 2.0j, 0.5j)}, {"spring": (1.0 - 2.0j, -0.5j)}
    got = probe_response(full, OMEGA, force=force, order=-1.0)
    np.testing.assert_allclose(got, probe_response(full, OMEGA, force=mirror, order=1.0).conj(), rtol=1e-9)


def test_a_plane_is_a_disk_without_mass(rk4):
    place = {"name": "ring", "position": 0.333}
    table = rk4.model_dump() | {"planes": [place]}
    whole = assemble(from_si(table))
    table["disks"] += ({"mass": 1e-12, "polar_inertia": 1e-18, "transverse_inertia": 1e-18} | place,)
    want = probe_response(assemble(from_si(table | {"planes": []})), OMEGA, unbalance={"ring": 1e-5j})
    for model in (whole, reduce(whole)):
        got = probe_response(model, OMEGA, unbalance={"ring": 1e-5j})
        assert np.abs(got - want).max() < 1e-6 * np.abs(want).max()
    assert np.abs(whole.z - 0.333).min() < 1e-12


def test_jeffcotts_bow_grows_towards_resonance_and_dies_beyond_it():
    """b / (1 - (Omega / omega_n)^2): Friswell et al., Dynamics of Rotating Machines (2010), section 6.5."""
    model = assemble(rotor())
    got = probe_response(model, OMEGA, bow={"disk": 1e-5j})
    want = 1e-5j / (1 - MASS * OMEGA**2 / K)
    np.testing.assert_allclose(got, np.column_stack([want, -1j * want]), rtol=1e-4)
    backwards = probe_response(assemble(rotor(rotation="y-to-x")), OMEGA, bow={"disk": 1e-5j})
    np.testing.assert_allclose(backwards, np.column_stack([want, 1j * want]), rtol=1e-4)


def test_a_bowed_shaft_turned_slowly_shows_its_bow_and_loads_no_bearing(rk4, full):
    for model in (full, reduce(full)):
        q = steady_response(model, 0.0, bow={"disk": 1e-5})[0]
        assert np.abs(model.disk("disk").rows[0] @ q) == pytest.approx(1e-5, rel=1e-6)
        for bearing in model.bearings:
            assert np.abs(bearing.rows @ q).max() < 1e-11


def test_a_bow_at_a_bearing_is_refused(rk4):
    table = rk4.model_dump() | {"planes": [{"name": "journal", "position": 0.481}]}
    with pytest.raises(DataError, match="bow at 'journal': a bearing holds the shaft there"):
        probe_response(assemble(from_si(table)), 100.0, bow={"journal": 1e-5})
    rigid = rotor(planes=[{"name": "journal", "position": LENGTH}])
    with pytest.raises(DataError, match="bow at 'journal': a bearing holds the shaft there"):
        probe_response(assemble(rigid), 100.0, bow={"journal": 1e-5})


def test_columns_are_the_derivatives_by_every_linear_parameter(full, rng):
    omega = np.linspace(60, 400, 20)
    amounts = rng.normal(size=4) + 1j * rng.normal(size=4)
    got = columns(full, omega, unbalance=["disk"], bow=["disk"], force=["spring"])
    u, b, fx, fy = amounts
    want = probe_response(full, omega, unbalance={"disk": u}, bow={"disk": b}, force={"spring": (fx, fy)})
    np.testing.assert_allclose(got @ amounts, want, rtol=1e-9)
    assert columns(full, omega).shape == (20, 4, 0)
    turned = columns(full, omega, unbalance=["disk"], order=2.0, alpha=50.0)[..., 0]
    np.testing.assert_allclose(turned, probe_response(full, omega, unbalance={"disk": 1}, order=2.0, alpha=50.0))


def test_structural_damping_takes_the_same_part_at_every_frequency_and_changes_sign_with_it():
    eta = 0.05
    model = assemble(rotor(shaft={"structural_damping": eta}))
    for order in (1.0, 3.0, -1.0):
        got = probe_response(model, OMEGA, force={"disk": (1.0, 0.0)}, order=order)[:, 0]
        want = 1 / (K * (1 + 1j * eta * np.sign(order)) - MASS * (order * OMEGA) ** 2)
        np.testing.assert_allclose(got, want, rtol=1e-4)
    still = probe_response(model, OMEGA, force={"disk": (1.0, 0.0)}, order=0)[:, 0]
    np.testing.assert_allclose(still, 1 / K, rtol=1e-4)


def test_a_loss_factor_is_twice_the_damping_ratio_of_a_lightly_damped_mode():
    model = reduce(assemble(rotor(shaft={"structural_damping": 0.01})))
    for mode in whirl_modes(model, 0.0, count=2):
        assert mode.damping_ratio == pytest.approx(0.005, rel=1e-4)


def test_rayleigh_damping_gives_every_mode_the_damping_ratio_of_the_formula():
    """zeta = alpha / (2 omega) + beta omega / 2 (Clough, Penzien, Dynamics of Structures, section 12-5)."""
    alpha, beta = 0.4, 2e-7
    disk = {"mass": 1e-9, "polar_inertia": 1e-15, "transverse_inertia": 1e-15}
    rig = rotor(shaft={"density": 7800.0, "rayleigh": {"mass": alpha, "stiffness": beta}}, disk=disk)
    for model in (assemble(rig), reduce(assemble(rig))):
        for mode in whirl_modes(model, 0.0, count=6):
            natural = abs(mode.eigenvalue)
            assert mode.damping_ratio == pytest.approx(alpha / (2 * natural) + beta * natural / 2, rel=1e-5)


def test_a_slow_sweep_of_a_shaft_with_structural_damping_is_its_steady_response(rk4):
    shaft = rk4.shaft.model_copy(update={"structural_damping": 0.04})
    model = reduce(assemble(rk4.model_copy(update={"shaft": shaft})))
    timeline = Timeline(np.arange(400) * 2 * np.pi / 232.0)  # constant speed, close to resonance
    got = swept_response(model, timeline, t=[5.0], revolutions=8.0, window="hann", unbalance={"disk": 1e-5})
    want = probe_response(model, 232.0, unbalance={"disk": 1e-5})
    undamped = probe_response(reduce(assemble(rk4)), 232.0, unbalance={"disk": 1e-5})
    np.testing.assert_allclose(got, want, rtol=1e-5)
    assert np.abs(want - undamped).max() > 0.02 * np.abs(want).max()


def bisected(model: RotorModel, low: float, high: float) -> float:
    """Home in on the resonance between two speeds, across which an undamped response changes its sign."""
    for _ in range(100):
        middle = (low + high) / 2
        (x,) = probe_response(model, [middle], unbalance={"disk": 1e-5})[:, 0]
        low, high = (middle, high) if x.real > 0 else (low, middle)
    return low


def test_a_speed_on_a_resonance_without_damping_is_an_error_and_one_beside_it_has_an_answer():
    critical = math.sqrt(K / MASS)
    for size in (0.02, 0.3):
        model = assemble(rotor(), max_element=size)
        beside = probe_response(model, [critical * 0.99], unbalance={"disk": 1e-5})
        assert np.abs(beside).max() == pytest.approx(1e-5 / MASS / 0.0203, rel=0.01)  # U / m over 1 / 0.99^2 - 1
        with pytest.raises(DataError, match=r"rpm is on a resonance without damping \(order 1\)"):
            bisected(model, critical * 0.99, critical * 1.01)
    damped = assemble(rotor(shaft={"structural_damping": 1e-3}))
    assert np.abs(probe_response(damped, [critical], unbalance={"disk": 1e-5})).max() < 0.02


def test_a_shaft_that_is_not_held_has_no_static_response(full):
    loose = with_bearing(full, [b.name for b in full.bearings], np.zeros((2, 2)), np.zeros((2, 2)))
    with pytest.raises(DataError, match="do not hold the rotor, so a load has no response"):
        probe_response(loose, 0.0, force={"disk": (1.0, 0.0)}, order=0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda m: probe_response(m, 1.0, force={"disc": (1, 0)}), "force: 0 parts are named 'disc', want exactly one"),
        (lambda m: probe_response(m, np.nan, unbalance={"disk": 1.0}), "omega holds NaN or infinity"),
        (lambda m: probe_response(m, 1.0, bow={"disc": 1.0}), r"no disk 'disc', want one of \['disk'\]"),
    ],
)
def test_a_wrong_argument_is_named(full, call, message):
    with pytest.raises(ValueError, match=message):
        call(full)
