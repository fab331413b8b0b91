"""Per-block loop of a sweep: check limits, record, publish to viewers, poll the motor.

`take_block` is called for every block; `command_speed` and `command_stop` are a plan's own steps, `stop_rotor` ends it.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.acquisition.sweep.fanout import Item, Listener, Recorder, Viewer, Writer
from rotorrig.acquisition.sweep.rest import RestEvidence, RotorState
from rotorrig.rig import Clock, ConfigError, Interlock, LimitExceeded, LinkLost, RigError
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.control import MotorControl, Reading, SetSpeed, StopForNow, StopReport
from rotorrig.rig.motor import MotorState, Stop
from rotorrig.rig.probes import Block, Daq, LostDaq

DAQ_TIMEOUT = 2.0  # s of wall time the DAQ may be silent
STEADY_BAND = 0.005  # relative; a speed is steady while it stays within this of where it settled


@dataclass(frozen=True, slots=True)
class Steadiness:
    """Speed [rad/s] the shaft has kept to, and since when [s]."""

    speed: float
    since: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StopTimes:
    """Times of the events that stopped the rotor, s on the session's clock; NaN: did not happen."""

    received: float  # the last block before the stop came from the DAQ
    decided: float  # the stop was decided and passed to the motor control
    handed: float  # the driver's `stop` was called
    confirmed: float  # the drive had obeyed


class Session:
    """State and devices of a running sweep, and the work done for every block, whatever the step."""

    def __init__(
        self,
        *,
        control: MotorControl,
        daq: Daq,
        rig: RigConfig,
        writer: Writer,
        interlock: Interlock,
        listeners: Sequence[Listener],
        clock: Clock,
        speed: float = 0.0,
    ) -> None:
        """Start the recorder's and viewers' threads; `speed` [rad/s] is what the rotor may have already.

        Raises ConfigError without a keyphasor.
        """
        if interlock.keyphasor is None:
            raise ConfigError("keyphasor: missing in the config, want [keyphasor]: a sweep goes by its speed")
        self.control = control
        self.clock = clock
        self.events: list[Event] = []
        self.samples = 0  # recorded
        self.gaps = 0  # places where samples are missing
        self.motor_state: MotorState | None = None  # the controller's last reading since the last command
        self.commanded_speed = 0.0  # rad/s, by the last command; 0: it was a stop
        self.limits_armed = True  # False: the rotor is being stopped, or is at rest and worked on
        self.recording_paused = False  # True: blocks are not recorded
        self.recorder_alive = True  # False: the recorder has failed and the rotor is being stopped
        self.last_beat = self.last_block = clock.now()  # when the loop last gave a sign of life, and had samples
        self._daq, self._interlock, self._keyphasor = daq, interlock, interlock.keyphasor
        self._evidence = RestEvidence(rig, interlock.keyphasor)
        self._fastest = speed  # rad/s, that the rotor can have come to by the ramps asked for
        self._ramp, self._commanded_at = 0.0, 0.0  # rad/s^2 and sample time of the last command
        self._stopped_at = 0.0  # sample time of the stop for good
        self._names = {probe.channel: f"probe {probe.name}" for probe in rig.probes}
        self._recorder = Recorder(writer)
        self._viewers = [Viewer(listener) for listener in listeners]
        self._next_sample: int | None = None  # None: no block yet
        self._restart = ""  # of the DAQ, which ended its stream; empty: none
        self._shift = 0  # added to the sample index of a stream that was begun again
        self._lost: LostDaq | None = None
        self._commands_sent = 0  # number of the last command
        self._steadiness = Steadiness(0.0, 0.0)
        self._received = self._decided = math.nan
        self._first_stop: StopReport | None = None  # once there was another

    @property
    def t(self) -> float:
        """Seconds of the sample clock up to the end of the last block."""
        return self._keyphasor.time

    @property
    def speed(self) -> float:
        """Shaft speed [rad/s] by the keyphasor."""
        return float(self._keyphasor.steady_speed)

    @property
    def pulse_age(self) -> float:
        """Seconds since the keyphasor's last pulse, or since the first sample where there was none."""
        return self._keyphasor.age

    @property
    def steady_for(self) -> float:
        """Seconds for which the speed has been steady."""
        return self.t - self._steadiness.since

    @property
    def rest(self) -> RotorState:
        """Whether the rotor is at rest, by the evidence so far."""
        off = self.motor_state is not None and not self.motor_state.running
        fastest = self._fastest + self._risen()
        return self._evidence.judge(drive_off=off, fastest=fastest, stopped_at=self._stopped_at)

    @property
    def stop_times(self) -> StopTimes | None:
        """Times of the first stop; None: there was none."""
        report = self._first_stop or self.control.report
        if report is None:
            return None
        return StopTimes(
            received=self._received, decided=self._decided, handed=report.handed, confirmed=report.confirmed
        )

    def note(self, kind: str, text: str, *, t: float | None = None) -> None:
        """Record an event at the present sample, or at `t` [s]."""
        event = Event(t_ns=round((self.t if t is None else t) * 1e9), kind=kind, text=text)
        self.events.append(event)
        self._record(event)

    def command_speed(self, speed: float, *, ramp: float) -> None:
        """Send the motor to `speed` [rad/s] at `ramp` [rad/s^2]; `take_block` raises what goes wrong."""
        self.motor_state = None
        self._note_fastest()
        self.commanded_speed, self._ramp, self._commanded_at = speed, ramp, self.t
        self._interlock.command(speed, ramp=ramp)
        self._commands_sent = self.control.send(SetSpeed(speed=speed, ramp=ramp))

    def command_stop(self, kind: Stop) -> None:
        """Stop the motor as a step of the plan: it may be started again. `take_block` raises what goes wrong."""
        self.motor_state = None
        self._note_fastest()
        self.commanded_speed, self._stopped_at = 0.0, self.t
        self._interlock.command(0.0)
        self._commands_sent = self.control.send(StopForNow(kind=kind))

    def stop_rotor(self, kind: Stop) -> None:
        """Stop the rotor now and for good: later commands are refused. Returns at once; signal handlers may call it."""
        self.note_stop()
        self._first_stop = self._first_stop or self.control.report
        self.control.stop(kind)
        self.motor_state, self.commanded_speed = None, 0.0
        if kind is Stop.RAMP:  # the one under which limits stay armed; another may come from a signal handler
            self._interlock.command(0.0)

    def note_stop(self) -> None:
        """Take note that the rotor is being stopped for good, by whomever."""
        if math.isnan(self._decided):
            self._decided, self._stopped_at = self.clock.now(), self._time_by_the_wall()
            self._note_fastest()
            self.commanded_speed = 0.0

    def check_standstill(self, state: MotorState) -> None:
        """Check before the first command that the rotor is at rest. Raises LimitExceeded."""
        self._interlock.check_standstill(state)
        self._evidence.take_as_rest()

    def _note_fastest(self) -> None:
        self._fastest += self._risen()

    def _risen(self) -> float:
        """Return by how much [rad/s] the rotor can have become faster since the last command."""
        return min(self.commanded_speed, self._ramp * (self._time_by_the_wall() - self._commanded_at))

    def _time_by_the_wall(self) -> float:
        """Sample time now [s]: the last samples are old if this program hung."""
        return self.t + self.clock.now() - self.last_block

    def start(self) -> None:
        """Start the motor control and the DAQ's stream."""
        self.control.start()
        self._daq.start()

    def take_block(self) -> None:
        """Take the next block, check it, record it. Raises LinkLost, LimitExceeded and what recording raises.

        If a limit is exceeded, the stop is on its way before this raises.
        """
        block = self._daq.read(DAQ_TIMEOUT)
        if self._shift:
            block = self._put_in_place(block)
        self.last_block = self.last_beat = self.clock.now()
        self._check_restart(block)
        if math.isnan(self._decided):
            self._received = self.last_beat
        before = self.t
        try:
            self._check_limits(block)
        finally:  # the block that trips is the one worth having
            self._record_and_show(block, after=before)
        self._evidence.take(block)
        self.beat()
        if abs(self.speed - self._steadiness.speed) > STEADY_BAND * self._steadiness.speed:
            self._steadiness = Steadiness(self.speed, self.t)
        self.poll_motor()

    def beat(self) -> None:
        """Give a sign of life: without it the motor is no longer read, and its watchdog stops the rotor."""
        self.last_beat = self.clock.now()
        self.control.beat(self.t)

    def bring_back_samples(self) -> bool:
        """Return True once a DAQ whose samples have ended gives them again; their place in time is by the wall clock.

        To be called again and again; never waits.
        """
        info = self._keyphasor.info
        self._lost = self._lost or LostDaq(self._daq, info, self.clock)
        if not self._lost.is_back():
            return False
        self._lost, self._restart = None, ""
        self._shift = (self._next_sample or 0) + round((self.clock.now() - self.last_block) * info.sample_rate)
        return True

    def poll_motor(self) -> None:
        """Record and check the motor readings since the last call. Raises LinkLost, LimitExceeded."""
        for reading in self.control.take_readings():
            self._check_reading(reading)

    def close(self, *, at_rest: bool) -> None:
        """End the stream and close the recording. Raises what recording raises."""
        try:
            self.control.close(at_rest=at_rest)
            for viewer in self._viewers:
                viewer.close()
                if viewer.fault:
                    self.note("note", f"a viewer failed and was left out from there on: {viewer.fault}")
            if self._lost:
                self._lost.give_up()
            with suppress(RigError):  # a DAQ that does not confirm its stop: the recording has what it sent
                self._daq.stop()
            for remark in self._daq.counters.remarks(self._names):
                self.note("note", remark)
        finally:
            self._recorder.close()

    def _check_limits(self, block: Block) -> None:
        if not self.limits_armed:
            self._interlock.follow(block)
            return
        try:
            self._interlock.check(block, now=self.last_beat)
        except LimitExceeded:
            self.stop_rotor(Stop.EMERGENCY)  # before anything else
            raise

    def _check_reading(self, reading: Reading) -> None:
        state = reading.state
        if reading.commands_done >= self._commands_sent:
            self.motor_state = state
        self._record(
            MotorSample(
                t_ns=round(self.t * 1e9),
                speed=state.speed,
                setpoint=state.setpoint,
                running=state.running,
                fault=state.fault,
            )
        )
        if not self.limits_armed:
            return
        try:
            self._interlock.check_motor(state)
            if self.motor_state is not None and self.commanded_speed and not state.running:
                raise LimitExceeded(
                    f"drive: is off, though it was sent to {self.commanded_speed * RPM:.0f} rpm; "
                    "was it stopped by hand or by its watchdog?"
                )
        except LimitExceeded:
            self.stop_rotor(Stop.EMERGENCY)
            raise

    def _record_and_show(self, block: Block, *, after: float) -> None:
        """Hand a block to recorder and viewers; note samples missing before it, at the time `after` [s]."""
        self._note_gap(block, after)
        if not self.recording_paused:
            self._record(block)
            self.samples += len(block.counts)
        for viewer in self._viewers:
            viewer.show(block)

    def _record(self, item: Item) -> None:
        if not self.recorder_alive:
            return
        try:
            self._recorder.put(item)
        except Exception:
            self.recorder_alive = False  # raised once more by `close`
            raise

    def _put_in_place(self, block: Block) -> Block:
        first = block.first_sample + self._shift
        return replace(block, first_sample=first, t_ns=round(first * 1e9 / self._keyphasor.info.sample_rate))

    def _check_restart(self, block: Block) -> None:
        """Refuse a block that goes back, and all after it: what they hold belongs at no index of this recording."""
        if not self._restart and self._next_sample is not None and block.first_sample < self._next_sample:
            self._restart = (
                f"DAQ: restarted at sample {block.first_sample} after sample {self._next_sample}; "
                "was it reset or did it lose power?"
            )
        if self._restart:
            raise LinkLost(self._restart)

    def _note_gap(self, block: Block, after: float) -> None:
        if self._next_sample is not None and block.first_sample > self._next_sample:
            self.gaps += 1
            self.note("gap", f"{block.first_sample - self._next_sample} samples are missing", t=after)
        if block.overrun:
            self.note("overrun", "the DAQ lost samples before this block", t=after)
        self._next_sample = block.first_sample + len(block.counts)
