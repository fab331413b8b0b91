"""What only the rotor's weight brings out: an asymmetric shaft and a crack."""

import numpy as np
import pytest

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import find
from rotorrig.sims.rotor.assembly import assemble
from tests.sims.effects.predicted import Complex, pair_at, predicted, simple_rig

LIGHT = {"length": 0.4, "diameter": 0.01, "density": 1e-3, "youngs_modulus": 210e9}
POINT = {"name": "disk", "position": 0.2, "mass": 0.8, "polar_inertia": 0.0, "transverse_inertia": 0.0}
PINNED = [{"name": name, "position": z, "rigid": True} for name, z in (("A", 0.0), ("B", 0.4))]
EI = 210e9 * np.pi * 0.01**4 / 64
K = 48 * EI / 0.4**3
CRITICAL = np.sqrt(K / 0.8)
SAG = 0.8 * 9.80665 / K
SHEAR = 3e-3  # of the bending of a shaft this slender


def pinned(z: float, **changes: object) -> RigConfig:
    """A point mass in the middle of a pinned shaft without mass, probes at z."""
    return simple_rig(pair_at(z), shaft=LIGHT, disks=[POINT], bearings=PINNED, **changes)


def vectors(rig: RigConfig, label: str, order: int, omega: float, **theta: float) -> Complex:
    effect = find(rig, label)
    whole = {**effect.at_nothing, **theta}
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
    at, kink = 0.12, 4e-5
    for z in (0.06, 0.25):
        triangle = kink * min(z, at) * (0.4 - max(z, at)) / 0.4
        seen = vectors(pinned(z), f"crack, at {1e3 * at:.0f} mm", 1, 0.0, **{"kink 1X re": kink})
        # down as cos(theta), and aside, where the turning crack goes next, a third of it as sin(theta)
        assert seen == pytest.approx([-1j / 3 * triangle, -triangle], rel=0.02)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_crack_resonates_at_a_fraction_of_the_critical_speed(order: int) -> None:
    rig = pinned(0.2)
    near, off = (
        abs(vectors(rig, "crack, at 120 mm", order, ratio * CRITICAL / order, **{f"kink {order}X re": 1e-5})[1])
        for ratio in (0.995, 0.5)
    )
    assert near > 50 * off


@pytest.mark.parametrize(("rotation", "forward"), [("x-to-y", 1), ("y-to-x", -1)])
def test_a_crack_turns_with_the_shaft(rotation: str, forward: int) -> None:
    rig = pinned(0.2, rotation=rotation)
    for order in (2, 3):
        x, y = vectors(rig, "crack, at 120 mm", order, 100.0, **{f"kink {order}X re": 1e-5})
        assert y == pytest.approx(-1j * forward * x, rel=1e-6)
