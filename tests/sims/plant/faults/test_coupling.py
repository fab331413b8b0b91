"""The misaligned coupling: its law by hand, and what it does to the rig."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults import coupling
from rotorrig.sims.plant.force_laws import Force, Motion, Turn, at
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import FaultSpec

from ..by_hand import RPM, measured

BORE_ALONE = {"bore_force": 0.3, "bore_angle": 0.5, "stiffness_variation": 0.0}
STIFFNESS_ALONE = {"bore_force": 0.0, "offset": 1e-4, "offset_angle": 0.0, "stiffness_variation": 3000.0}


def the_force(rig: RigConfig, **values: float) -> Force:
    (only,) = coupling.forces(rig, nameplate(rig), coupling.PARAMETERS | values)
    return only


def felt(force: Force, angle: float, x: float = 0.0) -> tuple[float, float]:
    turn, motion, none = Turn(0.0, angle, 100.0, 0.0, 1e-4), Motion(x, 0.0, 0.0, 0.0), np.zeros(0)
    return force.law(turn, motion, np.array(force.constants), none, none)


def test_it_acts_on_the_driven_end(rk4: RigConfig) -> None:
    assert the_force(rk4).on == at(0.0)


def test_an_eccentric_bore_is_a_constant_force_that_turns_with_the_shaft(rk4: RigConfig) -> None:
    force = the_force(rk4, **BORE_ALONE)
    for angle in (0.0, 1.0, 4.0):
        assert felt(force, angle) == pytest.approx((0.3 * math.cos(angle + 0.5), 0.3 * math.sin(angle + 0.5)))


def test_each_arm_meets_what_lies_along_it(rk4: RigConfig) -> None:
    """3 kN/m of variation about 3.6: arms of 6.6 and 0.6, and their bushes stiffer by 2 (0.1 / 2)^2 = 0.5 %.

    Across, the motor's arm leans by 0.1 mm over 30 mm: 1 / (1 + 1.1e-5) of its pull is left.
    """
    force = the_force(rk4, **STIFFNESS_ALONE)
    assert felt(force, 0.0) == pytest.approx((0.66 * 1.005, 0.0), abs=1e-12)
    assert felt(force, math.pi / 2) == pytest.approx((0.06 * 1.005, 0.0), rel=2e-5, abs=1e-12)
    at_45 = 1 + 2 * 0.05**2 / 2  # both arms have 1 / sqrt(2) of it
    assert felt(force, math.pi / 4) == pytest.approx((0.36 * at_45, 0.3 * at_45), rel=2e-5)
    assert felt(force, 0.0, x=1e-4) == pytest.approx((0.0, 0.0), abs=1e-12)  # the shaft stands where the motor does


def test_a_turn_of_it_has_the_fourth_order_of_the_bushes(rk4: RigConfig) -> None:
    """cos^4 a has 1/2 cos 2a and 1/8 cos 4a: of 6.6 and 0.6 kN/m with 2 (0.1 / 2)^2 = 0.5 %, nothing odd."""
    angles = 2 * np.pi * np.arange(64) / 64
    fx = np.array([felt(the_force(rk4, **STIFFNESS_ALONE), a)[0] for a in angles])
    orders = 2 * np.fft.rfft(fx)[:6].real / 64
    assert orders[2] == pytest.approx(0.3 + 0.005 * (0.66 - 0.06) / 2, rel=1e-4)
    assert orders[4] == pytest.approx(0.005 * (0.66 + 0.06) / 8, rel=0.01)
    assert np.abs(orders[[1, 3, 5]]).max() < 1e-12


def second_order(rig: RigConfig, rpm: float, faults: list[FaultSpec]) -> float:
    """Return the 2X amplitude of probe 1x at a steady speed [m]."""
    plant = Plant(rig, nameplate(rig, faults=faults))
    plant.command(rpm * RPM, 1000.0, True)
    plant.advance(3.0)
    return float(abs(measured(plant, 1.5, order=2)[0]))


@pytest.mark.campaign
def test_2x_peaks_at_half_the_first_critical_speed_and_needs_the_fault(rk4: RigConfig) -> None:
    """The first criticals of 2226 and 2237 rpm are met by 2X at 1113 and 1118 rpm."""
    fault = [FaultSpec(name="coupling", parameters={"bore_force": 0.0})]
    speeds = [700, 900, 1000, 1080, 1115, 1150, 1230, 1400, 1700]
    twice = [second_order(rk4, rpm, fault) for rpm in speeds]
    assert speeds[int(np.argmax(twice))] == 1115
    assert max(twice) > 5 * max(twice[0], twice[-1])
    assert second_order(rk4, 1115, []) < 0.01 * max(twice)


def test_the_bore_s_force_does_not_grow_with_speed_squared_as_an_unbalance_does(rk4: RigConfig) -> None:
    def first(rpm: float, values: dict[str, float]) -> complex:
        silent = nameplate(rk4, faults=[FaultSpec(name="coupling", parameters=values)])
        plant = Plant(rk4, silent)
        plant.command(rpm * RPM, 1000.0, True)
        plant.advance(2.0)
        return complex(measured(plant, 2.0)[0])

    off = {"bore_force": 0.0, "stiffness_variation": 0.0}
    slow, fast = (abs(first(rpm, BORE_ALONE) - first(rpm, off)) for rpm in (300, 600))
    # both far below critical: only 1 / (1 - (W / w)^2) is left, 1.018 and 1.078
    assert fast / slow == pytest.approx(1.078 / 1.018, rel=0.03)
