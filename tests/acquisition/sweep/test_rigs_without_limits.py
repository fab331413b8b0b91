"""What no [limits] table is needed for: the rotor does what was asked, can be watched, and stood still before."""

import contextlib
import dataclasses
import math
import re
from collections.abc import Callable

import numpy as np
import pytest

from rotorrig.acquisition.sweep.plans import Dwell, Ramp, Step
from rotorrig.acquisition.sweep.steps import Coast
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import NotAtRest
from rotorrig.rig.motor.base import MotorState, Stop
from rotorrig.rig.probes.base import Block
from tests.acquisition.sweep.scripted_bench import LOOKED, PLAN, Bench, MakeBench
from tests.parameters import defer_rest

SLOW_ROLL: tuple[Step, ...] = (Ramp(to=240 / RPM, rate=10.0), Dwell(seconds=10.0))  # as every plan begins
MORE: tuple[Step, ...] = (*SLOW_ROLL, Ramp(to=480 / RPM, rate=10.0), Coast(until=240 / RPM))


@pytest.fixture
def bare(bench: MakeBench) -> Callable[..., Bench]:
    """Return a rig without [limits]; the arguments are the shaft's."""

    def make(**shaft: float) -> Bench:
        rig = bench(**shaft)
        rig.rig = rig.rig.model_copy(update={"limits": None})
        return rig

    return make


def tripped_at(rig: Bench, steps: tuple[Step, ...]) -> tuple[str, float, float]:
    """Run the steps; return what tripped, the sample time since the first command [s] and the top speed [rad/s]."""
    fastest = 0.0
    inner = rig.daq.on_block

    def note(block: Block) -> Block:
        nonlocal fastest
        fastest = max(fastest, rig.shaft.speed)
        return inner(block)

    rig.daq.on_block = note
    with contextlib.suppress(NotAtRest):  # without a keyphasor and the drive's true word nothing proves rest
        rig.sweep(steps)
    trips = [event for event in rig.recorded().events if event.kind == "trip"]
    assert (("stop", Stop.EMERGENCY) in rig.motor.commands) == bool(trips)
    if not trips:
        return "", math.nan, fastest
    return trips[0].text, trips[0].t_ns / 1e9 - LOOKED / 1e4, fastest


PHASES = [0.2, 1.5, 3.0, 4.5, 6.2]  # rad: how far the shaft is past the pulse before it starts


@pytest.mark.parametrize("angle", PHASES)
def test_half_the_pole_pairs_are_found_within_two_seconds_and_below_300_rpm(
    bare: Callable[..., Bench], angle: float
) -> None:
    said, at, fastest = tripped_at(bare(factor=2.0, angle=angle), SLOW_ROLL)
    assert said.startswith("speed: the rotor turns at")
    assert said.endswith("do rpm per Hz, gear or pole pairs of [motor] fit the drive?")
    assert at < 2.0
    assert fastest * RPM < 300


@pytest.mark.parametrize("angle", defer_rest(PHASES))
@pytest.mark.parametrize("rate", [5.0, 10.0, 50.0])
def test_twice_the_pole_pairs_are_found_soon_after_100_rpm_were_asked_for(
    bare: Callable[..., Bench], angle: float, rate: float
) -> None:
    said, at, _ = tripped_at(bare(factor=0.5, angle=angle), (Ramp(to=240 / RPM, rate=rate), Dwell(seconds=10.0)))
    assert said.startswith("speed: the rotor turns at")
    assert said.endswith("do rpm per Hz, gear or pole pairs of [motor] fit the drive?")
    assert at < 100 / RPM / rate + 2.4


@pytest.mark.parametrize("angle", PHASES)
@pytest.mark.parametrize("factor", [2 / 3, 3 / 2])
def test_three_pole_pairs_for_two_are_found_in_the_first_ramp_or_soon_after(
    bare: Callable[..., Bench], angle: float, factor: float
) -> None:
    said, at, _ = tripped_at(bare(factor=factor, angle=angle), SLOW_ROLL)
    assert said.endswith("do rpm per Hz, gear or pole pairs of [motor] fit the drive?")
    assert at < 240 / RPM / 10.0 + 2.0


@pytest.mark.parametrize("angle", defer_rest(PHASES))
@pytest.mark.parametrize("shaft", [{}, {"slip": 0.05}, {"steepest": 3.0}, {"steepest": 5.5}], ids=str)
def test_a_drive_with_slip_or_a_gentler_ramp_of_its_own_trips_nothing(
    bare: Callable[..., Bench], shaft: dict[str, float], angle: float
) -> None:
    said, _, _ = tripped_at(bare(**shaft, angle=angle), MORE)
    assert said == ""


@pytest.mark.parametrize(("speed", "within"), [(3500 / RPM, 1.5), (60 / RPM, 5.0)])
def test_a_rotor_that_leaves_the_speed_of_a_dwell_trips(
    bare: Callable[..., Bench], speed: float, within: float
) -> None:
    rig = bare()
    left: list[float] = []

    def leave(block: Block) -> Block:
        if block.first_sample >= LOOKED + 80_000:
            rig.shaft.held = speed
            left or left.append(block.first_sample / 1e4)
        return block

    rig.daq.on_block = leave
    rig.motor.on_read = lambda state: dataclasses.replace(state, speed=state.setpoint, at_setpoint=True)
    said, at, _ = tripped_at(rig, (Ramp(to=300 / RPM, rate=10.0), Dwell(seconds=20.0)))
    assert said.startswith(("dwell at 300 rpm: not kept for 2 s, the keyphasor reads", "speed: the rotor turns at"))
    assert at - (left[0] - LOOKED / 1e4) < within


def test_a_drive_that_reports_nothing_does_not_disarm_the_keyphasor(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rig.motor.on_read = lambda state: dataclasses.replace(state, speed=0.0, at_setpoint=True)

    def cable_off(block: Block) -> Block:
        if block.first_sample >= LOOKED + 80_000:
            block.counts[:, 4] = 0
        return block

    rig.daq.on_block = cable_off
    said, at, _ = tripped_at(rig, (Ramp(to=300 / RPM, rate=10.0), Dwell(seconds=60.0)))
    assert said.startswith("keyphasor: no pulse for 2.")
    assert "though the rotor was sent to 300 rpm" in said
    assert at < 8.0 + 2.2


@pytest.mark.campaign
def test_a_keyphasor_dead_from_the_start_is_found_though_the_drive_reports_nothing(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rig.motor.on_read = lambda state: dataclasses.replace(state, speed=0.0, at_setpoint=False)

    def cable_off(block: Block) -> Block:
        block.counts[:, 4] = 0
        return block

    rig.daq.on_block = cable_off
    said, at, _ = tripped_at(rig, SLOW_ROLL)
    assert said.startswith("keyphasor: no pulse for")
    ramp = 240 / RPM / 10.0
    assert at < 2 * ramp + 2.1


def test_five_percent_of_the_frames_lost_do_not_disarm_the_keyphasor(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rng, missing = np.random.default_rng(2), 0

    def lose(block: Block) -> Block:
        nonlocal missing
        if block.first_sample >= LOOKED + 30_000 and rng.random() < 0.05:
            missing += 200
        return dataclasses.replace(block, first_sample=block.first_sample + missing)

    rig.daq.on_block = lose
    said, at, _ = tripped_at(rig, (Ramp(to=300 / RPM, rate=10.0), Dwell(seconds=60.0)))
    assert said.startswith("DAQ: 2")
    assert at < 3.0 + 8.0


@pytest.mark.parametrize("volts", [0.0, -19.0])
def test_a_dead_probe_refuses_the_start(bare: Callable[..., Bench], volts: float) -> None:
    rig = bare()

    def dead(block: Block) -> Block:
        block.counts[:, 2] = round(volts / 6e-4)
        return block

    rig.daq.on_block = dead
    result = rig.sweep(PLAN)
    assert result.trip == (
        f"probe 2x: not OK, gap voltage {volts:.1f} V for 1.0 s, want -18 to -2 V; check its gap and cable"
    )
    assert "set" not in [command[0] for command in rig.motor.commands]
    assert rig.marks() == []


def test_a_rotor_that_turns_before_the_start_is_refused_and_stopped(bare: Callable[..., Bench]) -> None:
    rig = bare(speed=1800 / RPM)
    rig.shaft.powered, rig.shaft.setpoint = True, 1800 / RPM
    result = rig.sweep(PLAN)
    assert result.trip == (
        "start: the rotor turns at 1800 rpm before the first command, want it at rest, or --rolling to take it over"
    )
    assert rig.motor.commands == [("stop", Stop.EMERGENCY)]
    assert rig.marks() == []


def test_a_rotor_that_coasts_is_refused_too(bare: Callable[..., Bench]) -> None:
    assert bare(speed=1800 / RPM).sweep(PLAN).trip.startswith("start: the rotor turns at ")


def test_a_drive_that_runs_too_slowly_to_be_seen_is_refused_by_its_own_word(bare: Callable[..., Bench]) -> None:
    rig = bare(speed=10 / RPM)
    rig.shaft.powered, rig.shaft.setpoint = True, 10 / RPM
    assert rig.sweep(PLAN).trip.startswith("start: the drive runs, at 10 rpm by its word, before the first command")


def test_rolling_takes_it_over(bare: Callable[..., Bench]) -> None:
    rig = bare(speed=300 / RPM)
    rig.shaft.powered, rig.shaft.setpoint = True, 300 / RPM
    assert rig.sweep(PLAN, rolling=True).trip == ""
    assert rig.marks() == ["slow roll", "up", "down", "end"]


def test_a_drive_that_turns_backward_trips(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rig.motor.on_read = lambda state: dataclasses.replace(state, reverse=state.running)
    said, at, fastest = tripped_at(rig, SLOW_ROLL)
    assert said.startswith("drive: turns backward at ")
    assert at < 0.5
    assert fastest * RPM < 60


def test_a_rotor_that_precesses_backward_at_slow_roll_trips(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rig.daq.vibration, rig.daq.sense = (lambda speed: 5e-6), -1.0
    said, at, _ = tripped_at(rig, SLOW_ROLL)
    assert re.match(
        r"sense of rotation: at slow roll the orbit of probes (1x and 1y|2x and 2y) is backward, 5\.0 um", said
    )
    assert at < 6.0


def test_a_rotor_that_whirls_backward_above_slow_roll_is_healthy(bare: Callable[..., Bench]) -> None:
    rig = bare()

    def whirl(speed: float) -> float:
        rig.daq.sense = -1.0 if speed > 300 / RPM else 1.0  # as between split critical speeds
        return 50e-6

    rig.daq.vibration = whirl
    said, _, _ = tripped_at(rig, (*SLOW_ROLL, Ramp(to=900 / RPM, rate=10.0), Dwell(seconds=10.0)))
    assert said == ""


def test_an_orbit_that_is_an_ellipse_says_nothing_of_the_rotation(bare: Callable[..., Bench]) -> None:
    rig = bare()
    rig.daq.vibration, rig.daq.sense = (lambda speed: 5e-6), -1.0

    def flatten(block: Block) -> Block:
        for channel in (1, 3):  # half as high as wide: forward is a third of backward
            block.counts[:, channel] = -16_667 + (block.counts[:, channel] + 16_667) * 0.45
        return block

    rig.daq.on_block = flatten
    said, _, _ = tripped_at(rig, SLOW_ROLL)
    assert said == ""


def test_samples_that_come_ever_later_trip(bare: Callable[..., Bench]) -> None:
    rig = bare()

    def fall_behind(block: Block) -> Block:
        if block.first_sample >= LOOKED + 30_000:
            rig.clock.sleep(0.01)  # a link that carries two thirds of what is sampled
        return block

    rig.daq.on_block = fall_behind
    said, at, _ = tripped_at(rig, (Ramp(to=300 / RPM, rate=10.0), Dwell(seconds=20.0)))
    assert said.startswith("DAQ: its samples arrive 0.")
    assert at < 3.0 + 1.5


def test_a_drive_that_goes_by_its_setpoint_is_believed_once_it_can_be(bare: Callable[..., Bench]) -> None:
    rig = bare()

    def setpoint(state: MotorState) -> MotorState:
        return dataclasses.replace(state, speed=state.setpoint if state.running else 0.0)

    rig.motor.on_read = setpoint
    assert tripped_at(rig, MORE)[0] == ""
