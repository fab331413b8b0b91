"""Pulses that come at the wrong time, among those of motions known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.processing.shaft_angle.displaced_pulses import drop_displaced
from rotorrig.processing.shaft_angle.pulse_train import count_pulses
from rotorrig.processing.shaft_angle.shaft_angle import fit_shaft_angle
from rotorrig.processing.shaft_angle.smooth_angle import TURN
from tests.processing.shaft_angle.test_smooth_angle import RATE, START, hunting, pulses_of, ramp_pulses, tripped


@pytest.mark.parametrize("jitter", [0.0, 5e-6])
@pytest.mark.parametrize("share", [-0.25, -0.02, 0.02, 0.25])
def test_displaced_pulses_are_dropped_and_no_others(share: float, jitter: float, rng: np.random.Generator) -> None:
    pulses, turned = ramp_pulses()
    wrong = [3, 200, 206, 900, 1646]
    moved = pulses + jitter * rng.standard_normal(len(pulses))
    moved[wrong] += share * np.diff(pulses)[wrong]
    train = drop_displaced(count_pulses(moved), turned)
    np.testing.assert_array_equal(train.number, np.delete(np.arange(len(pulses)), wrong))
    assert train.extra == tuple(moved[wrong])
    assert train.missed.sum() == len(wrong)


def test_a_displaced_pulse_turns_the_angle_no_more_than_a_missed_one(rng: np.random.Generator) -> None:
    pulses, _ = ramp_pulses()
    late = pulses + 5e-6 * rng.standard_normal(len(pulses))
    late[700] -= 0.1 * (pulses[700] - pulses[699])
    shaft = fit_shaft_angle(late)
    t = np.linspace(pulses[0], pulses[-1], 20_001)
    assert np.abs(shaft.theta(t) - START * t - RATE * t**2 / 2).max() < 1e-3  # a tenth of a turn is 0.6
    assert {repair.reason for repair in shaft.repairs} == {"extra pulse dropped", "missed pulse bridged"}
    assert shaft.flaws == ()


@pytest.mark.parametrize("jitter", [0.0, 20e-6])
def test_a_speed_that_changes_at_once_or_swings_displaces_no_pulse(jitter: float, rng: np.random.Generator) -> None:
    for theta in (tripped, hunting(0.5), hunting(5.0)):
        pulses, turned = pulses_of(theta, 20.0)
        train = count_pulses(pulses + jitter * rng.standard_normal(len(pulses)))
        assert drop_displaced(train, turned) is train


def test_a_start_from_rest_displaces_no_pulse() -> None:
    pulses = np.sqrt(2 * TURN * np.arange(1, 200) / 10.0)
    train = count_pulses(pulses)
    assert drop_displaced(train, TURN * train.number.astype(float)) is train


def test_the_teeth_of_an_uneven_wheel_are_not_displaced_but_a_spike_among_them_is() -> None:
    places = np.array([0.0, 0.2, 0.5, 0.6])
    turned = TURN * (np.arange(100)[:, None] + places).ravel()
    pulses = (np.sqrt(START**2 + 2 * RATE * turned) - START) / RATE
    train = replace(count_pulses(np.arange(len(pulses)) * 1.0), t=pulses)  # counted; the times are the wheel's
    assert drop_displaced(train, turned) is train
    early = pulses.copy()
    early[201] -= 0.1 * (pulses[201] - pulses[200])
    found = drop_displaced(replace(train, t=early), turned)
    np.testing.assert_array_equal(found.number, np.delete(train.number, 201))
