"""The guardian of a motor link stops the rotor when the program cannot, the program when the guardian cannot."""

import contextlib
import math
import os
import signal
import socket
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rotorrig.rig.control import GuardedControl, SetSpeed, ask_guardian, guarded, registry
from rotorrig.rig.errors import LimitExceeded, LinkLost
from rotorrig.rig.motor import Stop
from tests.rig.control import guarded_sweep
from tests.rig.control.line_drive import LineDrive

SOON = 30.0  # s of patience on a busy machine; what is waited for takes less than a second
STEADY = 2.0  # s of the guardian's patience with a program that a busy machine may hold up before it is killed
WITHIN = 0.5  # s from the end of the patience to the first stop
ROOT = Path(__file__).parents[3]


def until(true: Callable[[], object], *, work: Callable[[], object] = lambda: None) -> None:
    deadline = time.monotonic() + SOON
    while not true():
        assert time.monotonic() < deadline, "did not happen"
        work()
        time.sleep(0.002)


class Sweep:
    """A control through a guardian, and what a sweep does with it."""

    def __init__(self, drive: LineDrive, log: Path, *, patience: float = 0.5) -> None:
        self.log, self.drive = log, drive
        self.control = guarded_sweep.make_control(str(drive.port), log, patience=patience)
        self.raised: list[Exception] = []
        self.readings: list[object] = []
        self._began = time.monotonic()

    @property
    def guardian(self) -> int:
        assert self.control.guardian
        return self.control.guardian

    def turn(self) -> None:
        """Come to speed."""
        self.control.start()
        self.control.send(SetSpeed(speed=60.0, ramp=100.0))
        until(lambda: self.drive.inverter.output > 500, work=self.live)

    def live(self) -> None:
        """Process samples."""
        self.control.beat(time.monotonic() - self._began)
        self.poll()

    def poll(self) -> None:
        try:
            self.readings += self.control.take_readings()
        except (LimitExceeded, LinkLost) as error:
            self.raised.append(error)

    def confirmed(self) -> bool:
        report = self.control.report
        return report is not None and not math.isnan(report.confirmed)

    def written(self) -> str:
        return self.log.read_text() if self.log.exists() else ""


@pytest.fixture
def drive(monkeypatch: pytest.MonkeyPatch) -> Iterator[LineDrive]:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    made = LineDrive()
    yield made
    made.close()


@pytest.fixture
def sweep(drive: LineDrive, tmp_path: Path) -> Iterator[Sweep]:
    made = Sweep(drive, tmp_path / "run.guardian.txt")
    info = made.control.open()
    process = made.control._process
    assert process
    assert (info.model, info.watchdog) == ("peer controller", 60.0)
    try:
        yield made
        made.control.close()
    finally:
        process.kill()
        process.wait()
        made.control._line.close()  # still open where the rotor was left


def end_guardian(sweep: Sweep) -> None:
    """Take over, as `rotor stop` does, and wait for the guardian's end."""
    table = sweep.control._table
    if (answer := ask_guardian(table, "stop")) is not None:
        until(lambda: not registry.address_of(table).exists())
        assert answer["sweep"] is None


@contextlib.contextmanager
def ended_at_last(program: "subprocess.Popen[bytes]") -> Iterator[None]:
    """Kill the program and the guardian it has told of, should the test fail."""
    assert program.stdout
    guardian = int(program.stdout.readline())
    try:
        yield
    finally:
        program.kill()
        with contextlib.suppress(ProcessLookupError):
            os.kill(guardian, signal.SIGKILL)


def test_readings_and_the_progress_of_a_stop_come_through_the_guardian(sweep: Sweep) -> None:
    sweep.turn()
    until(lambda: any(reading.commands_done == 1 for reading in sweep.readings), work=sweep.live)  # type: ignore[attr-defined]
    sweep.control.stop(Stop.RAMP)
    until(sweep.confirmed, work=sweep.live)
    assert sweep.control.report
    assert sweep.control.report.kind is Stop.RAMP
    until(lambda: not sweep.drive.inverter.on, work=sweep.live)
    assert sweep.raised == []
    assert sweep.written() == ""


def test_a_stop_reaches_the_drive_within_50_ms(sweep: Sweep) -> None:
    sweep.turn()
    delays = []
    for _ in range(11):
        asked = time.monotonic()
        sweep.control.stop(Stop.EMERGENCY)
        until(lambda asked=asked: sweep.drive.stops(since=asked), work=sweep.live)  # type: ignore[misc]
        delays.append(sweep.drive.stops(since=asked)[0] - asked)
        until(sweep.confirmed, work=sweep.live)
    assert statistics.median(delays) < 0.05


@pytest.mark.parametrize("beats", [False, True], ids=["no beats", "beats of the same sample"])
def test_a_program_that_processes_no_sample_is_stopped_for_and_hears_it(sweep: Sweep, *, beats: bool) -> None:
    sweep.turn()
    stuck = time.monotonic()
    until(
        lambda: sweep.drive.stops(since=stuck),
        work=(lambda: sweep.control.beat(0.0)) if beats else (lambda: None),
    )
    assert 0.3 < sweep.drive.stops(since=stuck)[0] - stuck < 0.5 + WITHIN
    until(lambda: sweep.raised, work=sweep.poll)
    assert isinstance(sweep.raised[0], LimitExceeded)
    assert str(sweep.raised[0]).startswith("guardian: no sample was processed for 0.")


@pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGQUIT, signal.SIGSTOP])
def test_the_rotor_is_stopped_for_a_program_that_is_killed_or_halted(
    drive: LineDrive, tmp_path: Path, death: signal.Signals
) -> None:
    log = tmp_path / "run.guardian.txt"
    seen = Sweep(drive, log)
    program = subprocess.Popen(
        [sys.executable, guarded_sweep.__file__, str(drive.port), str(log), str(STEADY)], stdout=subprocess.PIPE
    )
    with program, ended_at_last(program):
        assert program.stdout
        until(lambda: drive.inverter.output > 500)
        killed = time.monotonic()
        program.send_signal(death)
        until(lambda: drive.stops(since=killed))
        patience = STEADY if death is signal.SIGSTOP else 0.0
        assert drive.stops(since=killed)[0] - killed < patience + WITHIN
        until(lambda: "unknown" in seen.written())
        program.kill()
        program.wait()
        until(lambda: not drive.inverter.on)
        until(lambda: (ask_guardian(seen.control._table, "state") or {"sweep": 1})["sweep"] is None)
        end_guardian(seen)
    assert "'rotor stop' took over" in seen.written()
    assert "at rest" not in seen.written()


@pytest.mark.parametrize("death", [signal.SIGKILL, signal.SIGSTOP])
def test_the_program_stops_the_rotor_when_the_guardian_is_killed_or_hangs(sweep: Sweep, death: signal.Signals) -> None:
    sweep.turn()
    killed = time.monotonic()
    os.kill(sweep.guardian, death)
    until(lambda: sweep.drive.stops(since=killed), work=sweep.live)
    patience = guarded.HANG if death is signal.SIGSTOP else 0.0
    assert sweep.drive.stops(since=killed)[0] - killed < patience + 2 * WITHIN
    until(lambda: sweep.raised, work=sweep.live)
    assert isinstance(sweep.raised[0], LinkLost)
    assert "the stop was sent without it" in str(sweep.raised[0])
    sweep.readings.clear()
    sweep.control.stop(Stop.EMERGENCY)  # as the sweep does next
    until(lambda: any(r.commands_done == 1 and not r.state.running for r in sweep.readings), work=sweep.live)  # type: ignore[attr-defined]
    assert sweep.control.guardian is None


def test_a_drive_that_does_not_answer_is_reported_in_its_drivers_words(drive: LineDrive, tmp_path: Path) -> None:
    drive.deaf = True
    with pytest.raises(LinkLost, match=r"^line protocol, .*asked 'ID', no valid answer"):
        Sweep(drive, tmp_path / "log").control.open()


def test_a_second_sweep_on_the_same_link_is_refused(sweep: Sweep) -> None:
    with pytest.raises(LinkLost, match=rf"^motor: a guardian for the sweep of process {os.getpid()} still holds"):
        Sweep(sweep.drive, sweep.log).control.open()


def test_at_rest_the_guardian_ends_and_its_socket_is_gone(sweep: Sweep) -> None:
    guardian, place = sweep.guardian, registry.address_of(sweep.control._table)
    assert place.is_socket()
    sweep.turn()
    sweep.control.stop(Stop.COAST)
    until(sweep.confirmed, work=sweep.live)
    sweep.control.close()
    with pytest.raises(ProcessLookupError):
        os.kill(guardian, 0)
    assert not place.exists()
    assert sweep.written() == ""


def test_of_a_rotor_that_is_left_the_guardian_goes_on_stopping(sweep: Sweep) -> None:
    sweep.drive.inverter.switches.only_coast = True
    sweep.turn()
    sweep.control.stop(Stop.EMERGENCY)
    until(lambda: sweep.control.report is not None and sweep.control.report.tries, work=sweep.live)
    process = sweep.control._process
    assert process
    left = time.monotonic()
    sweep.control.close(at_rest=False)
    until(lambda: len(sweep.drive.stops(since=left)) > 1)
    assert "ended with the rotor not proven at rest" in sweep.written()
    end_guardian(sweep)
    assert process.wait(SOON) == 0


def test_a_message_that_is_none_ends_no_guardian(sweep: Sweep) -> None:
    sweep.turn()
    for text in (b'{"stop": "ra\n', b"\xff\xfe\n", b"[1]\n"):
        sweep.control._line._end.send(text)
    sweep.control.stop(Stop.RAMP)
    until(sweep.confirmed, work=sweep.live)
    assert sweep.raised == []


def test_a_defect_of_the_guardian_stops_the_rotor_and_does_not_end_it(sweep: Sweep) -> None:
    sweep.turn()
    since = time.monotonic()
    sweep.control._line.tell(start=True)  # twice: threads can only be started once
    until(lambda: sweep.raised, work=sweep.live)
    assert "a defect of the guardian (RuntimeError" in str(sweep.raised[0])
    until(lambda: sweep.drive.stops(since=since), work=sweep.live)
    sweep.control.stop(Stop.RAMP)
    until(sweep.confirmed, work=sweep.live)


def test_a_guardian_whose_files_vanish_goes_on_stopping(drive: LineDrive, tmp_path: Path) -> None:
    """As a system may remove a user's files when he logs out, which may be what ended the sweep."""
    sweep = Sweep(drive, tmp_path / "gone" / "log")
    sweep.control.open()
    sweep.turn()
    process = sweep.control._process
    assert process
    registry.address_of(sweep.control._table).unlink()
    left = time.monotonic()
    sweep.control.close(at_rest=False)
    try:
        until(lambda: len(drive.stops(since=left)) > 1)  # the first, and one of the repetitions
    finally:
        process.kill()
        process.wait()
        sweep.control._line.close()


def test_who_asks_nonsense_or_nothing_at_its_socket_does_not_disturb_it(sweep: Sweep) -> None:
    sweep.turn()
    path = registry.address_of(sweep.control._table)
    for question in (b"[]\n", b"{\n", b""):
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as asker:
            asker.connect(str(path))
            asker.sendall(question)
            asked = time.monotonic()
            until(lambda asked=asked: time.monotonic() - asked > 0.3, work=sweep.live)  # type: ignore[misc]
    assert sweep.raised == []
    answer = ask_guardian(sweep.control._table, "state")
    assert answer
    assert answer["sweep"] == os.getpid()


def test_a_guardian_of_nobody_waits_without_haste(sweep: Sweep) -> None:
    sweep.turn()
    process = sweep.control._process
    assert process
    sweep.control.close(at_rest=False)
    sweep.control._line.close()  # as when the program has ended
    begin = _processor_time(process.pid)
    time.sleep(0.6)
    assert _processor_time(process.pid) - begin < 0.3
    end_guardian(sweep)
    assert process.wait(SOON) == 0


def _processor_time(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_a_control_that_was_never_opened_can_be_closed(drive: LineDrive, tmp_path: Path) -> None:
    control: GuardedControl = Sweep(drive, tmp_path / "log").control
    control.close()
    assert control.guardian is None


def test_whatever_the_environment_says_guardians_are_asked_in_one_place_of_the_users_own(
    drive: LineDrive, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = Sweep(drive, tmp_path / "log").control._table
    place = registry.address_of(table)
    for name in ("XDG_RUNTIME_DIR", "TMPDIR", "HOME"):
        monkeypatch.setenv(name, str(tmp_path))
    assert registry.address_of(table) == place
    monkeypatch.setattr(registry, "FOLDER", tmp_path)
    (tmp_path / f"rotorrig-{os.getuid()}").symlink_to("/tmp")
    with pytest.raises(LinkLost, match="not this user's own folder"):
        ask_guardian(table, "state")


def test_a_link_is_known_by_its_port_whatever_name_and_folder_it_is_called_from(
    drive: LineDrive, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = Sweep(drive, tmp_path / "log").control._table
    here, there = tmp_path / "here", tmp_path / "there"
    for folder in (here, there):
        folder.mkdir()
        (folder / "real").touch()
        (folder / "motor").symlink_to("real")

    def address(port: str) -> Path:
        return registry.address_of(table.model_copy(update={"port": port}))

    monkeypatch.chdir(here)
    found = address("./motor")
    assert found == address(f"{here}/motor") == address("../here/real")
    monkeypatch.chdir(there)
    assert address("./motor") != found  # two benches, each with a "motor" of its own


def test_a_new_pseudo_terminal_with_the_number_of_one_that_has_gone_is_another_link(
    drive: LineDrive, tmp_path: Path
) -> None:
    table = Sweep(drive, tmp_path / "log").control._table
    places = set()
    for name in ("this", "that"):
        (tmp_path / name).symlink_to(drive.port)
        places.add(registry.address_of(table.model_copy(update={"port": str(tmp_path / name)})))
    assert len(places) == 2


def test_a_guardian_ends_its_service_though_its_port_has_another_name_by_then(drive: LineDrive, tmp_path: Path) -> None:
    name = tmp_path / "motor"
    (tmp_path / "ttyUSB0").touch()
    name.symlink_to("ttyUSB0")
    table = Sweep(drive, tmp_path / "log").control._table.model_copy(update={"port": str(name)})
    place = registry.address_of(table)
    server = registry.serve(table)
    name.unlink()  # unplugged
    assert registry.address_of(table) != place
    registry.end_service(server)
    assert not place.exists()
