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


def test_there_is_one_more_critical_speed_in_each_direction_and_a_rocking_one_above(rk4: RigConfig) -> None:
    def frequencies(rotor: Rotor) -> np.ndarray:
        return np.sqrt(linalg.eigvalsh(rotor.K, rotor.M)) / (2 * np.pi)

    plain, soft = frequencies(build(rk4, nameplate(rk4))), frequencies(standing(rk4))
    assert np.count_nonzero(plain < 80) == 2
    assert np.count_nonzero(soft < 80) == 4


def test_the_pedestal_alone_rings_at_the_frequency_stated_first_and_rocks_faster(rk4: RigConfig) -> None:
    """Of a block that slides and rocks, by the roots of its frequency equation, written out by hand."""
    rotor = standing(rk4)
    n = rotor.n
    own = np.ix_([n - 2, n - 1], [n - 2, n - 1])
    b = nameplate(rk4).bearings[2]
    K = rotor.K[own] - b.kxx * np.ones((2, 2))
    w1, w2 = np.sqrt(linalg.eigvalsh(K, rotor.M[own]))
    assert w1 / (2 * np.pi) == pytest.approx(28.0, rel=1e-9)
    # w^2 m [[1, 1/2], [1/2, 1/4 + 0.32^2]] against [[2.5, 0], [0, 1 / 0.6]] / c: the ratio of the roots of
    # a x^2 - b x + d with a = 0.1024, b = 2.5 (0.25 + 0.1024) + 1 / 0.6, d = 2.5 / 0.6
    a, half, d = 0.1024, (2.5 * 0.3524 + 1 / 0.6) / 2, 2.5 / 0.6
    root = np.sqrt(half**2 - a * d)
    assert w2 / w1 == pytest.approx(np.sqrt((half + root) / (half - root)), rel=1e-9)
    assert np.sum(np.linalg.inv(K)) == pytest.approx(4e-6, rel=1e-9)  # m/N at the bearing


def test_upright_it_is_a_mass_on_a_spring(rk4: RigConfig) -> None:
    rotor = standing(rk4)
    lifts = 2 * rotor.n - 2
    assert rotor.K[lifts, lifts] == pytest.approx(1 / 2e-6 + 34.6e3, rel=1e-9)
    assert rotor.M[lifts, lifts] == pytest.approx(rotor.M[rotor.n - 2, rotor.n - 2], rel=1e-9)
    assert rotor.C[lifts, lifts] > 0
