"""From the stop to rest: watched, recorded, and stopped harder when the rotor does not slow down."""

import dataclasses
import math
import signal
from collections.abc import Callable

import pytest

from rotorrig.acquisition.sweep.plans import Dwell, Mark, Ramp
from rotorrig.acquisition.sweep.rest import RotorState
from rotorrig.rig.control import DirectControl, Reading
from rotorrig.rig.errors import LimitExceeded, LinkLost, NotAtRest
from rotorrig.rig.motor.base import MotorState, Stop
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.acquisition.sweep.scripted_bench import LOOKED, Bench, MakeBench, Watching, at_sample, gone


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


def test_a_stop_that_is_never_confirmed_is_said_loudly_and_tried_until_the_operator_leaves(bench: MakeBench) -> None:
    rig = bench()

    def refuse(kind: Stop) -> None:
        raise LinkLost("drive: no answer")

    rig.motor.on_stop = refuse
    rig.daq.on_block = pressing(signal.SIGINT, 400_000, 410_000, 420_000, 430_000)
    told = Watching()
    with pytest.raises(NotAtRest, match=r"THE ROTOR IS TURNING at 573 rpm, left by the operator.*no answer.*cut its"):
        rig.sweep((Ramp(to=60.0, rate=60.0),), operator=told)
    assert rig.marks("emergency")[-1].startswith("THE ROTOR IS TURNING")
    assert told.told[0].startswith("The drive does not confirm the stop (drive: no answer)")
    assert {("stop", kind) for kind in Stop} <= set(rig.motor.commands)  # each kind was tried
    assert rig.motor.opened > 5  # the link is opened anew for every try
    assert rig.recorded().complete


def pressing(number: signal.Signals, *at: int) -> Callable[[Block], Block]:
    """Return a script that sends the process a signal so many samples after the first command, at each of these."""
    left = [LOOKED + sample for sample in at]

    def script(block: Block) -> Block:
        while left and block.first_sample >= left[0]:
            left.pop(0)
            signal.raise_signal(number)
        return block

    return script


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (signal.SIGINT, "Ctrl-C"),
        (signal.SIGTERM, "SIGTERM"),
        (signal.SIGHUP, "the terminal was closed"),
        (signal.SIGQUIT, "Ctrl-\\"),
    ],
)
def test_ctrl_c_kill_or_a_closed_terminal_abort_the_sweep_and_record_the_rotor_to_rest(
    bench: MakeBench, number: signal.Signals, name: str
) -> None:
    rig = bench()
    rig.daq.on_block = pressing(number, 20_000)
    handler = signal.getsignal(number)
    with pytest.raises(KeyboardInterrupt):
        rig.sweep()
    assert rig.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert rig.marks("abort") == [f"interrupted by the operator ({name})"]
    assert rig.marks("stop") == rig.marks("trip") == rig.marks("emergency") == []
    assert rig.marks("note")[-1].startswith("at rest")
    assert rig.recorded().complete
    assert rig.recorded().samples > LOOKED + 40_000  # two seconds from 60 rad/s at 40 rad/s^2, and two without a pulse
    assert signal.getsignal(number) is handler


def test_a_rotor_stopped_before_its_speed_is_known_is_recorded_to_rest_all_the_same(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = pressing(signal.SIGINT, 4_000)  # 24 rad/s, in the first turn
    with pytest.raises(KeyboardInterrupt):
        rig.sweep((Ramp(to=60.0, rate=60.0),))
    assert rig.shaft.speed == 0.0
    assert rig.recorded().samples > LOOKED + 24_000  # at rest, and two seconds without a pulse
    assert rig.marks("note")[-1].startswith("at rest")


def test_a_second_ctrl_c_is_an_emergency_stop(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = pressing(signal.SIGINT, 20_000, 22_000)
    with pytest.raises(KeyboardInterrupt):
        rig.sweep()
    assert rig.motor.commands[-2:] == [("stop", Stop.EMERGENCY)] * 2
    assert len(rig.marks("abort")) == 1
    assert rig.marks("emergency") == ["emergency stop by the operator"]
    assert rig.marks("note")[-1].startswith("at rest")


def test_a_rotor_that_turns_is_left_after_two_ctrl_c_once_that_was_offered_and_no_sooner(bench: MakeBench) -> None:
    rig = bench()
    rig.motor.obeys = set()
    told = Watching()
    early = [20_000 + 1000 * i for i in range(9)]
    rig.daq.on_block = pressing(signal.SIGINT, *early, 200_000, 210_000)
    with pytest.raises(NotAtRest, match=r"THE ROTOR IS TURNING at \d+ rpm, left by the operator"):
        rig.sweep(operator=told)
    assert rig.recorded().samples == LOOKED + 210_200
    assert "Ctrl-C twice leaves it" in told.told[-1]
    assert rig.recorded().complete


def test_a_signal_stops_the_rotor_before_the_loop_takes_note_of_it(bench: MakeBench) -> None:
    rig = bench()
    commands: list[list[object]] = []

    def press(block: Block) -> Block:
        if block.first_sample == LOOKED + 20_000:
            signal.raise_signal(signal.SIGTERM)
            commands.append(list(rig.motor.commands))  # a program that hangs here would not come any further
        return block

    rig.daq.on_block = press
    with pytest.raises(KeyboardInterrupt):
        rig.sweep()
    assert commands[0][-1] == ("stop", Stop.EMERGENCY)


def test_the_operator_ends_a_sweep_down_the_ramp(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep(operator=Watching(stop=lambda: rig.shaft.speed > 100))
    assert rig.motor.commands[-1] == ("stop", Stop.RAMP)
    assert (result.ending, result.trip, result.state) == ("stop", "", RotorState.AT_REST)
    assert rig.marks("stop") == ["stopped by the operator"]
    assert rig.marks() == ["slow roll", "up"]


def test_after_the_plan_the_rotor_is_recorded_to_rest(bench: MakeBench) -> None:
    rig = bench()
    result = rig.sweep((Ramp(to=60.0, rate=60.0), Mark(label="end")))
    assert result.state is RotorState.AT_REST
    assert rig.shaft.speed == 0.0
    kinds = [(event.kind, event.text) for event in result.events[1:]]
    assert kinds[:2] == [("mark", "end"), ("stop", "plan finished")]
    assert kinds[2][0] == "note"
    assert kinds[2][1].startswith("at rest")


def test_a_limit_exceeded_on_the_way_down_the_ramp_makes_it_an_emergency_stop(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.vibration = lambda speed: 50e-6 if rig.shaft.powered or not speed else 1000e-6
    result = rig.sweep((Ramp(to=120.0, rate=60.0),))
    assert rig.motor.commands[-2:] == [("stop", Stop.RAMP), ("stop", Stop.EMERGENCY)]
    assert result.trip.endswith("limit 900 um; while stopping")
    assert result.ending == "stop"


def test_a_rotor_that_does_not_slow_down_is_stopped_harder_and_then_left_without_power(bench: MakeBench) -> None:
    rig = bench()
    rig.motor.obeys = {Stop.COAST}
    result = rig.sweep((Ramp(to=60.0, rate=60.0),))
    assert rig.motor.commands[-3:] == [("stop", Stop.RAMP), ("stop", Stop.EMERGENCY), ("stop", Stop.COAST)]
    assert rig.marks("emergency") == [
        "the rotor is turning at 573 rpm, it does not slow down as it should: 'emergency'",
        "the rotor is turning at 573 rpm, it does not slow down as it should: 'coast'",
    ]
    assert result.state is RotorState.AT_REST


def test_a_drive_that_hunts_around_its_speed_does_not_pass_for_one_that_slows_down(bench: MakeBench) -> None:
    rig = bench()
    rig.motor.obeys = {Stop.COAST}
    rig.daq.on_block = hunting(rig)
    result = rig.sweep((Ramp(to=20.0, rate=60.0),))
    assert rig.motor.commands[-1] == ("stop", Stop.COAST)
    assert result.state is RotorState.AT_REST


def hunting(rig: Bench) -> Callable[[Block], Block]:
    """Return a script by which the drive's speed hunts by 1.2 rpm around its setpoint."""
    begin = [0.0]

    def script(block: Block) -> Block:
        begin[0] = begin[0] or rig.shaft.setpoint
        if rig.shaft.powered:
            rig.shaft.setpoint = begin[0] + 0.13 * math.sin(block.first_sample / 1000)
        return block

    return script


def test_a_rotor_that_never_stops_is_recorded_until_it_is_left(bench: MakeBench) -> None:
    rig = bench()
    assert rig.rig.limits
    rig.rig = rig.rig.model_copy(update={"limits": rig.rig.limits.model_copy(update={"run_down": 30.0})})
    rig.motor.obeys = set()
    rig.daq.on_block = pressing(signal.SIGINT, *(600_000 + 1000 * i for i in range(4)))
    with pytest.raises(NotAtRest):
        rig.sweep((Ramp(to=60.0, rate=60.0),))
    assert rig.recorded().samples > LOOKED + 600_000
    assert rig.motor.commands.count(("stop", Stop.EMERGENCY)) > 1  # the ladder began anew


def test_of_a_rotor_that_is_not_seen_no_more_is_recorded_than_the_config_says(bench: MakeBench) -> None:
    rig = bench()
    assert rig.rig.limits
    rig.rig = rig.rig.model_copy(update={"limits": rig.rig.limits.model_copy(update={"run_down": 30.0})})
    rig.motor.obeys = set()
    press = pressing(signal.SIGINT, *(800_000 + 1000 * i for i in range(4)))

    def dead(block: Block) -> Block:
        if block.first_sample >= LOOKED + 20_000:
            block.counts[:, rig.rig.keyphasor.channel] = 0  # type: ignore[union-attr]
        return press(block)

    rig.daq.on_block = dead
    with pytest.raises(NotAtRest):
        rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10.0)))
    assert any(text.endswith("30 s after the stop; recorded no further") for text in rig.marks("note"))
    assert rig.recorded().samples < LOOKED + 20_000 + 30_000 + 310_000


def leaving(rig: Bench, *, after: float) -> Callable[[MotorState], MotorState]:
    """Return a script of the drive's readings by which the operator presses Ctrl-C at each, once `after` s are over."""

    def script(state: MotorState) -> MotorState:
        if rig.clock.now() > after:
            signal.raise_signal(signal.SIGINT)
        return state

    return script


def test_without_samples_the_drives_word_is_no_proof_and_the_danger_is_named(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.on_block = at_sample(LOOKED + 20_000, LinkLost("DAQ: silent for 2 s"))
    rig.daq.open = gone  # type: ignore[method-assign]
    rig.motor.on_read = leaving(rig, after=60.0)
    told = Watching()
    with pytest.raises(NotAtRest, match=r"^THE ROTOR MAY STILL BE TURNING, left by the operator.*\(DAQ: silent"):
        rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10)), operator=told)
    assert any("MAY STILL BE TURNING" in text for text in told.told)
    assert rig.recorded().complete


def test_a_daq_that_is_lost_and_comes_back_proves_the_rotor_at_rest(bench: MakeBench) -> None:
    rig = bench()
    rate = rig.info.sample_rate
    lost: list[float] = []
    opens: list[float] = []
    back: list[float] = []  # when the first block came again

    def unplugged(block: Block) -> Block:
        if block.first_sample >= 4.5 * rate and not lost:
            lost.append(rig.clock.now())
        if lost and not opens:
            raise LinkLost("DAQ: unplugged")
        if lost and not back:
            back.append(rig.clock.now() - len(block.counts) / rate)
        return block

    def opened() -> DaqInfo:
        if rig.clock.now() < lost[0] + 5.0:
            raise LinkLost("DAQ: no such port")
        opens.append(rig.clock.now())
        return rig.info

    rig.daq.on_block, rig.daq.open = unplugged, opened  # type: ignore[method-assign]
    with pytest.raises(LinkLost, match=r"DAQ: unplugged; at rest \d"):
        rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10.0)))
    assert rig.shaft.speed == 0.0
    recorded = rig.recorded()
    assert [event.kind for event in recorded.events].count("gap") == 1
    (first, before), (after, _) = recorded.segments()
    assert (first, len(before)) == (0, 4.5 * rate)
    assert back[0] >= lost[0] + 5.0
    assert after / rate == pytest.approx(back[0], abs=0.1)


def test_a_rotor_that_the_guardian_has_stopped_on_its_first_ramp_is_not_taken_for_one_that_never_turned(
    bench: MakeBench,
) -> None:
    rig = bench()

    class Guarded(DirectControl):
        """Stopped by a guardian while the program hung; the drive says that it is off, and the rotor turns on."""

        def take_readings(self) -> list[Reading]:
            if rig.shaft.speed > 15.0 and self.report is None:
                rig.clock.sleep(3.0)
                self.stop(Stop.EMERGENCY)
                raise LimitExceeded("guardian: no sample was processed for 0.5 s; it has stopped the rotor")
            return super().take_readings()

    rig.motor.obeys = set()
    rig.motor.on_read = lambda state: dataclasses.replace(
        state, running=rig.motor.commands[-1:] == [("set", 60.0, 60.0)]
    )
    press = pressing(signal.SIGINT, *(600_000 + 1000 * i for i in range(4)))

    def dead(block: Block) -> Block:
        block.counts[:, rig.rig.keyphasor.channel] = 0  # type: ignore[union-attr]
        return press(block)

    rig.daq.on_block = dead
    with pytest.raises(NotAtRest, match=r"^THE ROTOR MAY STILL BE TURNING"):
        rig.sweep((Ramp(to=60.0, rate=60.0),), control=Guarded(rig.motor, clock=rig.clock))
    assert rig.shaft.speed > 15.0


def test_silence_of_keyphasor_and_drive_is_no_rest(bench: MakeBench) -> None:
    """One supply for both: the pulses end at speed, and the drive never confirms a stop."""
    rig = bench()

    def dead(block: Block) -> Block:
        if block.first_sample >= LOOKED + 20_000:
            block.counts[:, rig.rig.keyphasor.channel] = 0  # type: ignore[union-attr]
        return press(block)

    def unconfirmed(kind: Stop) -> None:
        raise LinkLost("drive: no answer")

    def unheard(state: MotorState) -> MotorState:
        if rig.clock.now() >= 4.5:
            raise LinkLost("drive: no answer")
        return state

    press = pressing(signal.SIGINT, *(600_000 + 1000 * i for i in range(4)))
    rig.daq.on_block, rig.motor.on_stop, rig.motor.on_read = dead, unconfirmed, unheard
    with pytest.raises(NotAtRest, match=r"^THE ROTOR MAY STILL BE TURNING, left by the operator"):
        rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10)))
    assert rig.shaft.speed == 60.0


def test_of_a_rotor_without_keyphasor_pulses_the_drives_word_counts_once_a_probe_sees_nothing_move(
    bench: MakeBench,
) -> None:
    rig = bench()

    def dead(block: Block) -> Block:
        if block.first_sample > LOOKED + 40_000:
            block.counts[:, rig.rig.keyphasor.channel] = 0  # type: ignore[union-attr]
        return block

    rig.daq.on_block = dead
    rig.daq.vibration = lambda speed: 50e-6 if speed else 0.0
    result = rig.sweep((Ramp(to=60.0, rate=60.0), Dwell(seconds=10)))
    assert "keyphasor" in result.trip
    assert result.state is RotorState.AT_REST
    assert rig.shaft.speed == 0.0
    end = rig.recorded().samples / 1e4
    trip = next(event.t_ns / 1e9 for event in result.events if event.kind == "trip")
    assert end - trip > 8.0  # the stretch a turn at 30 rpm would show in


def test_a_terminal_that_dies_ends_no_retries(bench: MakeBench) -> None:
    rig = bench()
    left = [20]

    def hiccup(kind: Stop) -> None:
        left[0] -= 1
        if left[0] > 0:
            raise LinkLost("drive: no answer")

    class Deaf(Watching):
        def tell(self, text: str) -> None:
            raise BrokenPipeError("the terminal is gone")

    rig.motor.on_stop = hiccup
    result = rig.sweep((Ramp(to=60.0, rate=60.0),), operator=Deaf())
    assert left[0] <= 0
    assert result.state is RotorState.AT_REST
    assert rig.shaft.speed == 0.0


def test_a_rotor_seen_to_come_to_rest_is_no_danger_though_the_drive_says_nothing(bench: MakeBench) -> None:
    rig = bench()

    def dead_when_fast(state: object) -> object:
        if rig.shaft.speed > 100:
            rig.shaft.powered = False  # its own watchdog
            raise LinkLost("drive: no answer")
        return state

    def unconfirmed(kind: Stop) -> None:
        raise LinkLost("drive: no answer to the stop")

    rig.motor.on_read = dead_when_fast  # type: ignore[assignment]
    rig.motor.on_stop = unconfirmed
    with pytest.raises(
        LinkLost, match=r"^drive: no answer; at rest [\d.]+ s after the stop; the drive confirmed no stop"
    ):
        rig.sweep()
    assert "the drive confirmed no stop" in rig.marks("note")[-1]


def test_it_is_told_when_the_samples_came_and_the_stop_went_out(bench: MakeBench) -> None:
    rig = bench()
    rig.daq.vibration = lambda speed: 50e-6 if speed < 100 else 1000e-6
    result = rig.sweep()
    (trip,) = [event for event in result.events if event.kind == "trip"]
    times = result.stop_times
    assert times
    assert times.received == times.decided == times.handed == times.confirmed == pytest.approx(trip.t_ns / 1e9)
