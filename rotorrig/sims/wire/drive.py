"""Emulated drive behind every protocol: states, a ramp generator, a fault memory, a watchdog.

Speeds are the shaft's, in rad/s; what a protocol counts in is its own file's business. Times are simulated, but for
the watchdog, which is about a link and runs in wall time.
"""

import math
from dataclasses import dataclass
from enum import Enum, auto

from rotorrig.rig import Clock
from rotorrig.sims.wire.plant_port import Plant


class OnSilence(Enum):
    """Reaction of a drive to a silent master."""

    TRIP = auto()  # remember a fault, output off
    COAST = auto()  # output off
    RAMP = auto()  # down the ramp
    GO_ON = auto()


class _Mode(Enum):
    STOPPED = auto()  # output off: at rest or coasting
    RUNNING = auto()
    STOPPING = auto()  # down the ramp


@dataclass(frozen=True, slots=True, kw_only=True)
class _Ramp:
    """The ramp generator between two commands."""

    start: float  # s, simulated time
    begin: float  # rad/s
    target: float  # rad/s
    slope: float  # rad/s^2, > 0

    def at(self, t: float) -> float:
        gone = self.slope * (t - self.start)
        way = self.target - self.begin
        return self.target if abs(way) <= gone else self.begin + math.copysign(gone, way)


class Drive:
    """A drive without an encoder in front of the plant: its speed is the ramp generator's.

    A start on a turning rotor catches it (flying start); output is off while it coasts. `on_silence`, `patience` [s],
    `reference` [rad/s] and the ramps [rad/s^2] may be set at any time; the last three count at once.
    """

    def __init__(self, plant: Plant, *, clock: Clock, silence_fault: int) -> None:
        """Stand still in front of `plant`; `silence_fault` is the number it trips with when its master is silent."""
        self.fault = 0  # number of the fault remembered; 0: none
        self.on_silence = OnSilence.TRIP
        self.patience = 5.0
        self.stuck = False  # a script's: the shaft keeps the speed it has, whatever is commanded
        self._plant, self._clock, self._silence_fault = plant, clock, silence_fault
        self._mode = _Mode.STOPPED
        self._reference = 0.0
        self._rising = self._falling = 1.0
        self._braking: float | None = None  # the ramp of a stop that has one of its own
        self._ramp = _Ramp(start=0.0, begin=0.0, target=0.0, slope=1.0)
        self._heard = clock.now()

    @property
    def active(self) -> bool:
        """True while the output is on."""
        return self._mode is not _Mode.STOPPED

    @property
    def running(self) -> bool:
        """True from a start to the next stop."""
        return self._mode is _Mode.RUNNING

    @property
    def speed(self) -> float:
        """Output speed [rad/s]: the ramp generator's, 0 with the output off."""
        return self._ramp.at(self._plant.t) if self.active else 0.0

    @property
    def remaining(self) -> float:
        """Change of speed left on the ramp [rad/s], above 0 when rising."""
        return self._ramp.target - self.speed if self.active else 0.0

    @property
    def reference(self) -> float:
        """The speed asked for [rad/s]."""
        return self._reference

    def set_reference(self, speed: float, *, rising: float, falling: float) -> None:
        """Set the reference [rad/s] and both ramps [rad/s^2]; in force at once if the output is on."""
        changed = (speed, rising, falling) != (self._reference, self._rising, self._falling)
        self._reference, self._rising, self._falling = speed, rising, falling
        if changed and self.active:
            self._follow_reference()

    def start(self) -> None:
        """Go to the reference, unless a fault is remembered."""
        if self.fault or self._mode is _Mode.RUNNING:
            return
        begin = self.speed if self.active else self._plant.speed
        self._mode, self._braking = _Mode.RUNNING, None
        self._follow_reference(begin)

    def stop(self, *, coast: bool, braking: float | None = None) -> None:
        """End a run, by switching the output off or down the ramp, or another one, `braking` [rad/s^2]."""
        if not self.active:
            return
        self._braking = braking
        if coast:
            self._switch_off()
        else:
            self._mode = _Mode.STOPPING
            self._follow_reference()

    def trip(self, fault: int) -> None:
        """Remember a fault and switch the output off."""
        self.fault = fault
        if self.active:
            self._switch_off()

    def hear(self) -> None:
        """Restart the watchdog: the master has sent a request."""
        self._heard = self._clock.now()

    def tick(self) -> None:
        """End a finished ramp-down; act on a master that has been silent for too long."""
        if self._mode is _Mode.STOPPING and self.speed == 0.0:
            self._switch_off()
        if self.running and self._clock.now() - self._heard > self.patience:
            match self.on_silence:
                case OnSilence.TRIP:
                    self.trip(self._silence_fault)
                case OnSilence.COAST:
                    self._switch_off()
                case OnSilence.RAMP:
                    self.stop(coast=False)

    def hold_speed(self, stuck: bool) -> None:
        """Hold the shaft at its present speed, or release it; the drive itself notices nothing."""
        if stuck and not self.stuck:
            self._plant.command(self._plant.speed, 1.0, True)
        self.stuck = stuck
        if not stuck and self.active:
            self._follow_reference()

    def _switch_off(self) -> None:
        self._mode = _Mode.STOPPED
        self.stuck = False  # without power nothing holds the shaft at a speed
        self._plant.command(0.0, self._ramp.slope, False)

    def _follow_reference(self, begin: float | None = None) -> None:
        """Head for the reference, or for zero when stopping, from the speed `begin` or the present one."""
        begin = self.speed if begin is None else begin
        target = self._reference if self.running else 0.0
        slope = self._rising if target > begin else self._braking or self._falling
        self._ramp = _Ramp(start=self._plant.t, begin=begin, target=target, slope=slope)
        if not self.stuck:
            self._plant.command(target, slope, True)
