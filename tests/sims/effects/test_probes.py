"""What probes make of a motion, against vectors written down by hand."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, ReadingContext, catalogue, find
from rotorrig.sims.effects.line_hum import LineHum, leak
from rotorrig.sims.rotor.model.assembly import assemble
from tests.sims.effects.predicted import base_load, motion, pair_at, simple_rig, view

Z = np.array([[10 - 2j, 3j, 4.0, -4j], [1 + 1j, 2.0, 0.5, 0.0]]) * 1e-6  # the last row is the slow roll
TWO = np.array([200.0, 25.0])  # rad/s


def looked_at(rk4: RigConfig, label: str, theta: dict[str, float], order: int = 1) -> Complex:
    return find(rk4, label).change_readings(Z, view(rk4, order, TWO), theta)


@pytest.mark.parametrize("order", EVERY)
def test_a_gain_is_a_ratio_at_every_speed_and_order(rk4: RigConfig, order: int) -> None:
    ratio = looked_at(rk4, "probe_gain, probe 1x", {"error": 0.04}, order)[:, 0] / Z[:, 0]
    assert ratio == pytest.approx([1.04, 1.04])


@pytest.mark.parametrize("order", EVERY)
def test_a_delay_turns_by_speed_times_order_and_leaves_the_size(rk4: RigConfig, order: int) -> None:
    z = looked_at(rk4, "delay, plane 1", {"delay": 1e-4}, order)
    assert np.abs(z) == pytest.approx(np.abs(Z))
    lag = -np.angle(z[:, 0] / Z[:, 0])
    assert lag == pytest.approx(order * TWO * 1e-4)
    assert np.array_equal(z[:, 2:], Z[:, 2:])


def test_all_late_is_the_keyphasor_early(rk4: RigConfig) -> None:
    assert -np.angle(looked_at(rk4, "delay", {"delay": 1e-4})[0] / Z[0]) == pytest.approx(np.full(4, 0.02))


def test_runout_goes_round_forward(rk4: RigConfig) -> None:
    z = looked_at(rk4, "runout, plane 2", {"runout re": 3e-6, "runout im": 1e-6}) - Z
    assert z == pytest.approx(np.array([[0, 0, 3 + 1j, 1 - 3j]] * 2) * 1e-6)


def test_runout_is_a_surface_that_stands_out_towards_one_probe_after_the_other() -> None:
    rig = simple_rig([{"name": "p", "position": 0.1, "angle": np.pi / 3}], rotation="y-to-x")
    z = find(rig, "runout, plane 1").change_readings(
        np.zeros((1, 1), complex), view(rig, 1, TWO[:1]), {"runout re": 1.0, "runout im": 0.0}
    )
    theta = -np.pi / 3  # turning from y to x, the spot under +x at theta = 0 comes to the probe after 300 degrees
    assert (z[0, 0] * np.exp(1j * theta)).real == pytest.approx(1.0)


def test_an_oval_track_looks_the_same_upside_down(rk4: RigConfig) -> None:
    theta = {"runout re": 2e-6, "runout im": 0.0}
    assert looked_at(rk4, "runout, plane 1, twice per turn", theta, 2) - Z == pytest.approx(
        np.array([[2, -2, 0, 0]] * 2) * 1e-6
    )


@pytest.mark.parametrize("degrees", [-15.0, 5.0])
def test_a_turned_probe_reads_as_one_mounted_so(degrees: float) -> None:
    turn = np.radians(degrees)
    probes = pair_at(0.15)
    straight, askew = simple_rig(probes), simple_rig([probes[0], {**probes[1], "angle": np.pi / 2 + turn}])
    z, want = (motion(m, (base_load(m),), 1, TWO) for m in (assemble(straight), assemble(askew)))
    got = find(straight, "probe_angle, probe y").change_readings(z, view(straight, 1, TWO), {"turn": turn})
    assert got == pytest.approx(want, rel=1e-12)


def test_a_turned_bracket_turns_the_phase_of_a_forward_orbit() -> None:
    rig = simple_rig(pair_at(0.15))
    z = np.array([[1.0, -1j]])
    got = find(rig, "probe_angle, plane 1").change_readings(z, view(rig, 1, TWO[:1]), {"turn": 0.1})
    assert got == pytest.approx(z * np.exp(-0.1j))


def test_cross_talk_is_the_neighbours_share_and_stays_in_its_plane(rk4: RigConfig) -> None:
    z = looked_at(rk4, "cross_talk, plane 2", {"leak": 0.02}) - Z
    assert z == pytest.approx(0.02 * np.array([[0, 0, -4j, 4.0], [0, 0, 0.0, 0.5]]) * 1e-6)


def test_a_slow_roll_that_was_subtracted_stands_in_its_own_row(rk4: RigConfig) -> None:
    assert looked_at(rk4, "slow_roll_subtracted", {"share": 0.5}) == pytest.approx(np.stack([Z[0] - Z[1] / 2, Z[1]]))


def test_the_slow_roll_that_was_subtracted_is_the_measured_one(rk4: RigConfig) -> None:
    """Whatever was in it: noise, and response to unbalance at too high a speed."""
    measured = np.array([3e-6, -2e-6j, 1e-6 + 1e-6j, np.nan])
    seen = replace(view(rk4, 1, TWO), slow_roll=measured)
    got = find(rk4, "slow_roll_subtracted").change_readings(Z, seen, {"share": 0.5})
    assert got == pytest.approx(np.stack([Z[0] - np.nan_to_num(measured) / 2, Z[1]]))


def steady(
    turns_per_second: float, *, order: int = 1, revolutions: float = 8.0, window: str = "hann"
) -> ReadingContext:
    """One row in the middle of a second of even rotation, and a slow roll."""
    return ReadingContext(
        probes=("x",),
        angle=np.zeros(1),
        position=np.zeros(1),
        order=order,
        omega=np.array([2 * np.pi * turns_per_second, 20.0]),
        t=np.array([0.5]),
        revolutions=np.array([revolutions]),
        window=window,
        keyphasor_t=np.arange(turns_per_second + 1) / turns_per_second,
    )


@pytest.mark.parametrize(("speed", "order"), [(50.0, 1), (25.0, 2)])
def test_hum_at_the_order_is_taken_for_vibration(speed: float, order: int) -> None:
    z = leak(steady(speed, order=order), np.array([0]), 50.0)
    assert z == pytest.approx([1.0], abs=1e-9)  # a whole number of periods since t = 0, the first pulse


@pytest.mark.parametrize("bins", [2, 3, 5])
def test_hum_whole_bins_away_is_shut_out(bins: int) -> None:
    z = leak(steady(40.0), np.array([0]), 40.0 + bins * 40.0 / 8)
    assert abs(z) == pytest.approx([0.0], abs=1e-9)


def test_hum_of_mains_that_stray_leaks_as_that_of_their_frequency_does() -> None:
    """A phase that runs ahead by 2 pi 0.5 t is half a hertz."""
    there, t = steady(50.0), np.linspace(0.0, 1.0, 11)
    strayed = replace(there, strays={50.0: (t, 2 * np.pi * 0.5 * t)})
    rows = np.array([0])
    assert leak(strayed, rows, 50.0) == pytest.approx(leak(there, rows, 50.5), abs=1e-9)
    assert leak(strayed, rows, 60.0) == pytest.approx(leak(there, rows, 60.0), abs=1e-12)


def test_every_recording_has_a_phasor_of_its_own_where_there_are_several(rk4: RigConfig) -> None:
    alike = find(rk4, "line_hum, 50 Hz")
    assert isinstance(alike, LineHum)
    effect = alike.of_recordings(2)
    assert [p.name for p in effect.parameters] == ["hum re", "hum im", "hum 2 re", "hum 2 im"]
    theta = {"hum re": 1e-6, "hum im": 0.0, "hum 2 re": 0.0, "hum 2 im": 2e-6}
    row = np.full((2, 1), 1e-5 + 0j)
    for number, hum in ((0, 1e-6), (1, 2e-6j)):
        there = replace(steady(50.0), recording=number)
        assert effect.change_readings(row, there, theta)[0, 0] - row[0, 0] == pytest.approx(hum)
        same = alike.change_readings(row, there, {"hum re": 1e-6, "hum im": 0.0})
        assert same[0, 0] - row[0, 0] == pytest.approx(1e-6)
    assert (effect.change_readings(row, replace(steady(50.0), recording=2), theta) == row).all(), "a run to come"
    assert "2.00 um" in effect.words(theta)


def test_hum_half_a_bin_away_leaks_as_the_windows_transform_says() -> None:
    plain = leak(steady(40.0, window="rectangular"), np.array([0]), 42.5)
    assert abs(plain) == pytest.approx([2 / np.pi], rel=0.05)  # sinc(1/2), and a little of the image at -42.5 Hz
    hann = leak(steady(40.0), np.array([0]), 42.5)
    assert abs(hann) == pytest.approx([8 / (3 * np.pi)], rel=0.03)


def test_hum_is_unknown_where_time_is(rk4: RigConfig) -> None:
    effect, theta = find(rk4, "line_hum, 50 Hz"), {"hum re": 1e-6, "hum im": 0.0}
    row = np.full((2, 1), 1e-5 + 0j)
    for blind in (replace(steady(50.0), t=np.array([np.nan])), replace(steady(50.0), keyphasor_t=np.zeros(0))):
        assert np.array_equal(effect.change_readings(row, blind, theta), row)
    assert effect.change_readings(row, steady(50.0), theta) - row == pytest.approx(np.array([[1e-6], [0.0]]))


def test_one_plane_is_all_probes(rk4: RigConfig) -> None:
    rig = rk4.model_copy(update={"probes": rk4.probes[:2]})
    assert [e.label for e in catalogue(rig) if e.name == "delay"] == ["delay", "delay, probe 1x", "delay, probe 1y"]
