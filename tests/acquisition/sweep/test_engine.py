"""A sweep on a scripted rig: in order, whole on record, and ended in words whatever ends it."""

import dataclasses
import math

import numpy as np
import pytest

from rotorrig.acquisition.sweep.plans import Ask, Dwell, Mark, Ramp, Rest, Step, Trial
from rotorrig.processing.pipeline import track
from rotorrig.processing.settings import Tracking
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.config.units import RPM
from rotorrig.rig.errors import ConfigError, DataError, LinkLost, NotAtRest
from rotorrig.rig.motor.base import MotorState, Stop
from rotorrig.rig.probes.base import Block, DaqCounters, DaqInfo
from tests.acquisition.sweep.scripted_bench import LOOKED, PLAN, Bench, MakeBench, Watching, at_sample, gone
from tests.acquisition.sweep.scripted_rig import SCANS


def test_a_plan_is_run_in_order_and_the_rotor_stopped_down_the_ramp(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep()
    assert rig.motor.commands == [
        ("set", 60.0, 60.0),
        ("set", 120.0, 30.0),
        ("stop", Stop.COAST),
        ("stop", Stop.RAMP),
    ]
    assert rig.marks() == ["slow roll", "up", "down", "end"]
    assert result.trip == ""
    assert result.gaps == 0
    assert not rig.daq.streaming


def test_a_trial_mass_is_noted_before_the_first_run(bench: MakeBench) -> None:
    rig = bench()
    rig.sweep((Trial(mass="disk: 12 g mm at 90 deg"), *PLAN))
    assert rig.marks("trial") == ["disk: 12 g mm at 90 deg"]
    assert rig.recorded().events[1].kind == "trial"  # the first says when the recording began


MOUNTING: tuple[Step, ...] = (
    *PLAN,
    Rest(),
    Ask(request="mount 'disk: 12 g mm at 90 deg'"),
    Trial(mass="disk: 12 g mm at 90 deg"),
    *PLAN,
)


def turned_by_hand(rig: Bench, *, seconds: float) -> Watching:
    """Return an operator who pushes the shaft out of the probes' range and is done after a while."""
    done_at: list[float] = []

    def answer() -> bool:
        done_at.append(rig.clock.now() + seconds) if not done_at else None
        rig.daq.vibration = lambda speed: 2000e-6 if rig.clock.now() < done_at[0] else 50e-6
        return rig.clock.now() > done_at[0]

    return Watching(answer=answer)


def test_a_trial_mass_is_mounted_at_rest_with_the_limits_off_and_what_hands_do_is_not_recorded(
    bench: MakeBench,
) -> None:
    rig = bench()
    operator = turned_by_hand(rig, seconds=60.0)
    result = rig.sweep(MOUNTING, operator=operator)
    assert result.trip == ""
    assert operator.asked == ["mount 'disk: 12 g mm at 90 deg'"]
    assert [command[0] for command in rig.motor.commands] == ["set", "set", "stop", "stop"] * 2
    at = {event.kind: event.t_ns / 1e9 for event in result.events}
    assert at["trial"] - at["pause"] == pytest.approx(60.0, abs=0.1)
    assert result.gaps == 0
    (first, before), (then, after) = rig.recorded().segments()
    assert first == 0
    assert then - len(before) == pytest.approx(60.0 * 1e4, abs=1000)
    assert np.abs(after[:, 0] * 6e-4 + 10.0).max() / 7874.0 < 100e-6
    assert rig.marks() == ["slow roll", "up", "down", "end"] * 2


def test_baseline_and_trial_runs_of_one_recording_are_told_apart(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.vibration = lambda speed: 50e-6 * (speed / 100) ** 2
    rig.sweep((*MOUNTING, Ramp(to=120.0, rate=30.0)), operator=Watching())
    response = track(rig.recorded(), Tracking(orders=(1.0,)))
    assert [(run.name, run.trial_unbalance) for run in response.runs] == [
        ("slow roll", {}),
        ("up", {}),
        ("down", {}),
        ("slow roll 2", {"disk": pytest.approx(12e-6j)}),
        ("up 2", {"disk": pytest.approx(12e-6j)}),
        ("down 2", {"disk": pytest.approx(12e-6j)}),
    ]
    assert set(response.run) == set(range(6))


def test_a_drive_that_starts_while_the_rotor_is_worked_on_trips(bench: MakeBench) -> None:
    rig = bench()
    operator = Watching(answer=lambda: False)

    def started(state: MotorState) -> MotorState:
        stopped = ("stop", Stop.EMERGENCY) in rig.motor.commands
        return dataclasses.replace(state, running=True, speed=10.0) if operator.asked and not stopped else state

    rig.motor.on_read = started
    result = rig.sweep(MOUNTING, operator=operator)
    assert result.trip == "drive: runs at 95 rpm while the rotor is worked on"
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)


def test_a_plan_that_asks_needs_somebody_to_ask(bench: MakeBench) -> None:
    rig = bench()
    with pytest.raises(ConfigError, match="want an operator to ask"):
        rig.sweep(MOUNTING)
    assert rig.motor.commands == []
    rig.writer.close()


def test_the_rate_changes_on_the_way_without_a_halt(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep((Ramp(to=120.0, rate=20.0, until=60.0), Mark(label="band"), Ramp(to=120.0, rate=60.0)))
    assert rig.motor.commands[:2] == [("set", 120.0, 20.0), ("set", 120.0, 60.0)]
    (at,) = [event.t_ns / 1e9 for event in result.events if event.kind == "mark"]
    late = 3 * 2 * math.pi / 60.0  # the keyphasor's median of five turns
    assert 3.0 <= at - LOOKED / 1e4 <= 3.0 + late


def test_what_the_daq_counted_stands_at_the_end_of_the_recording(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.counters = DaqCounters(damaged_frames=3, saturated=(0, 2, 0, 0, 7))
    rig.sweep()
    assert rig.marks("note")[-2:] == [
        "3 frames of the DAQ arrived damaged",
        "probe 1y (channel 1): 2 samples at the end of the DAQ's range",
    ]


def test_steps_take_the_time_they_should_by_the_sample_clock(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep()
    at = {event.text: event.t_ns / 1e9 - LOOKED / 1e4 for event in result.events if event.kind == "mark"}
    # by the scripted shaft: 1 s ramp, 1 s dwell | 2 s ramp | 1.5 s coast. The keyphasor's median of five turns says
    # so three turns late, the drive is asked a quarter of a second later at most
    late = 3 * 2 * math.pi / 60.0 + 0.25
    assert at["slow roll"] == 0.0
    assert 2.0 <= at["up"] <= 2.0 + late
    assert 2.0 <= at["down"] - at["up"] <= 2.0 + late
    assert 1.5 - late <= at["end"] - at["down"] <= 1.5 + late


def test_everything_the_daq_sent_is_in_the_recording(bench: MakeBench) -> None:
    rig = bench()
    sent: list[Block] = []
    rig.daq.on_block = lambda block: sent.append(block) or block  # type: ignore[func-returns-value]
    result = rig.sweep()
    read = rig.recorded()
    assert read.complete
    assert result.samples == read.samples == 200 * len(sent)
    assert result.seconds == pytest.approx(read.samples / 1e4)
    for ours, theirs in zip(read.blocks, sent, strict=True):
        assert np.array_equal(ours.counts, theirs.counts)
    assert read.events == result.events


def test_the_drive_is_asked_four_times_a_second(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10.0)))
    readings = rig.recorded().motor
    assert 35 <= len(readings) <= 4 * result.seconds + 5
    held = [sample for sample in readings if 2 < sample.t_ns / 1e9 - LOOKED / 1e4 < 10]
    assert len(held) in (31, 32)  # of eight seconds
    assert {sample.setpoint for sample in held} == {60.0}
    assert held[-1].speed == pytest.approx(60.0)


def test_progress_rises_from_0_to_1(bench: MakeBench) -> None:
    told: list[tuple[Step, float, float]] = []
    bench().sweep(progress=lambda *what: told.append(what))
    fractions = [fraction for _, fraction, _ in told]
    assert fractions == sorted(fractions)
    assert 0 <= fractions[0] < 0.05
    assert 0.9 < fractions[-1] <= 1
    assert max(speed for _, _, speed in told) == pytest.approx(120.0, rel=0.01)


def test_too_much_vibration_trips_and_the_tripping_block_is_on_record(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.vibration = lambda speed: 50e-6 if speed < 100 else 1000e-6
    result = rig.sweep()
    assert "probe" in result.trip
    assert "limit 900 um" in result.trip
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks("trip") == [result.trip]
    (tripped,) = [event.t_ns for event in result.events if event.kind == "trip"]
    last = [block for block in rig.recorded().blocks if block.t_ns < tripped][-1]
    assert np.abs(last.counts[:, 0] * 6e-4 + 10.0).max() / 7874.0 > 900e-6
    assert rig.marks() == ["slow roll", "up"]


def test_overspeed_trips(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep((Ramp(to=4100 / RPM, rate=400.0), Mark(label="never")))
    assert result.trip.startswith("overspeed")
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks() == []


def test_a_drive_in_fault_trips(bench: MakeBench) -> None:
    rig = bench()
    rig.motor.on_read = lambda state: dataclasses.replace(state, fault="overcurrent") if state.speed > 80 else state
    result = rig.sweep()
    assert "overcurrent" in result.trip
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert "overcurrent" in [sample.fault for sample in rig.recorded().motor]


def test_a_drive_that_somebody_else_has_stopped_trips(bench: MakeBench) -> None:
    rig = bench()

    def pressed(state: MotorState) -> MotorState:
        rig.shaft.powered &= state.speed < 80
        return dataclasses.replace(state, running=rig.shaft.powered)

    rig.motor.on_read = pressed
    assert rig.sweep().trip == (
        "drive: is off, though it was sent to 1146 rpm; was it stopped by hand or by its watchdog?"
    )


def test_a_drive_that_does_not_get_there_trips_and_says_what_was_read(bench: MakeBench) -> None:
    result = bench(stuck_at=90.0).sweep()
    assert result.trip == (
        "ramp to 1146 rpm: not there after 24 s, the keyphasor reads 859 rpm and the drive reports 859 rpm, "
        "not at its setpoint of 1146 rpm"
    )


def test_a_rotor_that_does_not_follow_its_drive_trips(bench: MakeBench) -> None:
    rig = bench(stuck_at=90.0)
    rig.motor.on_read = lambda state: dataclasses.replace(state, speed=state.setpoint, at_setpoint=True)
    assert rig.sweep().trip == (
        "ramp to 1146 rpm: the rotor does not follow, for 5 s the keyphasor reads 859 rpm and the drive reports "
        "1146 rpm, at its setpoint of 1146 rpm"
    )


def test_slip_is_noted_and_the_sweep_goes_on(bench: MakeBench) -> None:
    rig = bench(slip=0.03)
    result = rig.sweep()
    assert result.trip == ""
    assert "steady at 1111.5 rpm, asked for 1145.9 rpm: slip" in rig.marks("note")


def test_a_silent_daq_stops_the_rotor_and_leaves_a_whole_recording(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = at_sample(LOOKED + 20_000, LinkLost("DAQ at /dev/ttyACM0: silent for 2 s"))
    rig.daq.open = gone  # type: ignore[method-assign]
    with pytest.raises(NotAtRest, match=r"MAY STILL BE TURNING, left by the operator.*\(DAQ.*silent for 2 s\)"):
        rig.sweep()  # nobody sees whether it turns: the drive's word is no proof
    assert ("stop", Stop.EMERGENCY) in rig.motor.commands
    assert rig.recorded().samples == LOOKED + 20_000
    assert rig.marks("emergency")[0] == "DAQ at /dev/ttyACM0: silent for 2 s"
    assert "nothing proves that it is at rest" in rig.marks("emergency")[-1]


def test_a_lost_drive_is_still_told_to_stop(bench: MakeBench) -> None:
    rig = bench()

    def lost(state: MotorState) -> MotorState:
        if state.speed > 80:
            raise LinkLost("drive: no answer")
        return state

    rig.motor.on_read = lost
    with pytest.raises(LinkLost, match="no answer"):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.recorded().complete


def test_a_defect_of_the_program_stops_the_rotor_too(bench: MakeBench) -> None:
    rig = bench()

    def broken(*what: object) -> None:
        raise ZeroDivisionError("division by zero")

    with pytest.raises(ZeroDivisionError):
        rig.sweep(progress=broken)
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks("abort") == ["ZeroDivisionError: division by zero"]


def test_a_recorder_that_fails_ends_the_sweep(bench: MakeBench) -> None:
    rig = bench()
    write = rig.writer.write_block

    def full(block: Block) -> None:
        if block.first_sample >= LOOKED + 10_000:
            raise DataError("run.mcap: cannot be written any further (No space left on device)")
        write(block)

    rig.writer.write_block = full  # type: ignore[method-assign]
    with pytest.raises(DataError, match="No space left"):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.recorded().samples == LOOKED + 10_000


def test_gaps_are_counted_and_noted_where_they_are(bench: MakeBench) -> None:
    rig = bench()

    def lose(block: Block) -> Block:
        late = 300 if block.first_sample >= LOOKED + 8_000 else 0
        return dataclasses.replace(
            block,
            first_sample=block.first_sample + late,
            t_ns=block.t_ns + late * 100_000,
            overrun=block.first_sample == LOOKED + 8_000,
        )

    rig.daq.on_block = lose
    result = rig.sweep()
    assert result.gaps == 1
    assert rig.marks("gap") == ["300 samples are missing"]
    assert len(rig.marks("overrun")) == 1
    assert [event.t_ns for event in result.events if event.kind == "gap"] == [3_300_000_000]
    assert [first for first, _ in rig.recorded().segments()] == [0, LOOKED + 8_300]


def test_a_daq_that_begins_again_ends_the_sweep_and_is_opened_again_to_see_the_rotor_stop(bench: MakeBench) -> None:
    rig = bench()
    reset: list[Block] = []

    def begin_again(block: Block) -> Block:
        if block.first_sample < LOOKED + 4_000 or reset:
            return block
        reset.append(block)
        return dataclasses.replace(block, first_sample=0)

    rig.daq.on_block = begin_again
    with pytest.raises(LinkLost, match=r"restarted at sample 0 after sample 29000.*; at rest \d"):
        rig.sweep()
    (first, before), (after, _) = rig.recorded().segments()
    assert (first, len(before)) == (0, LOOKED + 4_000)
    assert after > LOOKED + 4_000


@pytest.mark.parametrize("before", [1, 3, 10])
def test_a_daq_that_begins_again_at_once_ends_the_stream_for_good(bench: MakeBench, before: int) -> None:
    """What it streams after that goes on past the samples of before, under indices that are not its own."""
    rig = bench()
    rig.daq.on_block = lambda block: (
        dataclasses.replace(block, first_sample=block.first_sample - before * SCANS)
        if block.first_sample >= before * SCANS
        else block
    )
    rig.daq.open = gone  # type: ignore[method-assign]
    with pytest.raises(NotAtRest, match=f"restarted at sample 0 after sample {before * SCANS}"):
        rig.sweep()
    assert rig.recorded().samples == before * SCANS
    assert all(event.t_ns == before * SCANS * 100_000 for event in rig.recorded().events if event.kind == "emergency")


def test_a_viewer_that_fails_is_noted_and_nothing_else(bench: MakeBench) -> None:
    rig = bench()

    def broken(block: Block) -> None:
        raise RuntimeError("no display")

    assert rig.sweep(listeners=[broken]).trip == ""
    assert any("no display" in note for note in rig.marks("note"))


def test_a_rig_without_a_keyphasor_cannot_be_swept(rig: RigConfig, daq_info: DaqInfo, bench: MakeBench) -> None:
    scripted = bench()
    scripted.rig = rig.model_copy(update={"keyphasor": None})
    with pytest.raises(ConfigError, match="keyphasor"):
        scripted.sweep()
    assert scripted.motor.commands == []
    scripted.writer.close()
