"""Places and the laws that several faults share."""

import math

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.force_laws import Force, Motion, Place, Slope, Turn, at, bend, heavy_spot, law, sway, tilt
from rotorrig.sims.plant.integrate import ShaftMotion
from rotorrig.sims.plant.shaft import bending_stiffness, build

H = 1e-4  # s


def row(place: Place, length: float) -> np.ndarray:
    """Return the weights of `place` over (w, w', w, w') of an element from 0 to `length`."""
    weights = np.zeros(4)
    for coordinate, weight in place:
        weights[2 * (coordinate.position == length) + isinstance(coordinate, Slope)] += weight
    return weights


def test_bend_and_sway_make_up_a_beam_element_s_stiffness() -> None:
    length = 0.07
    b, s = row(bend(0.0, length), length), row(sway(0.0, length), length)
    assert (np.outer(b, b) + 3 * np.outer(s, s)) / length == pytest.approx(bending_stiffness(length), rel=1e-12)


def test_a_heavy_spot_pulls_as_the_disk_s_own_unbalance_does(jeffcott: RigConfig) -> None:
    rotor = build(jeffcott, nameplate(jeffcott))
    spot = Force(on=at(0.2), law=heavy_spot, constants=(20e-6, 0.7))
    speed = np.linspace(100.0, 400.0, 8000)
    turning = np.cumsum(speed) * H, speed, np.full(8000, 300.0 / 0.8)
    as_law, as_unbalance = (
        ShaftMotion(rotor, step=H, watched=(0.2,), **loads).run(*turning)
        for loads in ({"forces": (spot,)}, {"unbalances": ((0.2, 20e-6, 0.7),)})
    )
    assert np.abs(as_law - as_unbalance).max() < 1e-4 * np.abs(as_law).max()


def test_a_moment_on_a_tilt_turns_the_shaft_by_l_over_12_e_i_at_midspan(jeffcott: RigConfig) -> None:
    """Roark, 8.1: a couple at the middle of a simply supported beam turns it there by M L / (12 E I)."""
    rotor = build(jeffcott, nameplate(jeffcott), extra=[Slope(0.2)])
    force = np.zeros(2 * rotor.n)
    ((slope, _),) = tilt(0.2)
    force[rotor.coordinate(slope)] = 1.0
    turned = np.linalg.solve(rotor.K, force)[rotor.coordinate(slope)]
    assert turned == pytest.approx(0.4 / (12 * 200e9 * math.pi / 64 * 0.01**4), rel=1e-4)


@law
def told(turn: Turn, motion: Motion, p: np.ndarray, before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """Push with p[0] once per call's step number, to see what a law is told."""
    after[0] = before[0] + 1.0
    return 0.0 * motion.x, p[0] * (after[0] * turn.step - turn.t)


def test_a_law_s_memory_goes_on_once_per_step_and_its_clock_runs_over_blocks(jeffcott: RigConfig) -> None:
    """A push of steps counted times the step less the time is no push, however often a step was iterated."""
    counting = Force(on=at(0.2), law=told, constants=(1e3,), memory=1)
    motion = ShaftMotion(
        build(jeffcott, nameplate(jeffcott)), step=H, forces=(counting,), unbalances=((0.2, 1e-5, 0.0),), watched=(0.2,)
    )
    for steps in (3, 1, 40):
        motion.run(np.zeros(steps), np.zeros(steps), np.full(steps, 100.0))
    plain = ShaftMotion(build(jeffcott, nameplate(jeffcott)), step=H, unbalances=((0.2, 1e-5, 0.0),), watched=(0.2,))
    plain.run(np.zeros(44), np.zeros(44), np.full(44, 100.0))
    assert motion.state[0] == pytest.approx(plain.state[0], abs=1e-15)


def test_a_spring_from_rest_leaves_the_sag_as_it_is(jeffcott: RigConfig) -> None:
    def height(from_rest: bool) -> float:
        spring = Force(on=at(0.2), law=pull, constants=(5e4,), from_rest=from_rest)
        rotor = build(jeffcott, nameplate(jeffcott))
        motion = ShaftMotion(rotor, step=H, gravity=(0.0, -9.8), forces=(spring,), watched=(0.2,))
        still = np.zeros(12_000)
        return float(motion.run(still, still, still)[-1, 0, 1])

    assert height(True) == pytest.approx(-9.8 / 73.631e3, rel=1e-4)
    assert height(False) == pytest.approx(-9.8 / (73.631e3 + 5e4), rel=1e-4)


@law
def pull(turn: Turn, motion: Motion, p: np.ndarray, before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """Pull like a spring."""
    return -p[0] * motion.x, -p[0] * motion.y
