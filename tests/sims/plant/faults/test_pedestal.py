"""A bearing on a soft pedestal."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.faults.base import apply_structure
from rotorrig.sims.plant.shaft import Rotor, build
from rotorrig.sims.plant.truth import FaultSpec

VALUES = {"compliance": 4e-6, "frequency": 28.0, "aspect": 0.5}


def standing(rig: RigConfig) -> Rotor:
    truth = nameplate(rig, faults=[FaultSpec(name="pedestal", parameters=VALUES)])
    return apply_structure(rig, truth, build(rig, truth))


def test_at_rest_the_compliances_of_bearing_and_pedestal_add_up(rk4: RigConfig) -> None:
    plain = nameplate(rk4)
    spring = plain.bearings[2]
    series = replace(spring, kxx=1 / (1 / spring.kxx + 4e-6), kyy=1 / (1 / spring.kyy + 2e-6))
    named = build(rk4, replace(plain, bearings=(*plain.bearings[:2], series)))
    got, want = (rotor.static_sag((9.0, 9.0))[[3, 3 + rotor.n]] for rotor in (standing(rk4), named))
    assert got == pytest.approx(want, rel=1e-9)


def test_there_is_one_more_critical_speed_in_each_direction(rk4: RigConfig) -> None:
    def frequencies(rotor: Rotor) -> np.ndarray:
        return np.sqrt(linalg.eigvalsh(rotor.K, rotor.M)) / (2 * np.pi)

    plain, soft = frequencies(build(rk4, nameplate(rk4))), frequencies(standing(rk4))
    assert np.count_nonzero(plain < 80) == 2
    assert np.count_nonzero(soft < 80) == 4


def test_with_the_shaft_held_still_the_pedestal_rings_on_both_springs(rk4: RigConfig) -> None:
    rotor, mass = standing(rk4), 1 / (4e-6 * (2 * np.pi * 28) ** 2)  # 8.1 kg
    for i, k in ((rotor.n - 1, 1 / 4e-6 + 33.9e3), (2 * rotor.n - 1, 1 / 2e-6 + 34.6e3)):
        assert rotor.K[i, i] / rotor.M[i, i] == pytest.approx(k / mass, rel=1e-9)
