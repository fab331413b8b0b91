"""A proof test on a scripted rig, in its own time: what it finds of sound protections and of those that fail."""

import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest

from rotorrig.acquisition.proof_test import Certificate, Opened, Verdict, prove_protections
from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.protections import PROTECTIONS
from rotorrig.acquisition.proof_test.stage import Stage
from rotorrig.acquisition.sweep.engine import SweepInterrupted
from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.control import DirectControl
from rotorrig.rig.errors import ConfigError, LimitExceeded, LinkLost, RigError
from rotorrig.rig.motor.base import MotorInfo, MotorState, Stop
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.acquisition.sweep.scripted_bench import PatientClock, Watching
from tests.acquisition.sweep.scripted_rig import ScriptedDaq, ScriptedMotor, Shaft

SLOW_ROLL = 240 * math.pi / 30  # rad/s, of the rk4's plan
TURN = 0.25  # s
BLOCK = 0.02  # s
WATCHDOG = 2.0  # s
ALL = [protection.name for protection in PROTECTIONS]


class WatchedDrive(ScriptedMotor):
    """A scripted drive with a watchdog, and a trip that it remembers."""

    def __init__(self, shaft: Shaft, clock: PatientClock) -> None:
        super().__init__(shaft)
        self.watchdog: float | None = WATCHDOG
        self.bites = self.clears = True
        self.fault = ""
        self.closed = 0
        self._clock, self._heard = clock, 0.0
        self.on_read = lambda state: (
            self.hear()
            or MotorState(
                **{name: getattr(state, name) for name in ("speed", "setpoint", "running", "at_setpoint")},
                fault=self.fault,
            )
        )

    def hear(self) -> None:
        self._heard = self._clock.now()

    def open(self) -> MotorInfo:
        super().open()
        return MotorInfo(model="scripted", link="none", watchdog=self.watchdog)

    def clear_fault(self) -> None:
        if not self.clears:
            raise LimitExceeded("drive: want it reset by hand")
        self.fault = ""

    def close(self) -> None:
        self.closed += 1

    def look(self) -> None:
        if self.watchdog and self.bites and self._shaft.powered and self._clock.now() - self._heard > self.watchdog:
            self._shaft.powered, self.fault = False, "serial link"


class Rig:
    """Scripted devices, and the true speed of their shaft over the sample clock of each part."""

    guardian: float | None = None

    def __init__(self, rig: RigConfig, info: DaqInfo) -> None:
        self.clock, self.shaft = PatientClock(), Shaft()
        self.motor = WatchedDrive(self.shaft, self.clock)
        self.daq = ScriptedDaq(rig, info, self.shaft, self.clock)
        self.daq.on_block = self._note
        self.script = lambda block: block
        self.truth: list[list[tuple[float, float]]] = []
        self.provoked: dict[str, tuple[int, float]] = {}
        self.rig, self.info = rig, info

    def _note(self, block: Block) -> Block:
        self.motor.look()
        self.truth[-1].append(((block.first_sample + len(block.counts)) / self.info.sample_rate, self.shaft.speed))
        return self.script(block)

    @contextmanager
    def open(self) -> Iterator[Opened]:
        self.truth.append([])
        drive = self.motor.open()
        self.motor.hear()
        yield Opened(
            control=DirectControl(self.motor, clock=self.clock), drive=drive, daq=self.daq, info=self.daq.open()
        )

    def clear_fault(self) -> str:
        if fault := self.motor.fault:
            self.motor.clear_fault()
        return fault

    def prove(self, *names: str, operator: Watching | None = None) -> Certificate:
        chosen = [self.timed(protection) for protection in PROTECTIONS if protection.name in (names or ALL)]
        return prove_protections(
            self.rig, self, protections=chosen, clock=self.clock, operator=operator, simulated=True
        )

    def timed(self, protection: Protection) -> Protection:
        """The protection, which notes when it is provoked."""

        def provoke(stage: Stage) -> None:
            self.provoked[protection.name] = len(self.truth) - 1, self.truth[-1][-1][0]
            protection.provoke(stage)

        return replace(protection, provoke=provoke)

    def true_times(self, name: str) -> tuple[float, float]:
        """When the shaft truly became slower than 98 % and came to rest, s after the protection was provoked."""
        part, provoked = self.provoked[name]
        slower = next(t for t, speed in reversed(self.truth[part]) if speed >= 0.98 * SLOW_ROLL)
        rest = next(t for t, speed in reversed(self.truth[part]) if speed > 0)
        return slower - provoked, rest - provoked


@pytest.fixture
def scripted(rig: RigConfig, daq_info: DaqInfo) -> Rig:
    return Rig(rig, daq_info)


def verdicts(certificate: Certificate) -> dict[str, Verdict]:
    return {proof.name: proof.verdict for proof in certificate.proofs}


def test_every_protection_of_a_sound_rig_passes_at_the_times_the_shaft_had(scripted: Rig) -> None:
    certificate = scripted.prove()
    assert certificate.passed
    assert verdicts(certificate) == {
        **dict.fromkeys(ALL, Verdict.PASSED),
        "guardian": Verdict.NOT_AVAILABLE,
    }
    for name in scripted.provoked:
        proof = next(proof for proof in certificate.proofs if proof.name == name)
        slower, rest = scripted.true_times(name)
        assert proof.resolution == pytest.approx(TURN, rel=1e-3)
        assert slower - BLOCK <= proof.slowing_after <= slower + 2 * TURN
        assert proof.rest_after == pytest.approx(rest, abs=5 * BLOCK)
    assert certificate.speed == pytest.approx(SLOW_ROLL)


def test_the_programs_protections_decide_in_the_time_of_the_table(scripted: Rig) -> None:
    emergency, overspeed, keyphasor = scripted.prove("emergency stop", "overspeed", "keyphasor loss").proofs
    assert emergency.decided_after == 0.0
    assert overspeed.decided_after == pytest.approx(0.02)  # a block: the median is above the limit already
    assert 2.0 - TURN <= keyphasor.decided_after <= 2.1
    assert scripted.motor.commands.count(("stop", Stop.EMERGENCY)) == 3
    assert ("stop", Stop.COAST) not in scripted.motor.commands


def test_a_watchdog_is_timed_from_the_last_word_and_its_trip_cleared(scripted: Rig) -> None:
    silence, link = scripted.prove("watchdog", "link loss").proofs
    for proof in (silence, link):
        assert WATCHDOG - 0.25 <= proof.slowing_after <= WATCHDOG + TURN
        assert math.isnan(proof.decided_after)
        assert proof.remark == "the drive tripped with 'serial link', cleared"
    assert scripted.motor.closed == 1
    assert scripted.motor.opened > 2  # the link, for the stop after the rotor stood
    assert scripted.motor.fault == ""


def test_a_watchdog_that_does_not_bite_fails_and_the_rotor_is_stopped_by_the_program(scripted: Rig) -> None:
    scripted.motor.bites = False
    certificate = scripted.prove("overspeed", "watchdog", "link loss")
    assert not certificate.passed
    assert verdicts(certificate) == {
        "overspeed": Verdict.PASSED,
        "watchdog": Verdict.FAILED,
        "link loss": Verdict.NOT_TESTED,
    }
    failed = certificate.proofs[1]
    assert failed.why.startswith("the rotor was stopped by something else: watchdog: the rotor turns at 240 rpm as")
    assert scripted.motor.commands[-1] == ("stop", Stop.EMERGENCY)
    assert scripted.shaft.speed == 0.0


def test_a_drive_without_a_watchdog_has_none_and_does_not_fail(scripted: Rig) -> None:
    scripted.motor.watchdog = None
    certificate = scripted.prove()
    assert certificate.passed
    assert [name for name, verdict in verdicts(certificate).items() if verdict is Verdict.NOT_AVAILABLE] == [
        "guardian",
        "watchdog",
        "link loss",
    ]
    assert "has no watchdog" in certificate.proofs[-1].why


def test_a_drive_that_ignores_the_stop_fails_with_the_ladder_climbed(scripted: Rig) -> None:
    scripted.motor.obeys = {Stop.COAST}
    certificate = scripted.prove("emergency stop", "overspeed")
    (failed, untested) = certificate.proofs
    assert failed.verdict is Verdict.FAILED
    assert failed.why == "the drive did not obey the stop; it took 'coast' to stop the rotor"
    assert untested.verdict is Verdict.NOT_TESTED
    assert scripted.shaft.speed == 0.0


@pytest.mark.campaign
def test_a_rotor_that_nothing_stops_is_said_to_turn(scripted: Rig) -> None:
    scripted.motor.obeys, scripted.motor.watchdog = set(), None
    (failed,) = scripted.prove("emergency stop").proofs
    assert failed.verdict is Verdict.FAILED
    assert not failed.at_rest
    assert failed.why.startswith("THE ROTOR IS TURNING at 240 rpm, left by the operator")


def test_another_trip_proves_nothing(scripted: Rig) -> None:
    def shake(block: Block) -> Block:
        scripted.daq.vibration = lambda speed: 2e-3 if scripted.truth[-1][-1][0] > 8.0 else 50e-6
        return block

    scripted.script = shake
    (failed,) = scripted.prove("keyphasor loss").proofs
    assert failed.verdict is Verdict.FAILED
    assert "probe" in failed.why


def test_a_drive_that_cannot_be_reset_fails(scripted: Rig) -> None:
    scripted.motor.clears = False
    (failed,) = scripted.prove("watchdog").proofs
    assert (failed.verdict, failed.why) == (Verdict.FAILED, "cannot be reset: drive: want it reset by hand")


def test_a_lost_link_in_the_approach_is_a_part_that_failed_unprovoked(scripted: Rig) -> None:
    def lose(block: Block) -> Block:
        if block.first_sample > 40_000:
            raise LinkLost("DAQ: gone")
        return block

    scripted.script = lose
    scripted.clock.sleep(0)
    with_operator_leaving = scripted.prove("overspeed")
    (failed,) = with_operator_leaving.proofs
    assert failed.verdict is Verdict.FAILED
    assert "DAQ: gone" in failed.why
    assert math.isnan(failed.slowing_after)


@pytest.mark.parametrize("names", [("overspeed",), ("watchdog",), ("emergency stop",)])
def test_the_operator_ends_the_test_at_any_time(scripted: Rig, names: tuple[str, ...]) -> None:
    def press(block: Block) -> Block:
        if block.first_sample == 40_000:
            signal.raise_signal(signal.SIGINT)
        return block

    scripted.script = press
    with pytest.raises(SweepInterrupted):
        scripted.prove(*names)
    assert scripted.shaft.speed == 0.0


def test_an_emergency_stop_pressed_once_more_is_the_operators(scripted: Rig) -> None:
    pressed: list[int] = []

    def press(block: Block) -> Block:
        if ("stop", Stop.EMERGENCY) in scripted.motor.commands and not pressed:
            pressed.append(block.first_sample)
            signal.raise_signal(signal.SIGINT)
        return block

    scripted.script = press
    with pytest.raises(SweepInterrupted):
        scripted.prove("emergency stop")


def test_stop_typed_at_the_terminal_ends_the_test(scripted: Rig) -> None:
    wants = Watching(stop=lambda: bool(scripted.truth[-1]) and scripted.truth[-1][-1][0] > 4.0)
    with pytest.raises(RigError, match="proof test: stopped by the operator; the rotor is at rest"):
        scripted.prove("watchdog", operator=wants)


def test_a_config_without_a_keyphasor_is_refused(scripted: Rig) -> None:
    scripted.rig = scripted.rig.model_copy(update={"keyphasor": None})
    with pytest.raises(ConfigError, match=r"want \[keyphasor\] for a proof test"):
        scripted.prove()
    assert scripted.motor.opened == 0
