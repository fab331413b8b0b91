"""Interlock: every block of samples and every reading of the drive against all limits.

`check` takes every Block, `check_motor` every reading of the drive; both raise LimitExceeded in one sentence. A link
that dies is raised by its driver, as LinkLost.
"""

from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock.asked_speed import AskedSpeed
from rotorrig.rig.interlock.drive_speed import DriveSpeed
from rotorrig.rig.interlock.gap_voltage import GapVoltage
from rotorrig.rig.interlock.keyphasor_loss import KeyphasorLoss
from rotorrig.rig.interlock.overspeed import check_overspeed, overspeed_limit
from rotorrig.rig.interlock.rotation_sense import RotationSense
from rotorrig.rig.interlock.sample_loss import LateSamples, SampleLoss
from rotorrig.rig.interlock.standstill import check_standstill
from rotorrig.rig.interlock.vibration import Vibration
from rotorrig.rig.motor import MotorState
from rotorrig.rig.probes import Block, DaqInfo, KeyphasorSpeed


class Interlock:
    """Speed, vibration, probes, keyphasor, samples and drive; without [limits] by the rig's nameplate.

    Without [keyphasor] the speed is the drive's own, and nothing is compared with it.
    """

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self.keyphasor = KeyphasorSpeed(rig, info) if rig.keyphasor else None
        self.overspeed = overspeed_limit(rig)  # rad/s; a proof test lowers it
        self._sample_rate = info.sample_rate
        self._vibration = Vibration(rig, info)
        self._gaps = GapVoltage(rig)
        self._loss = SampleLoss(info)
        self._late = LateSamples(info)
        self._asked = AskedSpeed()
        self._drive = DriveSpeed()
        self._keyphasor_loss = KeyphasorLoss()
        self._sense = RotationSense(rig, info)

    def command(self, speed: float, *, ramp: float = 0.0) -> None:
        """Take what is about to be asked of the drive [rad/s, rad/s^2]; a speed of 0 is a stop of any kind."""
        self._drive.forget()
        if self.keyphasor:
            self._asked.ask(speed, ramp=ramp, keyphasor=self.keyphasor)

    def check(self, block: Block, *, now: float | None = None) -> None:
        """Check one block, read at the wall time `now` [s]; None: whether it is late is not known.

        Raises LimitExceeded.
        """
        zeros = self.keyphasor.update(block) if self.keyphasor else None
        self._loss.check(block)
        if now is not None:
            self._late.check(block, now)
        speed = self.keyphasor.steady_speed if self.keyphasor else 0.0
        if self.keyphasor:
            check_overspeed(speed, limit=self.overspeed, source="keyphasor")
            self._asked.check(self.keyphasor)
            self._keyphasor_loss.check(self._asked.command, self.keyphasor)
        if len(block.counts):
            self._check_probes(block, speed)
        if zeros is not None:
            self._sense.check(block, zeros, speed=speed)

    def check_standstill(self, state: MotorState) -> None:
        """Check before the first command that the rotor is at rest. Raises LimitExceeded."""
        check_standstill(state, self.keyphasor)

    def follow(self, block: Block) -> None:
        """Update the speed from a block without checking it: the rotor is being stopped already."""
        self._loss.follow(block)
        if self.keyphasor:
            self.keyphasor.update(block)

    def check_motor(self, state: MotorState) -> None:
        """Check one reading of the drive. Raises LimitExceeded."""
        if state.fault:
            speed = state.speed or (self.keyphasor.steady_speed if self.keyphasor else 0.0)  # its output may be off
            raise LimitExceeded(f"drive: has tripped with '{state.fault}' at {speed * RPM:.0f} rpm")
        if state.running and state.reverse:
            raise LimitExceeded(
                f"drive: turns backward at {state.speed * RPM:.0f} rpm, want the sense of rotation of every plan"
            )
        check_overspeed(state.speed, limit=self.overspeed, source="drive")
        if self.keyphasor is None:
            return
        self._keyphasor_loss.check_motor(state, self.keyphasor)
        if (command := self._asked.command) and command.rises:
            self._drive.check(state, self.keyphasor, most=float(command.allows(self.keyphasor.time)))

    def _check_probes(self, block: Block, steady_speed: float) -> None:
        speed = self.keyphasor.speed if self.keyphasor else 0.0
        volts = self._vibration.check(block.counts, speed=speed, steady_speed=steady_speed)
        self._gaps.check(volts, seconds=len(block.counts) / self._sample_rate)
