"""What only the rotor's weight brings out: an asymmetric shaft and a crack."""

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.effects.crack import Crack
from rotorrig.sims.rotor.model.assembly import assemble, matrices
from tests.sims.effects.predicted import Complex, pair_at, predicted, simple_rig

LIGHT = {"length": 0.4, "diameter": 0.01, "density": 1e-3, "youngs_modulus": 210e9}
POINT = {"name": "disk", "position": 0.2, "mass": 0.8, "polar_inertia": 0.0, "transverse_inertia": 0.0}
PINNED = [{"name": name, "position": z, "rigid": True} for name, z in (("A", 0.0), ("B", 0.4))]
G = 9.80665  # m/s^2
EI = 210e9 * np.pi * 0.01**4 / 64
K = 48 * EI / 0.4**3
CRITICAL = np.sqrt(K / 0.8)
SAG = 0.8 * G / K
SHEAR = 3e-3  # of the bending of a shaft this slender


def pinned(z: float, **changes: object) -> RigConfig:
    """A point mass in the middle of a pinned shaft without mass, probes at z."""
    return simple_rig(pair_at(z), shaft=LIGHT, disks=[POINT], bearings=PINNED, **changes)


def vectors(rig: RigConfig, label: str, order: int, omega: float, **theta: float) -> Complex:
    effect = find(rig, label)
    whole = {**effect.at_zero, **theta}
    return predicted(effect, whole, rig=rig, model=assemble(rig), base=False, omega=np.array([omega]))[order][0]


@pytest.mark.parametrize("ratio", [0.01, 0.3, 0.45, 0.8])
def test_an_asymmetric_shaft_moves_its_sag_twice_per_turn(ratio: float) -> None:
    rig = pinned(0.2)
    delta = 0.01 * np.exp(0.6j)
    z = vectors(rig, "shaft_asymmetry", 2, ratio * CRITICAL, **{"asymmetry re": delta.real, "asymmetry im": delta.imag})
    # Z r_2 = -delta K r_s*, r_s = -j sag; Z = K - 4 m Omega^2 (Yamamoto, Ishida, ch. 5)
    forward = -delta * 1j * SAG / (1 - 4 * ratio**2)
    assert z == pytest.approx([forward, -1j * forward], rel=SHEAR * 5)


def test_turned_by_hand_the_shaft_hangs_lowest_with_its_soft_side_down() -> None:
    rig = pinned(0.2)
    z = vectors(rig, "shaft_asymmetry", 2, 0.0, **{"asymmetry re": 0.01, "asymmetry im": 0.0})
    down = [-(z * np.exp(2j * theta)).real[1] for theta in np.radians([0, 90, 180, 270])]
    # stiffest along the mark: with it level, at 0 and 180 deg, the soft side is down
    assert down == pytest.approx(np.array([1, -1, 1, -1]) * 0.01 * SAG, rel=SHEAR * 3)


def test_a_crack_bends_the_shaft_like_a_hinge() -> None:
    at, compliance = 0.12, 1e-5
    kink = compliance * 0.8 * G / 2 * at  # of the weight's moment there
    # its mouth down at the mark: open while cos(theta) > 0, it bends by cos^2 down and by cos sin aside, where it goes
    down, aside = (4 / (3 * np.pi), 1 / 4, 4 / (15 * np.pi)), (2 / (3 * np.pi), 1 / 4, 2 / (5 * np.pi))
    for z in (0.06, 0.25):
        triangle = kink * min(z, at) * (0.4 - max(z, at)) / 0.4
        for order in (1, 2, 3):
            seen = cracked(pinned(z), at, 270, order, 0.0, compliance)
            want = [-1j * aside[order - 1] * triangle, -down[order - 1] * triangle]
            assert seen == pytest.approx(want, rel=0.02, abs=1e-4 * triangle)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_crack_resonates_at_a_fraction_of_the_critical_speed(order: int) -> None:
    rig = pinned(0.2)
    near, off = (abs(cracked(rig, 0.12, 90, order, ratio * CRITICAL / order, 1e-7)[1]) for ratio in (0.995, 0.5))
    assert near > 50 * off


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_crack_in_a_shaft_that_turns_the_other_way_is_its_mirror_image(order: int) -> None:
    forward, backward = (
        cracked(pinned(0.25, rotation=rotation), 0.12, mouth + 11.0, order, 100.0, 1e-5)
        for rotation, mouth in (("x-to-y", 45), ("y-to-x", 225))
    )
    assert backward == pytest.approx(forward * [-1, 1], rel=1e-6)


def test_a_crack_makes_the_shaft_softer_by_a_quarter_of_what_it_gives_way_by() -> None:
    rig, compliance = pinned(0.2), 1e-5
    effect, theta = crack(rig, 0.12, 0, compliance)
    model = assemble(rig)
    push = model.disks[0].rows[1]
    before, after = (push @ np.linalg.solve(matrices(m).K, push) for m in (model, effect.change_matrices(model, theta)))
    # a force F in the middle bends by F z / 2 there, and a kink lowers the middle by z / 2 of it
    assert after - before == pytest.approx(0.25 * compliance * 0.06**2, rel=0.02)


def test_a_shaft_bent_in_its_own_axes_by_more_than_the_weight_keeps_a_crack_shut_or_open() -> None:
    effect, theta = crack(pinned(0.2), 0.12, 0, 1e-5)
    model = assemble(pinned(0.2))
    (law,) = effect.force_laws(model, theta)
    constants = law.constants.copy()
    for angle in np.linspace(0.0, 6.0, 7):
        constants[-2:] = np.cos(angle), np.sin(angle)
        mouth = constants[-2:]
        added = [
            np.array(law.force(*(law.static + m * mouth), 0.0, 0.0, constants)) for m in (50.0, 100.0, -50.0, -100.0)
        ]
        # pressed by that much more it gives way no more: what is left is the average softness; stretched, all of it
        assert (added[1] - added[0]) @ mouth == pytest.approx(-0.25 * 1e-5 * 50.0 / constants[1] ** 2, rel=1e-6)
        assert (added[3] - added[2]) @ mouth == pytest.approx(-0.75 * 1e-5 * 50.0 / constants[1] ** 2, rel=1e-6)


def test_the_softness_of_a_crack_is_the_part_by_which_the_disk_sinks_more_while_it_is_open() -> None:
    rig, compliance = pinned(0.2), 1e-5
    effect, theta = crack(rig, 0.12, 0, compliance)
    moment = 0.8 * G / 2 * 0.12
    # where the disk's is the only weight its work is W sag, and an open hinge lets it sink by moment^2 c / W
    assert theta["softness"] == pytest.approx(compliance * moment**2 / (0.8 * G * SAG), rel=5 * SHEAR)
    assert effect.compliance(theta) == pytest.approx(compliance, rel=1e-12)


def cracked(rig: RigConfig, at: float, mouth: float, order: int, omega: float, compliance: float) -> Complex:
    """The vectors of a crack [m from the left, deg from the mark, rad/(N m)]."""
    _, theta = crack(rig, at, mouth, compliance)
    return vectors(rig, "crack", order, omega, **theta)


def crack(rig: RigConfig, at: float, mouth: float, compliance: float) -> tuple[Crack, dict[str, float]]:
    """The effect and its unknowns."""
    effect = find(rig, "crack")
    assert isinstance(effect, Crack)
    softness = effect.softness_of(compliance, at)
    return effect, {"softness": softness, "mouth": np.radians(mouth), "place": at}


def test_a_crack_gives_way_no_more_than_a_shaft_that_is_nearly_through() -> None:
    rig = pinned(0.2)
    for diameters, possible in ((2, True), (20, False)):  # of whole shaft, which kinks by 1 / EI per N m and m
        effect, theta = crack(rig, 0.12, 0, diameters * 0.01 / EI)
        assert effect.is_plausible(theta) is possible
