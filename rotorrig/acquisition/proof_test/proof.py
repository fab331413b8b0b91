"""Run a proof test: bring the rotor to slow roll, provoke one protection, follow it to rest; then the next.

Each part is a sweep of its own (`run_sweep`), so a rotor that does not stop in time is stopped as in any sweep: by the
quick stop, then up the ladder, until it is proven at rest. The test ends there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from rotorrig.acquisition.proof_test.certificate import Certificate, Proof, Verdict
from rotorrig.acquisition.proof_test.devices import Devices, Opened
from rotorrig.acquisition.proof_test.plan import plan_proof_test, proof_speed
from rotorrig.acquisition.proof_test.protection import Protection
from rotorrig.acquisition.proof_test.protections import PROTECTIONS
from rotorrig.acquisition.proof_test.stage import AlteredDaq, Stage, WatchedControl
from rotorrig.acquisition.proof_test.trial import FINISHED, Trial
from rotorrig.acquisition.proof_test.turns import TurnRecord
from rotorrig.acquisition.recording import Event
from rotorrig.acquisition.sweep import NoRecording, Operator, Ramp, Step, SweepInterrupted, run_sweep
from rotorrig.rig import Clock, Interlock, NotAtRest, RigError, code_version
from rotorrig.rig.config import RigConfig

ENDINGS = ("stop", "abort", "emergency", "trip")  # kinds of the events that end a sweep
NO_ENDING = Event(t_ns=0, kind="abort", text="it did not begin")
TOLD = "emergency stop by the operator"

PARTS = len(PROTECTIONS)
Report = Callable[[str, int], object]  # the protection whose part begins, and its number from 0


@dataclass
class EventLog(NoRecording):
    """Writer of a part: its events are kept, its samples are not."""

    events: list[Event] = field(default_factory=list)

    def write_event(self, event: Event) -> None:
        """Keep it."""
        self.events.append(event)

    @property
    def ending(self) -> Event:
        """What ended the sweep."""
        return next((event for event in self.events if event.kind in ENDINGS), NO_ENDING)


def prove_protections(
    rig: RigConfig,
    devices: Devices,
    *,
    simulated: bool = False,
    operator: Operator | None = None,
    report: Report = lambda name, number: None,
    protections: Sequence[Protection] = PROTECTIONS,
    clock: Clock | None = None,
) -> Certificate:
    """Provoke one protection after the other; return what became of them. The first that fails ends the test.

    The rotor is at rest then, unless the last `Proof` says otherwise. Raises SweepInterrupted or RigError if the
    operator has ended the test, ConfigError if it cannot be made on this rig, LinkLost if the devices do not answer.
    """
    steps, proofs = plan_proof_test(rig), list[Proof]()
    last: Opened | None = None
    for number, protection in enumerate(protections):
        if failed := next((proof.name for proof in proofs if proof.verdict is Verdict.FAILED), ""):
            proofs.append(_untested(protection, Verdict.NOT_TESTED, f"the test ended with the {failed}"))
            continue
        report(protection.name, number)
        with devices.open() as opened:
            last = opened
            proof = _prove(protection, rig, opened, steps, guardian=devices.guardian, operator=operator, clock=clock)
        if protection.is_the_drives and proof.verdict is Verdict.PASSED:
            proof = _reset(proof, devices)
        proofs.append(proof)
    assert last is not None, "there are protections"
    return _certificate(rig, last, tuple(proofs), simulated=simulated)


def _certificate(rig: RigConfig, opened: Opened, proofs: tuple[Proof, ...], *, simulated: bool) -> Certificate:
    return Certificate(
        date=datetime.now(UTC),
        rig=rig.name,
        config_hash=rig.hash,
        code_version=code_version(),
        simulated=simulated,
        drive=opened.drive.model,
        drive_link=opened.drive.link,
        drive_watchdog=opened.drive.watchdog,
        daq=f"{opened.info.model}, serial {opened.info.serial}",
        speed=proof_speed(rig),
        proofs=proofs,
    )


def _untested(protection: Protection, verdict: Verdict, why: str) -> Proof:
    return Proof(name=protection.name, provocation=protection.provocation, verdict=verdict, why=why)


def _reset(proof: Proof, devices: Devices) -> Proof:
    """Return the proof with what the drive said when it was opened again, and was cleared of its trip."""
    try:
        fault = devices.clear_fault()
    except RigError as error:
        return replace(proof, verdict=Verdict.FAILED, why=f"cannot be reset: {error}")
    return replace(proof, remark=f"the drive tripped with '{fault}', cleared" if fault else "no trip to be cleared")


def _prove(
    protection: Protection,
    rig: RigConfig,
    opened: Opened,
    steps: tuple[Step, ...],
    *,
    guardian: float | None,
    operator: Operator | None,
    clock: Clock | None,
) -> Proof:
    """Provoke one protection on opened devices. Raises SweepInterrupted, RigError if the operator ends it."""
    turns, log = TurnRecord(rig, opened.info), EventLog()
    stage = Stage(
        rig=rig,
        info=opened.info,
        speed=proof_speed(rig),
        control=WatchedControl(opened.control, turns),
        daq=AlteredDaq(opened.daq, turns),
        turns=turns,
        interlock=Interlock(rig, opened.info),
        watchdog=opened.drive.watchdog,
        guardian=guardian,
    )
    if missing := protection.missing(stage):
        return _untested(protection, Verdict.NOT_AVAILABLE, missing)
    trial = Trial(protection, stage, ramp=next(step.rate for step in steps if isinstance(step, Ramp)))
    try:
        run_sweep(
            (*steps, trial.step),
            control=stage.control,
            daq=stage.daq,
            rig=rig,
            writer=log,
            interlock=stage.interlock,
            operator=operator,
            watchdog=stage.watchdog,
            clock=clock,
        )
    except SweepInterrupted:
        if not trial.is_answered(log.ending) or any(event.text == TOLD for event in log.events):
            raise
    except NotAtRest as error:
        return replace(trial.proof(log.ending), verdict=Verdict.FAILED, why=str(error), at_rest=False)
    except RigError as error:
        return replace(trial.proof(log.ending), verdict=Verdict.FAILED, why=str(error))
    if log.ending.kind == "stop" and log.ending.text != FINISHED:
        raise RigError(f"proof test: {log.ending.text}; the rotor is at rest")
    return trial.proof(log.ending)
