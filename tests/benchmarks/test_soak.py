"""What the fault campaign judges by: bytes on the wire, words, status, the peer's true speed; and its kept results."""

import json
import math
import os
import signal
import struct
import subprocess
import sys
import time
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.parts.soak.cases import CASES
from benchmarks.parts.soak.controllers import CONTROLLERS, config
from benchmarks.parts.soak.faults import FAULTS, PAIRED, Case, pairs, singles
from benchmarks.parts.soak.judge import Verdict, claim, judge
from benchmarks.parts.soak.page import page, text
from benchmarks.parts.soak.peer import Peer
from benchmarks.parts.soak.program import GUARDIAN, MARK, Line, Program
from benchmarks.parts.soak.results import FOLDER, campaign, keep, kept, prune, summary
from benchmarks.parts.soak.run import Seen
from benchmarks.parts.soak.wire import compare, data_frames
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.config.description import parse
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

INFO = DaqInfo(model="m", serial="s", sample_rate=1e4, channels=1, volts_per_count=(1e-3,), full_scale_counts=2**23)
PORTS = {"motor": {"port": "/dev/ttyUSB0"}, "daq": {"port": "/dev/ttyACM0"}}


def frame(index: int, counts: Sequence[int]) -> bytes:
    """A DATA frame of one channel, by docs/daq-stream.md."""
    payload = struct.pack("<IQHB", 0, index, len(counts), 1)
    payload += b"".join(count.to_bytes(3, "little", signed=True) for count in counts)
    body = struct.pack("<BBH", 2, 0, len(payload)) + payload
    return b"\xa5\x5a" + body + struct.pack("<I", zlib.crc32(body))


def recording(*blocks: tuple[int, Sequence[int]]) -> RawRecording:
    return RawRecording(
        rig=parse(config("vfd-ed-rtu", PORTS), where="test"),
        daq=INFO,
        blocks=tuple(
            Block(counts=np.array(counts, dtype=np.int32)[:, None], first_sample=first, t_ns=100_000 * first)
            for first, counts in blocks
        ),
        events=(),
        motor=(),
        source=Provenance(config_hash="", code_version="", source=""),
        complete=True,
    )


def test_frames_are_found_between_garbage_and_damaged_ones_left_out() -> None:
    damaged = bytearray(frame(2, [3, 4]))
    damaged[20] ^= 1
    wire = b"\xa5\x5a\x02" + frame(0, [1, -2]) + bytes(damaged) + frame(4, [8388607, -8388608])[:-1] + frame(6, [7])
    assert [(index, counts[:, 0].tolist()) for index, counts in data_frames(wire)] == [(0, [1, -2]), (6, [7])]


def test_what_is_on_the_wire_and_not_recorded_is_lost_and_what_the_fault_took_is_not() -> None:
    wire = frame(0, [1, 2]) + frame(2, [3, 4]) + frame(8, [5, 6]) + frame(10, [7, 8])
    whole = compare(wire, [recording((0, [1, 2, 3, 4]), (8, [5, 6, 7, 8]))])
    assert (whole.lost, whole.wrong, whole.sent) == (0, 0, 8)
    holed = compare(wire, [recording((0, [1, 2]), (8, [5, 9]))])
    assert (holed.lost, holed.wrong) == (4, 1)
    assert compare(wire, [recording((0, [1, 2]), (8, [5, 6]))], begin=4, end=10).lost == 0
    invented = compare(wire, [recording((0, [1, 2, 3, 4, 0, 0]), (8, [5, 6, 7, 8]))])
    assert (invented.lost, invented.wrong) == (0, 2)


def test_a_recording_that_goes_on_elsewhere_is_part_of_what_was_recorded() -> None:
    wire = frame(0, [1, 2]) + frame(2, [3, 4])
    assert compare(wire, [recording((0, [1, 2])), recording((2, [3, 4]))]).lost == 0
    assert compare(wire, []).lost == 4


def test_a_board_that_begins_again_is_not_followed() -> None:
    assert compare(frame(0, [1]) + frame(1, [2]) + frame(0, [9]), [recording((0, [1, 2]))]).lost == 0


@pytest.mark.parametrize(
    ("said", "claimed"),
    [
        ("at rest 4.7 s after the stop", "rest"),
        ("keyphasor: no pulse; the rotor was stopped; run.mcap holds the sweep up to the trip", "rest"),
        ("THE ROTOR MAY STILL BE TURNING: the drive confirmed no stop", "turning"),
        ("the rotor is still turning at 300 rpm 3 s after the stop", "turning"),
        ("whether the rotor is at rest is unknown", "turning"),
        ("run.mcap: 12.0 s, 60000 scans, 0 gaps recorded", ""),
    ],
)
def test_words_are_told_apart(said: str, claimed: str) -> None:
    assert claim(said) == claimed


class Bench(Peer):
    """A rotor whose speed over time is given."""

    def __init__(
        self, wire: Path, speeds: Sequence[tuple[float, float]], events: Sequence[dict[str, Any]] = ()
    ) -> None:
        self.wire = wire
        self.events = list(events)
        self.t = [t for t, _ in speeds]
        self.rpm = [rpm for _, rpm in speeds]
        self.on = [rpm > 0 for rpm in self.rpm]


STOPPING = ((0.0, 0.0), (2.0, 1200.0), (6.0, 1200.0), (8.0, 0.0), (20.0, 0.0))
FOREVER = ((0.0, 0.0), (2.0, 1200.0), (20.0, 1200.0))


def judged(folder: Path, said: str, *, speeds: Any = STOPPING, faults: Any = None, **seen: Any) -> Verdict:
    """A run of which the program's last line came at 9 s, and what it is found to be."""
    case = Case(set="singles", controller="vfd-ed-rtu", faults=())
    rested = 7.95 if speeds is STOPPING else math.nan
    facts = {"began": 0.0, "struck": faults or {}, "status": 1, "ended": 9.0, "rested": rested} | seen
    stop = {"t": 9.2, "event": "command", "kind": "ramp", "on": True}
    return judge(
        Seen(case=case, lines=[Line(facts["ended"], said)], **facts), Bench(folder / "wire", speeds, [stop]), folder
    )


def test_a_rotor_said_to_be_at_rest_when_it_is_is_nothing_wrong(tmp_path: Path) -> None:
    assert judged(tmp_path, "error: a trip; the rotor was stopped").wrong == []
    assert judged(tmp_path, "run.mcap: 8 s", status=0).wrong == []


@pytest.mark.parametrize("status", [0, 1])
def test_a_rotor_said_to_be_at_rest_that_turns_is_wrong(tmp_path: Path, status: int) -> None:
    verdict = judged(tmp_path, "at rest 0.9 s after the stop" if status else "done", status=status, ended=7.0)
    assert verdict.said_stopped_turning
    assert verdict.said_at_rpm == pytest.approx(600.0)
    assert verdict.gone_turning  # by itself, with a path to stop it


def test_a_rotor_that_nothing_can_stop_may_be_left_by_the_operator_alone(tmp_path: Path) -> None:
    gone = {"link closed": 3.0}
    assert judged(tmp_path, "MAY STILL BE TURNING", speeds=FOREVER, faults=gone).wrong == []
    assert judged(tmp_path, "MAY STILL BE TURNING", speeds=FOREVER).wrong == ["gone_turning"]
    assert judged(tmp_path, "MAY STILL BE TURNING", speeds=FOREVER, left=8.0).wrong == []


def test_a_run_in_which_no_sample_was_taken_proves_nothing_and_is_wrong(tmp_path: Path) -> None:
    verdict = judged(tmp_path, "error: motor: its link is another sweep's", began=math.nan, speeds=((0.0, 0.0),))
    assert verdict.wrong == ["untested"]
    assert summary([verdict])["untested"] == 1


def test_a_killed_program_is_gone_if_nobody_stops_the_rotor_and_the_guardian_is_timed(tmp_path: Path) -> None:
    killed = {"faults": {"kill -9": 3.0}, "status": -9, "ended": 5.0}
    assert judged(tmp_path, "", speeds=FOREVER, **killed).wrong == ["gone_turning"]
    assert judged(tmp_path, "", **killed).wrong == []
    guarded = judged(tmp_path, "", guardians=1, **killed)
    assert guarded.guardian_stop_ms == pytest.approx(6200.0)  # from the blow on, which is seen later


def test_what_the_guardian_wrote_is_compared_too(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    now = time.monotonic()
    speeds = tuple((now - 9.0 + t, rpm) for t, rpm in FOREVER)
    (tmp_path / "out/run.guardian.json").write_text('{"rotor": "at rest"}')
    killed = {"faults": {"kill -9": now - 6.0}, "status": -9, "began": now - 9.0, "ended": now - 4.0, "guardians": 1}
    verdict = judged(tmp_path, "", speeds=speeds, **killed)
    assert verdict.claims["guardian"] == "rest"
    assert verdict.said_stopped_turning


def test_a_guardian_is_known_by_its_command_line_and_the_mark_of_its_run(tmp_path: Path) -> None:
    program = Program(("--help",), folder=tmp_path, root=tmp_path, mark="mine", piped=False)
    words = [sys.executable, "-c", "import time; time.sleep(60)", GUARDIAN]
    with (
        subprocess.Popen(words, env={**os.environ, MARK: "mine"}) as guardian,
        subprocess.Popen(words, env={**os.environ, MARK: "another's"}) as stranger,
    ):
        assert program.find_guardians() == [guardian.pid]
        assert program.kill_guardians() == 1
        assert guardian.wait(10) == -signal.SIGKILL
        assert program.find_guardians() == []
        stranger.kill()
    program.close()


def test_last_line_and_status_must_agree(tmp_path: Path) -> None:
    assert judged(tmp_path, "the rotor is not at rest", status=0).wrong == ["contradiction"]


def test_a_traceback_is_counted(tmp_path: Path) -> None:
    assert judged(tmp_path, "Traceback (most recent call last):").wrong == ["tracebacks"]


def test_every_run_has_a_name_and_a_seed_of_its_own() -> None:
    cases = [*pairs(), *singles(), *CASES.values()]
    assert len({case.run for case in cases}) == len({case.seed for case in cases}) == len(cases)
    assert len(pairs()) == 3 * len(PAIRED) * (len(PAIRED) - 1) // 2 >= 1000
    assert all(len(case.moments()) == len(case.faults) for case in cases)
    assert cases[7].moments() == cases[7].moments()


def test_every_controller_is_a_rig_of_its_own() -> None:
    rtu = {"port": "/dev/ttyUSB0"}
    places = {"canopen": {"channel": "/dev/ttyUSB0"}, "tcp": {"host": "127.0.0.1"}}
    rigs = [
        parse(config(name, {**PORTS, "motor": places.get(name.rpartition("-")[2], rtu)}), where=name)
        for name in CONTROLLERS
    ]
    assert len({rig.motor for rig in rigs}) == len(CONTROLLERS)


def verdict(number: int, **changed: Any) -> Verdict:
    """A run with a fault, as it should be."""
    name = FAULTS[number % len(FAULTS)].name
    facts = {
        "set": "pairs",
        "seed": number,
        "controller": "line",
        "faults": {name: 3.0},
        "stop_s": 4.0,
        "date": "2026-11-22",
    }
    return Verdict(run=f"line: {name} #{number}", **(facts | changed))


def test_the_newest_line_of_a_run_counts(tmp_path: Path) -> None:
    keep(verdict(1, gone_turning=True), version="old", folder=tmp_path)
    keep(verdict(2), version="old", folder=tmp_path)
    keep(verdict(1), version="new", folder=tmp_path)
    assert [(found.code, found.gone_turning) for found in kept(tmp_path).values()] == [("new", False), ("old", False)]
    prune(tmp_path)
    assert len((tmp_path / "pairs.jsonl").read_text().splitlines()) == 2


def test_the_summary_counts_runs_and_leaves_named_cases_out() -> None:
    times = [verdict(n, guardian_stop_ms=float(n)) for n in range(100)]
    others = [verdict(200, samples_lost=7, set="singles"), verdict(201, gone_turning=True, set="cases")]
    assert summary(others)["gone_turning"] == 1
    found = summary(campaign([*times, *others]))
    assert (found["runs"], found["pairs"], found["samples_lost"], found["gone_turning"]) == (101, 100, 7, 0)
    assert found["guardian_stop_ms_p99"] == 98.0


def test_page_and_text_say_what_was_wrong() -> None:
    verdicts = [verdict(1), verdict(2, samples_lost=3, last_line="the end", set="singles")]
    assert "samples_lost; status None" in text(verdicts)
    written = page(verdicts)
    assert all(fault.words in written for fault in FAULTS)
    assert "None, 4.0 s, **samples_lost**" in written


def test_kept_results_can_be_read_and_name_no_place_of_the_machine() -> None:
    runs = kept()
    for path in FOLDER.glob("*.jsonl"):
        for line in path.read_text(encoding="utf-8").splitlines():
            assert "/tmp/" not in line
            assert json.loads(line)["run"] in runs
