"""A rig in operation: every block is checked, recorded and shown, and what the motor controller said is looked at."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.acquisition.sweep.fanout import Item, Listener, Recorder, Viewer, Writer
from rotorrig.acquisition.sweep.motor_control import MotorControl, Reading, StopReport
from rotorrig.rig import Clock, ConfigError, Interlock, LimitExceeded, LinkLost, RigError
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.motor import MotorDriver, MotorState, Stop
from rotorrig.rig.probes import Block, Daq

SILENCE = 2.0  # s of wall time the DAQ may be silent
STEADY_BAND = 0.005  # a speed is steady while it stays within this of itself, relative


@dataclass(frozen=True, slots=True)
class Steadiness:
    """A speed [rad/s] and since when [s] the shaft has kept to it."""

    speed: float
    since: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StopTimes:
    """When what happened that stopped the rotor, s on the session's clock; NaN: it did not happen."""

    received: float  # the last block before the stop came from the DAQ
    decided: float  # the stop was decided and put into the hands of the motor's control
    handed: float  # the driver was called
    confirmed: float  # the drive had obeyed


class Session:
    """What happens around every block, whatever step of a plan is under way."""

    def __init__(
        self,
        *,
        motor: MotorDriver,
        control: MotorControl,
        daq: Daq,
        rig: RigConfig,
        writer: Writer,
        interlock: Interlock,
        listeners: Sequence[Listener],
        clock: Clock,
    ) -> None:
        """Begin the recorder's and viewers' threads. Raises ConfigError without a keyphasor."""
        if interlock.keyphasor is None:
            raise ConfigError("keyphasor: is missing in the config, want [keyphasor]: a sweep goes by its speed")
        self.control = control
        self.clock = clock
        self.events: list[Event] = []
        self.samples = 0  # recorded
        self.gaps = 0  # places where samples are missing
        self.state: MotorState | None = None  # the controller's last reading since the last command
        self.guarded = True  # limits are watched; False: the rotor is being stopped, or is at rest and worked on
        self.paused = False  # blocks are not recorded
        self.recording = True  # False: the recorder has failed and the rotor is being stopped
        self.beaten = clock.now()  # when the loop last showed that it lives
        self._motor, self._daq, self._interlock, self._keyphasor = motor, daq, interlock, interlock.keyphasor
        self._names = {probe.channel: f"probe {probe.name}" for probe in rig.probes}
        self._recorder = Recorder(writer)
        self._viewers = [Viewer(listener) for listener in listeners]
        self._next_sample: int | None = None  # None: no block yet
        self._orders = 0  # number of the last command
        self._sent_to = 0.0  # rad/s, by that command; 0: it was a stop
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
    def silence(self) -> float:
        """Seconds since the keyphasor's last pulse, or since the samples begin where there was none."""
        return self._keyphasor.age

    @property
    def steady(self) -> float:
        """Seconds for which the speed has been steady."""
        return self.t - self._steadiness.since

    @property
    def stop_times(self) -> StopTimes | None:
        """When the first stop was decided and obeyed; None: there was none."""
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

    def command(self, speed: float, *, ramp: float) -> None:
        """Send the motor to `speed` [rad/s] at `ramp` [rad/s^2]; what it refuses is raised by `take`."""
        self.state = None
        self._sent_to = speed
        self._orders = self.control.send(lambda: self._motor.set_speed(speed, ramp=ramp))

    def slow_down(self, kind: Stop) -> None:
        """Stop the motor as a step of the plan: it may be started again. What goes wrong is raised by `take`."""
        self.state = None
        self._sent_to = 0.0
        self._orders = self.control.send(lambda: self._motor.stop(kind))

    def halt(self, kind: Stop) -> None:
        """Stop the rotor now and for good; returns at once. May be called from a signal handler."""
        if math.isnan(self._decided):
            self._decided = self.clock.now()
        self._first_stop = self._first_stop or self.control.report
        self.control.stop(kind)
        self.state, self._sent_to = None, 0.0

    def start(self) -> None:
        """Begin to stream."""
        self.control.start()
        self._daq.start()

    def take(self) -> None:
        """Take the next block, check it, record it. Raises LinkLost, LimitExceeded and what recording raises.

        Whatever a limit stops, the stop is on its way before this returns or raises.
        """
        block = self._daq.read(SILENCE)
        self.beat()
        if math.isnan(self._decided):
            self._received = self.beaten
        before = self.t
        try:
            self._look_at(block)
        finally:  # the block that trips is the one worth having
            self._keep(block, after=before)
        if abs(self.speed - self._steadiness.speed) > STEADY_BAND * self._steadiness.speed:
            self._steadiness = Steadiness(self.speed, self.t)
        self.hear_motor()

    def beat(self) -> None:
        """Show that the loop lives."""
        self.beaten = self.clock.now()
        self.control.beat()

    def hear_motor(self) -> None:
        """Look at what the motor controller has said. Raises LinkLost, LimitExceeded."""
        for reading in self.control.readings():
            self._hear(reading)

    def close(self) -> None:
        """End the stream and close the recording. Raises what recording raises."""
        try:
            self.control.close()
            for viewer in self._viewers:
                viewer.close()
                if viewer.fault:
                    self.note("note", f"a viewer failed and was left out from there on: {viewer.fault}")
            with suppress(RigError):  # a DAQ that does not confirm its stop: the recording has what it sent
                self._daq.stop()
            for remark in self._daq.counters.remarks(self._names):
                self.note("note", remark)
        finally:
            self._recorder.close()

    def _look_at(self, block: Block) -> None:
        if not self.guarded:
            self._interlock.follow(block)
            return
        try:
            self._interlock.check(block)
        except LimitExceeded:
            self.halt(Stop.EMERGENCY)  # before anything else
            raise

    def _hear(self, reading: Reading) -> None:
        state = reading.state
        if reading.orders >= self._orders:
            self.state = state
        self._record(
            MotorSample(
                t_ns=round(self.t * 1e9),
                speed=state.speed,
                setpoint=state.setpoint,
                running=state.running,
                fault=state.fault,
            )
        )
        if not self.guarded:
            return
        try:
            self._interlock.check_motor(state)
            if self.state is not None and self._sent_to and not state.running:
                raise LimitExceeded(
                    f"drive: is off, though it was sent to {self._sent_to * RPM:.0f} rpm; "
                    "was it stopped by hand or by its watchdog?"
                )
        except LimitExceeded:
            self.halt(Stop.EMERGENCY)
            raise

    def _keep(self, block: Block, *, after: float) -> None:
        """Hand a block to recorder and viewers, and take note of what is missing before it, after that time [s]."""
        self._note_gap(block, after)
        if not self.paused:
            self._record(block)
            self.samples += len(block.counts)
        for viewer in self._viewers:
            viewer.show(block)

    def _record(self, item: Item) -> None:
        if not self.recording:
            return
        try:
            self._recorder.put(item)
        except Exception:
            self.recording = False  # raised once more by `close`
            raise

    def _note_gap(self, block: Block, after: float) -> None:
        if self._next_sample is not None and block.first_sample < self._next_sample:
            raise LinkLost(
                f"DAQ: has begun again at sample {block.first_sample} after sample {self._next_sample}; "
                "was it reset or its power lost?"
            )
        if self._next_sample is not None and block.first_sample > self._next_sample:
            self.gaps += 1
            self.note("gap", f"{block.first_sample - self._next_sample} samples are missing", t=after)
        if block.overrun:
            self.note("overrun", "the DAQ lost samples before this block", t=after)
        self._next_sample = block.first_sample + len(block.counts)
