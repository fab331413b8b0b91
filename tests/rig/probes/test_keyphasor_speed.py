"""Edges and speed from pulses placed at known shaft angles."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.probes.keyphasor_speed import KeyphasorSpeed
from tests.rig.signals import RATE, block, cut, pulse_volts

T = np.arange(20_000) / RATE  # two seconds


def fixed_threshold(rk4: RigConfig, **changed: object) -> RigConfig:
    assert rk4.keyphasor
    return rk4.model_copy(update={"keyphasor": rk4.keyphasor.model_copy(update={"threshold": -6.0, **changed})})


def edges_of(rig: RigConfig, info: DaqInfo, blocks: list[Block]) -> tuple[np.ndarray, KeyphasorSpeed]:
    keyphasor = KeyphasorSpeed(rig, info)
    return np.concatenate([keyphasor.update(b) for b in blocks]), keyphasor


def test_edges_are_where_the_shaft_angle_is_zero(rk4: RigConfig, info: DaqInfo) -> None:
    turns = 20.0 * T - 0.25  # whole turns at 0.0125 s + k/20 s
    edges, keyphasor = edges_of(rk4, info, [block(pulse_volts(turns))])
    np.testing.assert_allclose(edges, (np.arange(40) + 0.25) * RATE / 20, atol=1e-3)
    assert keyphasor.pulses == 40


def test_the_rising_edge_is_the_other_side_of_the_pulse(rk4: RigConfig, info: DaqInfo) -> None:
    turns = 20.0 * T - 0.25
    edges, _ = edges_of(fixed_threshold(rk4, edge="rising"), info, [block(pulse_volts(turns))])
    np.testing.assert_allclose(edges, (np.arange(40) + 0.25 - 20 / 360) * RATE / 20, atol=1e-3)


def test_speed_is_that_of_the_last_turn(rk4: RigConfig, info: DaqInfo) -> None:
    hz, rate = 20.0, 5.0  # 20 Hz rising by 5 Hz/s
    turns = hz * T + rate * T**2 / 2 + 0.5
    _, keyphasor = edges_of(rk4, info, [block(pulse_volts(turns))])
    last = math.floor(turns[-1])
    begin, end = ((-hz + math.sqrt(hz**2 + 2 * rate * (n - 0.5))) / rate for n in (last - 1, last))
    assert keyphasor.speed == pytest.approx(2 * math.pi / (end - begin), rel=1e-6)


@given(at=st.lists(st.integers(1, 19_999), max_size=12, unique=True))
def test_edges_do_not_depend_on_the_cuts(rk4: RigConfig, info: DaqInfo, at: list[int]) -> None:
    whole = block(pulse_volts(37.2 * T - 0.1))
    rig = fixed_threshold(rk4)
    one, _ = edges_of(rig, info, [whole])
    many, keyphasor = edges_of(rig, info, cut(whole, sorted(at)))
    np.testing.assert_allclose(many, one, atol=1e-9)
    assert keyphasor.pulses == len(one) == 75


def test_a_threshold_found_from_the_levels_is_midway(rk4: RigConfig, info: DaqInfo) -> None:
    blocks = cut(block(pulse_volts(20 * T - 0.25)), list(range(200, 20_000, 200)))
    found, _ = edges_of(rk4, info, blocks)
    given_, _ = edges_of(fixed_threshold(rk4), info, blocks)
    np.testing.assert_allclose(found, given_, atol=0.01)


def test_noise_on_the_edge_makes_no_second_pulse(rk4: RigConfig, info: DaqInfo) -> None:
    rng = np.random.default_rng(3)
    slow = pulse_volts(4.0 * T - 0.25)  # an edge of 14 samples
    noisy = block(slow + rng.normal(0, 0.2, len(T)))
    _, keyphasor = edges_of(rk4, info, cut(noisy, list(range(200, 20_000, 200))))
    assert keyphasor.pulses == 8


def test_noise_without_pulses_is_no_pulse(rk4: RigConfig, info: DaqInfo) -> None:
    rng = np.random.default_rng(4)
    _, keyphasor = edges_of(rk4, info, [block(-10 + rng.normal(0, 0.05, len(T)))])
    assert (keyphasor.pulses, keyphasor.speed, keyphasor.age) == (0, 0.0, 2.0)


def test_without_pulses_the_speed_can_only_be_lower_every_moment(rk4: RigConfig, info: DaqInfo) -> None:
    turns = np.minimum(20.0 * T, 20.5)  # stands still after 1.025 s, half a turn after its last edge
    _, keyphasor = edges_of(rk4, info, [block(pulse_volts(turns))])
    assert keyphasor.age == pytest.approx(1.0, abs=1e-4)
    assert keyphasor.speed == pytest.approx(2 * math.pi / 1.0, rel=1e-3)
    assert keyphasor.time == 2.0


@pytest.mark.parametrize("spoilt", ["stray", "missing"])
def test_the_steady_speed_is_deaf_to_one_stray_or_missing_pulse(rk4: RigConfig, info: DaqInfo, spoilt: str) -> None:
    volts = pulse_volts(20.0 * T[:19_800] + 0.5)
    where = slice(18_600, 18_630) if spoilt == "stray" else slice(18_500, 19_000)  # the edge at 1.875 s
    volts[where] = -2.0 if spoilt == "stray" else -10.0
    _, keyphasor = edges_of(rk4, info, [block(volts)])
    assert keyphasor.steady_speed == pytest.approx(2 * math.pi * 20, rel=1e-3)


def test_no_period_is_measured_across_a_gap(rk4: RigConfig, info: DaqInfo) -> None:
    whole = block(pulse_volts(20.0 * T))
    before, _, after = cut(whole, [8_100, 11_700])
    keyphasor = KeyphasorSpeed(rk4, info)
    keyphasor.update(before)
    edges = keyphasor.update(after)
    np.testing.assert_allclose(edges[0], 12_000, atol=1e-2)
    assert keyphasor.steady_speed == pytest.approx(2 * math.pi * 20, rel=1e-5)


def test_right_after_a_gap_the_speed_is_that_of_before_it(rk4: RigConfig, info: DaqInfo) -> None:
    """A rotor that seemed to stand would end a coast-down at once, and take a critical band's limits from it."""
    before, _, after = cut(block(pulse_volts(20.0 * T)), [8_100, 19_900])
    _, keyphasor = edges_of(rk4, info, [before, after])
    assert keyphasor.speed == keyphasor.steady_speed == pytest.approx(2 * math.pi * 20, rel=1e-5)
    assert keyphasor.age == pytest.approx(0.01)


def test_a_shaft_that_stands_after_a_gap_is_seen_to(rk4: RigConfig, info: DaqInfo) -> None:
    before, _, still = cut(block(pulse_volts(np.minimum(20.0 * T, 16.5))), [8_100, 8_400])
    _, keyphasor = edges_of(rk4, info, [before, still])
    assert keyphasor.steady_speed == pytest.approx(2 * math.pi / keyphasor.age)


def test_a_gap_before_the_first_turn_leaves_the_speed_unknown(rk4: RigConfig, info: DaqInfo) -> None:
    before, _, after = cut(block(pulse_volts(20.0 * T)), [100, 19_900])
    _, keyphasor = edges_of(rk4, info, [before, after])
    assert keyphasor.speed == 0.0


def test_an_empty_block_changes_nothing(rk4: RigConfig, info: DaqInfo) -> None:
    whole = block(pulse_volts(20.0 * T))
    first, second = cut(whole, [10_000])
    empty = Block(counts=np.empty((0, 5), np.int32), first_sample=10_000, t_ns=10**9)
    edges, _ = edges_of(rk4, info, [first, empty, second])
    assert len(edges) == edges_of(rk4, info, [whole])[1].pulses


def test_a_config_without_keyphasor_is_said(rk4: RigConfig, info: DaqInfo) -> None:
    with pytest.raises(ConfigError, match="keyphasor: is missing"):
        KeyphasorSpeed(rk4.model_copy(update={"keyphasor": None}), info)


WHEELS = {
    "even": np.arange(8) / 8,
    "displaced": np.arange(8) / 8 - 0.03 * (np.arange(8) == 7),
    "missing": np.arange(11) / 12,
    "pair": np.array([0.0, 0.4]),
}


def wheel(turns: np.ndarray, teeth: np.ndarray) -> np.ndarray:
    """Return the volts of a wheel whose pulses fall through -6 V at `teeth` of every turn."""
    place = np.mod(turns, 1.0)
    ahead = np.min([np.mod(tooth - place, 1.0) for tooth in teeth], axis=0)  # turns until the next falling edge
    return np.where(ahead < 0.3 / len(teeth), -2.0, -10.0)


@pytest.mark.parametrize("teeth", WHEELS.values(), ids=WHEELS.keys())
def test_several_pulses_per_turn_give_the_speed_of_the_shaft(rk4: RigConfig, info: DaqInfo, teeth: np.ndarray) -> None:
    """The interlock goes by it: a speed as many times too high or too low as there are teeth would be dangerous."""
    rig = fixed_threshold(rk4, pulses_per_revolution=len(teeth))
    blocks = cut(block(wheel(20.0 * T + 0.1, teeth)), list(range(200, 20_000, 200)))
    keyphasor = KeyphasorSpeed(rig, info)
    for piece in blocks:
        keyphasor.update(piece)
        assert keyphasor.steady_speed == 0.0 or keyphasor.steady_speed == pytest.approx(2 * math.pi * 20, rel=0.005)
        assert keyphasor.speed < 2 * math.pi * 20 * 1.005
    assert keyphasor.steady_speed > 0
    assert keyphasor.pulses == pytest.approx(40 * len(teeth), abs=1)


@pytest.mark.parametrize("spoilt", ["stray", "missing"])
def test_one_stray_or_missing_pulse_of_several_leaves_the_steady_speed(
    rk4: RigConfig, info: DaqInfo, spoilt: str
) -> None:
    teeth = WHEELS["even"]
    volts = wheel(20.0 * T[:19_900], teeth)
    falling = np.flatnonzero((volts[:-1] > -6) & (volts[1:] < -6))
    at = int(falling[-4])
    volts[slice(at - 40, at + 1) if spoilt == "missing" else slice(at + 20, at + 25)] = (
        -10.0 if spoilt == "missing" else -2.0
    )
    _, keyphasor = edges_of(fixed_threshold(rk4, pulses_per_revolution=8), info, [block(volts)])
    assert keyphasor.steady_speed == pytest.approx(2 * math.pi * 20, rel=0.01)


def test_a_wheel_that_stops_is_seen_to_after_one_spacing(rk4: RigConfig, info: DaqInfo) -> None:
    turns = np.minimum(20.0 * T, 20.06)  # stands still half a spacing after its last edge
    rig = fixed_threshold(rk4, pulses_per_revolution=8)
    _, keyphasor = edges_of(rig, info, [block(wheel(turns, WHEELS["even"]))])
    assert keyphasor.speed == pytest.approx(2 * math.pi / 8 / keyphasor.age, rel=0.01)
    assert keyphasor.steady_speed == pytest.approx(2 * math.pi / 8 / keyphasor.age, rel=0.01)


@pytest.mark.parametrize("name", ["displaced", "missing", "pair"])
def test_turns_begin_at_the_tooth_after_the_widest_spacing(rk4: RigConfig, info: DaqInfo, name: str) -> None:
    teeth = WHEELS[name]
    rig = fixed_threshold(rk4, pulses_per_revolution=len(teeth))
    edges, _ = edges_of(rig, info, [block(wheel(20.0 * T + 0.37, teeth))])
    late = edges[1:] / RATE * 20.0 + 0.37  # turns; the first may be counted before a whole turn has been seen
    np.testing.assert_allclose(late, np.round(late), atol=0.003)
    np.testing.assert_allclose(np.diff(late), 1.0, atol=0.003)


def test_the_hysteresis_of_the_config_is_the_band_a_pulse_has_to_leave(rk4: RigConfig, info: DaqInfo) -> None:
    ripple = block(pulse_volts(4 * T - 0.25) + np.tile([1.5, 1.5, -1.5, -1.5], 5_000))  # on flanks of 14 samples
    narrow, _ = edges_of(fixed_threshold(rk4, hysteresis=0.5), info, [ripple])
    wide, _ = edges_of(fixed_threshold(rk4, hysteresis=7.0), info, [ripple])
    assert len(wide) == 8
    assert len(narrow) > 8
