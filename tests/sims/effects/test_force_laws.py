"""Force laws on motions whose first harmonic the textbooks give in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.effects.base import Effect, catalogue, find
from rotorrig.sims.rotor.model.assembly import RotorModel, assemble
from rotorrig.sims.rotor.model.loads import Load
from rotorrig.sims.rotor.nonlinear.force_law import ForceLaw
from tests.sims.effects.predicted import Complex, base_load, motion, pair_at, simple_rig

OMEGA = 230.0  # rad/s
TURN = 2 * np.pi * np.arange(720) / 720


def law_of(effect: Effect, model: RotorModel, **theta: float) -> ForceLaw:
    (law,) = effect.force_laws(model, {**effect.at_zero, **theta})
    return law


def first_harmonic(law: ForceLaw, X: complex, Y: complex, omega: float = OMEGA) -> tuple[complex, complex]:
    """The phasors of the force on the motion Re(X e^{j theta}), Re(Y e^{j theta}) about the origin."""
    turning = np.exp(1j * TURN)
    x, y, vx, vy = (np.real(p * turning) for p in (X, Y, 1j * omega * X, 1j * omega * Y))
    force = np.array([law.force(*at, law.constants) for at in zip(x, y, vx, vy, strict=True)])
    fx, fy = 2 * np.mean(force * np.conj(turning)[:, None], axis=0)
    return complex(fx), complex(fy)


def test_a_cubic_spring_on_a_circle_is_a_stiffness_of_k3_r2(rk4: RigConfig, small: RotorModel) -> None:
    law, R = law_of(find(rk4, "cubic_spring"), small, k3=5e10), 2e-4
    fx, fy = first_harmonic(law, R, -1j * R)
    assert (fx, fy) == pytest.approx((-5e10 * R**3, 1j * 5e10 * R**3), rel=1e-9)


def test_a_cubic_spring_on_an_ellipse_follows_harmonic_balance(rk4: RigConfig, small: RotorModel) -> None:
    law, X, Y = law_of(find(rk4, "cubic_spring"), small, k3=5e10), 2e-4 + 1e-4j, 1e-4 - 5e-5j
    balance = 3 / 4 * abs(X) ** 2 * X + 1 / 2 * abs(Y) ** 2 * X + 1 / 4 * Y**2 * np.conj(X)  # Yamamoto, Ishida, ch. 6
    assert first_harmonic(law, X, Y)[0] == pytest.approx(-5e10 * balance, rel=1e-9)


def test_dry_friction_on_a_line_is_a_damping_of_four_over_pi(rk4: RigConfig, small: RotorModel) -> None:
    X = 1e-3  # far beyond creep
    fx, fy = first_harmonic(law_of(find(rk4, "friction"), small, force=0.1), X, 0)
    assert fx == pytest.approx(-1j * 4 / np.pi * 0.1, rel=2e-3)
    assert fy == 0


def test_dry_friction_on_a_circle_is_all_of_it_against_the_motion(rk4: RigConfig, small: RotorModel) -> None:
    fx, fy = first_harmonic(law_of(find(rk4, "friction"), small, force=0.1, give=0.0), 1e-3, -1e-3j)
    assert (fx, fy) == pytest.approx((-0.1j, -0.1), rel=2e-5)


def test_a_contact_dragged_in_a_circle_trails_by_the_angle_whose_sine_is_give_over_radius(
    rk4: RigConfig, small: RotorModel
) -> None:
    law, R, give = law_of(find(rk4, "friction"), small, force=0.1, give=1e-6, creep=1e-5), 2e-6, 1e-6
    fx, fy = first_harmonic(law, R, -1j * R)
    # the slider's circle is touched by the stretched spring: R^2 = slider^2 + give^2
    want = -0.1 * (give / R + 1j * np.sqrt(1 - (give / R) ** 2))
    assert (fx, fy) == pytest.approx((want, -1j * want), rel=2e-3)  # creep / (Omega R) = 0.02, squared and so on


def test_a_contact_moved_less_than_it_gives_is_a_spring(rk4: RigConfig, small: RotorModel) -> None:
    law, R = law_of(find(rk4, "friction"), small, force=0.1, give=1e-6, creep=1e-5), 0.5e-6
    fx, fy = first_harmonic(law, R, -1j * R)
    assert (fx.real, fy.imag) == pytest.approx((-0.1e6 * R, 0.1e6 * R), rel=1e-2)
    assert abs(fx.imag) < 0.1 * abs(fx.real)


def test_a_shaken_contact_moved_slowly_is_a_dashpot(rk4: RigConfig, small: RotorModel) -> None:
    law, R = law_of(find(rk4, "friction"), small, force=0.1, give=0.0, creep=1e-3), 1e-8
    fx, _ = first_harmonic(law, R, -1j * R)
    assert fx == pytest.approx(-1j * 0.1 * OMEGA * R / 1e-3, rel=1e-5)


def test_drag_on_a_line_is_a_damping_of_eight_over_three_pi(rk4: RigConfig, small: RotorModel) -> None:
    X = 3e-4
    fx, _ = first_harmonic(law_of(find(rk4, "drag"), small, c2=20.0), X, 0)
    assert fx == pytest.approx(-1j * 20.0 * 8 / (3 * np.pi) * (OMEGA * X) ** 2, rel=1e-4)


def test_a_bearing_with_clearance_pushes_only_beyond_it(rk4: RigConfig, small: RotorModel) -> None:
    effect, k = find(rk4, "clearance"), np.diag([33.9e3, 34.6e3])
    law = law_of(effect, small, gap=20e-6)
    inside, outside = np.array([12e-6, -9e-6]), np.array([30e-6, 40e-6])
    assert -k @ inside + law.force(*inside, 0, 0, law.constants) == pytest.approx([0, 0], abs=1e-9)
    beyond = -k @ outside * (1 - 20 / 50)
    assert -k @ outside + law.force(*outside, 0, 0, law.constants) == pytest.approx(beyond, rel=1e-12)


def test_a_journal_with_clearance_lies_at_its_bottom() -> None:
    rig = simple_rig(pair_at(0.15), k=40e3)
    law = law_of(find(rig, "clearance, bearing A"), assemble(rig), gap=20e-6)
    shaft = 7800.0 * np.pi * 0.005**2 * 0.4
    assert law.static == pytest.approx([0, -(0.8 + shaft) * 9.80665 / 2 / 40e3], rel=1e-9)
    where = law.static - [0, 20e-6]  # where spring and weight balance
    assert -40e3 * where + law.force(*where, 0, 0, law.constants) == pytest.approx(-40e3 * law.static, rel=1e-9)


def test_a_wall_is_not_felt_within_its_gap_and_drags_backwards_beyond(rk4: RigConfig, small: RotorModel) -> None:
    law = law_of(find(rk4, "rub, at disk"), small, gap=3e-4, stiffness=1e6, friction=0.2)
    assert law.force(2e-4, -2e-4, 0.0, 0.0, law.constants) == (0.0, 0.0)
    assert law.force(3.5e-4, 0.0, 0.0, 0.0, law.constants) == pytest.approx((-50.0, -10.0), rel=2e-3)


def test_a_wall_drags_the_other_way_when_the_rotor_turns_the_other_way() -> None:
    rig = simple_rig(pair_at(0.15), rotation="y-to-x")
    law = law_of(find(rig, "rub, at disk"), assemble(rig), gap=3e-4, stiffness=1e6, friction=0.2)
    assert law.force(3.5e-4, 0.0, 0.0, 0.0, law.constants) == pytest.approx((-50.0, 10.0), rel=2e-3)


def test_a_rotor_that_rolls_backwards_on_the_wall_is_not_dragged(rk4: RigConfig, small: RotorModel) -> None:
    law = law_of(find(rk4, "rub, at disk"), small, gap=3e-4, stiffness=1e6, friction=0.2)
    surface = 4200 * np.pi / 30 / 2 * 0.005  # half the drive's highest speed, 10 mm shaft
    assert law.force(3.5e-4, 0.0, 0.0, -surface, law.constants) == pytest.approx((-50.0, 0.0), abs=1e-9)


def test_halfway_between_the_bearings_is_a_place_to_rub_if_no_disk_is_there(rk4: RigConfig) -> None:
    assert [e.label for e in catalogue(rk4) if e.name == "rub"] == ["rub, at disk"]
    disk = rk4.disks[0].model_copy(update={"position": 0.2})
    (_, middle) = (e for e in catalogue(rk4.model_copy(update={"disks": (disk,)})) if e.name == "rub")
    assert (middle.label, middle.places) == ("rub, at mid-span", {"mid-span": pytest.approx(0.2805)})
    table = rk4.model_dump(mode="json", exclude_unset=True)
    with_plane = assemble(from_si({**table, "planes": [{"name": "mid-span", "position": 0.2805}]}))
    assert middle.force_laws(with_plane, middle.at_zero)[0].rows == pytest.approx(with_plane.disk("disk").rows[:2])


@pytest.mark.parametrize("label", ["cubic_spring", "friction", "clearance"])
def test_bearings_of_one_group_have_a_law_each(label: str, rk4: RigConfig) -> None:
    identify = rk4.identify.model_copy(update={"bearings": (("left A", "left B"),)})
    rig = rk4.model_copy(update={"identify": identify})
    effect = find(rig, label)
    model = assemble(rig)
    laws = effect.force_laws(model, effect.at_zero)
    assert [law.rows.tolist() for law in laws] == [model.bearing(n).rows.tolist() for n in ("left A", "left B")]
    assert "bearings left A and left B" in effect.words({p.name: p.size for p in effect.parameters})


@pytest.mark.parametrize("turns_per_second", [14.0, 20.0, 65.0])
def test_a_stiff_rotor_that_tilts_on_a_cubic_spring_follows_the_closed_form(turns_per_second: float) -> None:
    k, c, k3, U, length = 5e3, 15.0, 2e10, 1e-4, 0.4
    stiff = {"length": length, "diameter": 0.02, "density": 1.0, "youngs_modulus": 1e13}
    point = {"name": "disk", "position": length / 2, "mass": 0.8, "polar_inertia": 0.0, "transverse_inertia": 0.0}
    spring = {"name": "B", "position": length, "kxx": k, "kyy": k, "cxx": c, "cyy": c}
    bearings = [{"name": "A", "position": 0.0, "rigid": True}, spring]
    rig = simple_rig(pair_at(length), shaft=stiff, disks=[point], bearings=bearings)
    model, omega = assemble(rig, max_element=0.1), 2 * np.pi * turns_per_second
    (law,) = find(rig, "cubic_spring").force_laws(model, {"k3": k3})
    z = balanced(model, law, base_load(model, U), omega)
    R, mass = abs(z[0]), 0.8 / 4 + np.pi * 0.01**2 * length / 3  # as felt at B, turning about A
    # (k + k3 R^2 - m Omega^2 + j c Omega) r = U Omega^2 / 2 on the circle |r| = R (Yamamoto, Ishida, ch. 6)
    want = U / 2 * omega**2 / (k + k3 * R**2 - mass * omega**2 + 1j * c * omega)
    assert z == pytest.approx([want, -1j * want], rel=2e-3)
    assert k3 * R**2 > 0.02 * k


def balanced(model: RotorModel, law: ForceLaw, load: Load, omega: float) -> Complex:
    """The probes' vectors when the force's first harmonic is in balance with the motion it belongs to."""
    at_place, speed = replace(model, probes=law.rows), np.array([omega])

    def loads(force: np.ndarray) -> tuple[Load, ...]:
        return (load, Load(law.rows.T @ force.view(complex), "constant"))

    def unbalanced(force: np.ndarray) -> np.ndarray:
        X, Y = motion(at_place, loads(force), 1, speed)[0]
        return np.array(first_harmonic(law, X, Y, omega)).view(float) - force

    found = optimize.root(unbalanced, np.zeros(4))
    assert found.success
    return motion(model, loads(found.x), 1, speed)[0]
