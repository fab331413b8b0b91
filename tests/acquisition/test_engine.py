import dataclasses
import math
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rotorrig.acquisition.engine import SweepResult, run_sweep
from rotorrig.acquisition.mcap_file import RecordingWriter, read_recording
from rotorrig.acquisition.plans import Coast, Dwell, Mark, Ramp, Step, Trial
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.clock import ManualClock
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import ConfigError, DataError, LinkLost
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorState, Stop
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance
from rotorrig.rig.units import RPM
from tests.acquisition.scripted_rig import ScriptedDaq, ScriptedMotor, Shaft

PLAN: tuple[Step, ...] = (
    Mark(label="slow roll"),
    Ramp(to=60.0, rate=60.0),
    Dwell(seconds=1.0),
    Mark(label="up"),
    Ramp(to=120.0, rate=30.0),
    Mark(label="down"),
    Coast(until=60.0),
    Mark(label="end"),
)


class Bench:
    """A scripted rig and the file its sweep goes to."""

    def __init__(self, rig: RigConfig, info: DaqInfo, source: Provenance, path: Path, shaft: Shaft) -> None:
        self.clock = ManualClock()
        self.motor = ScriptedMotor(shaft)
        self.daq = ScriptedDaq(rig, info, shaft, self.clock)
        self.rig, self.info, self.path = rig, info, path
        self.writer = RecordingWriter(path, rig, info, source)

    def sweep(self, steps: tuple[Step, ...] = PLAN, **more: object) -> SweepResult:
        return run_sweep(
            steps,
            motor=self.motor,
            daq=self.daq,
            rig=self.rig,
            writer=self.writer,
            interlock=Interlock(self.rig, self.info),
            clock=self.clock,
            **more,  # type: ignore[arg-type]
        )

    def recorded(self) -> RawRecording:
        return read_recording(self.path)

    def marks(self, kind: str = "mark") -> list[str]:
        return [event.text for event in self.recorded().events if event.kind == kind]


MakeBench = Callable[..., Bench]


@pytest.fixture
def bench(rig: RigConfig, daq_info: DaqInfo, source: Provenance, tmp_path: Path) -> MakeBench:
    def make(**shaft: float) -> Bench:
        return Bench(rig, daq_info, source, tmp_path / "run.mcap", Shaft(**shaft))

    return make


def at_sample(limit: int, error: BaseException) -> Callable[[Block], Block]:
    """Return a script that raises once the stream has come to sample `limit`."""

    def script(block: Block) -> Block:
        if block.first_sample >= limit:
            raise error
        return block

    return script


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


def test_steps_take_the_time_they_should_by_the_sample_clock(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep()
    at = {event.text: event.t_ns / 1e9 for event in result.events if event.kind == "mark"}
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
    assert [sample.setpoint for sample in readings[-30:]] == [60.0] * 30
    assert readings[-1].speed == pytest.approx(60.0)


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
    last = rig.recorded().blocks[-1].counts[:, 0] * 6e-4 + 10.0
    assert np.abs(last / 7874.0).max() > 900e-6
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
    assert rig.recorded().motor[-1].fault == "overcurrent"


def test_a_drive_that_does_not_get_there_trips_and_says_what_was_read(bench: MakeBench) -> None:
    result = bench(stuck_at=90.0).sweep()
    assert result.trip == (
        "ramp to 1146 rpm: not there after 24 s, the keyphasor reads 859 rpm and the drive reports 859 rpm, "
        "not at its setpoint of 1146 rpm"
    )


def test_slip_is_noted_and_the_sweep_goes_on(bench: MakeBench) -> None:
    rig = bench(slip=0.03)
    result = rig.sweep()
    assert result.trip == ""
    assert "steady at 1111.5 rpm, asked for 1145.9 rpm: slip" in rig.marks("note")


def test_a_silent_daq_stops_the_rotor_and_leaves_a_whole_recording(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = at_sample(20_000, LinkLost("DAQ at /dev/ttyACM0: silent for 2 s"))
    with pytest.raises(LinkLost, match="silent for 2 s"):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.recorded().samples == 20_000
    assert rig.marks("stop") == ["DAQ at /dev/ttyACM0: silent for 2 s"]


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


@pytest.mark.parametrize("refusal", [LinkLost("drive: no answer"), OSError("port is gone"), RuntimeError("defect")])
def test_a_stop_is_tried_again_when_the_link_hiccups(bench: MakeBench, refusal: Exception) -> None:
    rig = bench()
    answers: list[Exception | None] = [refusal, refusal, None]

    def hiccup(kind: Stop) -> None:
        if kind is Stop.RAMP and (answer := answers.pop(0)):
            raise answer

    rig.motor.on_stop = hiccup
    assert rig.sweep().trip == ""
    assert rig.motor.commands[-3:] == [("stop", Stop.RAMP)] * 3


def test_a_stop_that_is_never_confirmed_is_said_loudly(bench: MakeBench) -> None:
    rig = bench()

    def refuse(kind: Stop) -> None:
        raise LinkLost("drive: no answer")

    rig.motor.on_stop = refuse
    with pytest.raises(LinkLost, match=r"THE ROTOR MAY STILL BE TURNING.*no answer.*cut its power"):
        rig.sweep((Ramp(to=60.0, rate=60.0),))
    assert "THE ROTOR MAY STILL BE TURNING" in rig.marks("stop")[0]
    assert rig.recorded().complete


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_ctrl_c_kill_or_a_closed_terminal_stop_the_rotor_and_a_second_one_cannot_keep_it_from_that(
    bench: MakeBench, number: signal.Signals
) -> None:
    rig = bench()

    def press(block: Block) -> Block:
        if block.first_sample >= 20_000:
            signal.raise_signal(number)
        return block

    rig.daq.on_block = press
    rig.motor.on_stop = lambda kind: signal.raise_signal(number)
    handler = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks("stop") == ["interrupted by the operator"]
    assert rig.recorded().complete
    assert signal.getsignal(number) is handler


def test_a_defect_of_the_program_stops_the_rotor_too(bench: MakeBench) -> None:
    rig = bench()

    def broken(*what: object) -> None:
        raise ZeroDivisionError("division by zero")

    with pytest.raises(ZeroDivisionError):
        rig.sweep(progress=broken)
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks("stop") == ["ZeroDivisionError: division by zero"]


def test_a_recorder_that_fails_ends_the_sweep(bench: MakeBench) -> None:
    rig = bench()
    write = rig.writer.block

    def full(block: Block) -> None:
        if block.first_sample >= 10_000:
            raise DataError("run.mcap: cannot be written on (No space left on device)")
        write(block)

    rig.writer.block = full  # type: ignore[method-assign]
    with pytest.raises(DataError, match="No space left"):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.recorded().samples == 10_000


def test_gaps_are_counted_and_noted_where_they_are(bench: MakeBench) -> None:
    rig = bench()

    def lose(block: Block) -> Block:
        late = 300 if block.first_sample >= 8_000 else 0
        return dataclasses.replace(
            block,
            first_sample=block.first_sample + late,
            t_ns=block.t_ns + late * 100_000,
            overrun=block.first_sample == 8_000,
        )

    rig.daq.on_block = lose
    result = rig.sweep()
    assert result.gaps == 1
    assert rig.marks("gap") == ["300 samples are missing"]
    assert len(rig.marks("overrun")) == 1
    assert [event.t_ns for event in result.events if event.kind == "gap"] == [800_000_000]
    assert [first for first, _ in rig.recorded().segments()] == [0, 8_300]


def test_a_daq_that_begins_again_ends_the_sweep(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = lambda block: (
        dataclasses.replace(block, first_sample=0) if block.first_sample == 4_000 else block
    )
    with pytest.raises(LinkLost, match="begun again at sample 0 after sample 4000"):
        rig.sweep()
    assert rig.recorded().samples == 4_000


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
