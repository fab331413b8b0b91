"""A rig in operation: every block is recorded, checked and shown, and the motor controller asked now and then."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from rotorrig.acquisition.fanout import Listener, Recorder, Viewer, Writer
from rotorrig.acquisition.recording import Event, MotorSample
from rotorrig.rig.clock import Clock
from rotorrig.rig.errors import ConfigError, LinkLost, RigError
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.motor.base import MotorDriver, MotorState, Stop
from rotorrig.rig.probes.base import Block, Daq

POLL_EVERY = 0.25  # s of wall time between readings of the motor controller
POLL_AT_SPEED = 0.05  # s, while its word is all that is missing
SILENCE = 2.0  # s of wall time the DAQ may be silent
STEADY_BAND = 0.005  # a speed is steady while it stays within this of itself, relative
STOP_ATTEMPTS, STOP_PAUSE = 5, 0.2  # tries, and s of wall time between them


@dataclass(frozen=True, slots=True)
class Steadiness:
    """A speed [rad/s] and since when [s] the shaft has kept to it."""

    speed: float
    since: float


class Session:
    """What happens around every block, whatever step of a plan is under way."""

    def __init__(
        self,
        *,
        motor: MotorDriver,
        daq: Daq,
        writer: Writer,
        interlock: Interlock,
        listeners: Sequence[Listener],
        clock: Clock,
    ) -> None:
        """Begin the recorder's and viewers' threads. Raises ConfigError without a keyphasor."""
        if interlock.keyphasor is None:
            raise ConfigError("keyphasor: is missing in the config, want [keyphasor]: a sweep goes by its speed")
        self.motor = motor
        self.events: list[Event] = []
        self.samples = 0
        self.gaps = 0  # places where samples are missing
        self.state: MotorState | None = None  # the controller's last reading since the last command
        self._daq, self._interlock, self._keyphasor, self._clock = daq, interlock, interlock.keyphasor, clock
        self._recorder = Recorder(writer)
        self._viewers = [Viewer(listener) for listener in listeners]
        self._next_sample: int | None = None  # None: no block yet
        self._polled = -math.inf
        self._steadiness = Steadiness(0.0, 0.0)

    @property
    def t(self) -> float:
        """Seconds of the sample clock up to the end of the last block."""
        return self._keyphasor.time

    @property
    def speed(self) -> float:
        """Shaft speed [rad/s] by the keyphasor."""
        return float(self._keyphasor.steady_speed)

    @property
    def steady(self) -> float:
        """Seconds for which the speed has been steady."""
        return self.t - self._steadiness.since

    def note(self, kind: str, text: str) -> None:
        """Record an event at the present sample."""
        event = Event(t_ns=round(self.t * 1e9), kind=kind, text=text)
        self.events.append(event)
        self._recorder.put(event)

    def command(self, speed: float, *, ramp: float) -> None:
        """Send the motor to `speed` [rad/s] at `ramp` [rad/s^2]. Raises LinkLost, LimitExceeded."""
        self.state = None
        self.motor.set_speed(speed, ramp=ramp)

    def coast(self) -> None:
        """Cut the power. Raises LinkLost."""
        self.state = None
        self.motor.stop(Stop.COAST)

    def start(self) -> None:
        """Begin to stream."""
        self._daq.start()

    def take(self) -> None:
        """Take the next block, check it, record it. Raises LinkLost, LimitExceeded and what recording raises."""
        block = self._daq.read(SILENCE)
        self._note_gap(block)
        self.samples += len(block.counts)
        for viewer in self._viewers:
            viewer.show(block)
        try:
            self._interlock.check(block)
        finally:  # the block that trips is the one worth having
            self._recorder.put(block)
        if abs(self.speed - self._steadiness.speed) > STEADY_BAND * self._steadiness.speed:
            self._steadiness = Steadiness(self.speed, self.t)
        self.poll(at_most_every=POLL_EVERY)

    def poll(self, *, at_most_every: float = 0.0) -> None:
        """Ask the motor controller how it is, unless it was asked less than so many seconds ago."""
        if self._clock.now() - self._polled < at_most_every:
            return
        self.state = state = self.motor.read()
        self._polled = self._clock.now()
        self._recorder.put(
            MotorSample(
                t_ns=round(self.t * 1e9),
                speed=state.speed,
                setpoint=state.setpoint,
                running=state.running,
                fault=state.fault,
            )
        )
        self._interlock.check_motor(state)

    def bring_to_rest(self, kind: Stop) -> None:
        """Stop the rotor, trying again if the link hiccups. Raises LinkLost if the drive never confirms it."""
        for attempt in range(1, STOP_ATTEMPTS + 1):
            try:
                self.motor.stop(kind)
                return
            except Exception as error:  # whatever went wrong: what matters now is that the rotor stops
                if attempt == STOP_ATTEMPTS:
                    raise LinkLost(
                        f"THE ROTOR MAY STILL BE TURNING: the drive confirmed no stop in {attempt} tries "
                        f"({error or type(error).__name__}); cut its power by hand"
                    ) from error
                self._clock.sleep(STOP_PAUSE)

    def close(self) -> None:
        """End the stream and close the recording. Raises what recording raises."""
        try:
            for viewer in self._viewers:
                viewer.close()
                if viewer.fault:
                    self.note("note", f"a viewer failed and was left out from there on: {viewer.fault}")
            with suppress(RigError):  # a DAQ that does not confirm its stop: the recording has what it sent
                self._daq.stop()
        finally:
            self._recorder.close()

    def _note_gap(self, block: Block) -> None:
        if self._next_sample is not None and block.first_sample < self._next_sample:
            raise LinkLost(
                f"DAQ: has begun again at sample {block.first_sample} after sample {self._next_sample}; "
                "was it reset or its power lost?"
            )
        if self._next_sample is not None and block.first_sample > self._next_sample:
            self.gaps += 1
            self.note("gap", f"{block.first_sample - self._next_sample} samples are missing")
        if block.overrun:
            self.note("overrun", "the DAQ lost samples before this block")
        self._next_sample = block.first_sample + len(block.counts)
