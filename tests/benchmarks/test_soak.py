"""What the fault campaign is judged by: bytes on the wire, reports of the bench, what the program said."""

import struct
import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from benchmarks.parts.soak.faults import FAULTS
from benchmarks.parts.soak.judge import judge
from benchmarks.parts.soak.page import page, text, totals
from benchmarks.parts.soak.rigs import DRIVES, config
from benchmarks.parts.soak.run import Case
from benchmarks.parts.soak.wire import compare, data_frames
from rotorrig.acquisition.recording import RawRecording
from rotorrig.rig.config.description import parse
from rotorrig.rig.probes.base import Block, DaqInfo
from rotorrig.rig.provenance import Provenance

INFO = DaqInfo(model="m", serial="s", sample_rate=1e4, channels=1, volts_per_count=(1e-3,), full_scale_counts=2**23)


def frame(index: int, counts: Sequence[int]) -> bytes:
    """A DATA frame of one channel, by docs/daq-stream.md."""
    payload = struct.pack("<IQHB", 0, index, len(counts), 1)
    payload += b"".join(count.to_bytes(3, "little", signed=True) for count in counts)
    body = struct.pack("<BBH", 2, 0, len(payload)) + payload
    return b"\xa5\x5a" + body + struct.pack("<I", zlib.crc32(body))


def recording(*blocks: tuple[int, Sequence[int]]) -> RawRecording:
    return RawRecording(
        rig=parse(config("powerflex400"), where="test"),
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


def test_every_drive_of_the_campaign_is_a_rig_of_its_own() -> None:
    rigs = [parse(config(drive), where=drive) for drive in DRIVES]
    assert len({rig.motor for rig in rigs}) == len(DRIVES)


def test_frames_are_found_between_garbage_and_damaged_ones_left_out() -> None:
    damaged = bytearray(frame(2, [3, 4]))
    damaged[20] ^= 1
    wire = b"\xa5\x5a\x02" + frame(0, [1, -2]) + bytes(damaged) + frame(4, [8388607, -8388608])[:-1] + frame(6, [7])
    assert [(index, counts[:, 0].tolist()) for index, counts in data_frames(wire)] == [(0, [1, -2]), (6, [7])]


def test_what_is_on_the_wire_and_not_recorded_is_lost_and_what_the_fault_took_is_not() -> None:
    wire = frame(0, [1, 2]) + frame(2, [3, 4]) + frame(8, [5, 6]) + frame(10, [7, 8])
    whole = compare(wire, recording((0, [1, 2, 3, 4]), (8, [5, 6])))
    assert (whole.lost, whole.wrong, whole.taken, whole.tail) == (0, 0, 4, 2)
    holed = compare(wire, recording((0, [1, 2]), (8, [5, 9])))
    assert (holed.lost, holed.wrong) == (2, 1)
    invented = compare(wire, recording((0, [1, 2, 3, 4, 0, 0])))
    assert (invented.lost, invented.wrong) == (0, 2)


def recorded(kind: str, text: str, **changed: Any) -> dict[str, Any]:
    """What is kept of a recording of 5.2 s."""
    return {"complete": True, "events": [[5.2, kind, text]], "faults": [], "fastest": 41.9} | changed


def seen(**changed: Any) -> dict[str, Any]:
    """A run with a drive that trips at 5 s, and all as it should be."""
    case = {"drive": "powerflex400", "where": "drive", "fault": "drive trips", "number": 0}
    fault = {"fault": 0, "kind": "drive-fault", "on": "motor"}
    right: dict[str, Any] = {
        "case": case,
        "rate": 1.0,
        "struck": None,
        "code": 1,
        "said": "error: drive: has tripped with 'undervoltage'\n",
        "bench": [
            {"t": 0.1, "speed": 0.1, "event": "turns"},
            {**fault, "t": 5.0, "event": "begins"},
            {**fault, "t": 5.0, "event": "ends"},
            {"t": 12.5, "speed": 0.0, "event": "rests"},
        ],
        "files": ["run.mcap"],
        "salvaged": "",
        "recording": recorded("trip", "drive: has tripped"),
        "wire": {"sent": 52000, "recorded": 52000, "lost": 0, "wrong": 0, "tail": 0, "taken": 0},
    }
    return right | changed


def test_a_run_as_it_should_be_has_nothing_wrong() -> None:
    judgement = judge(seen())
    assert judgement.wrong == ()
    assert (judgement.injected, judgement.detected, judgement.stopped, judgement.lost) == (True, True, True, 0)
    assert judgement.seconds == pytest.approx(7.5)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"bench": seen()["bench"][:1] + seen()["bench"][3:]}, "not injected"),
        ({"bench": seen()["bench"][:3]}, "not at rest"),
        ({"bench": [*seen()["bench"][:3], {"t": 40.0, "speed": 0.0, "event": "rests"}]}, "not at rest"),
        ({"code": 0}, "status 0, want 1"),
        ({"code": None}, "hung"),
        ({"said": "Traceback (most recent call last):\n drive: has tripped"}, "traceback"),
        ({"said": "", "recording": recorded("emergency", "")}, "nothing says"),
        ({"recording": recorded("stop", "")}, "no event of kind"),
        ({"wire": seen()["wire"] | {"recorded": 40000}}, "ends at 4.00 s, before the fault at 5.00 s"),
        ({"recording": recorded("trip", "", complete=False)}, "calls itself cut"),
        ({"recording": recorded("trip", "", fastest=700.0)}, "recorded at 6685 rpm, asked for 400 rpm"),
        ({"wire": seen()["wire"] | {"lost": 3}}, "3 scans were on the wire"),
        ({"wire": seen()["wire"] | {"wrong": 2}}, "2 scans are recorded otherwise"),
        ({"files": ["run.mcap", "run.mcap.part"]}, "left behind"),
        ({"crashed": "Traceback\nRuntimeError: no bench"}, "the run itself failed: RuntimeError: no bench"),
    ],
)
def test_each_thing_that_is_otherwise_is_said(changed: dict[str, Any], said: str) -> None:
    (sentence, *more) = judge(seen(**changed)).wrong
    assert said in sentence
    assert not more


def finished(*events: dict[str, Any], end: float = 17.0) -> dict[str, Any]:
    """A run with a frame of the DAQ lost, in a sweep that goes on to the end of its plan."""
    marks = [[11.0, "mark", "down"], [end, "mark", "end"]]
    turning = [{"t": 0.1, "speed": 0.1, "event": "turns"}, {"t": 9.0, "speed": 41.9}, {"t": 11.0, "speed": 41.9}]
    slowing = [{"t": 17.0, "speed": 20.9}, {"t": 24.0, "speed": 0.0, "event": "rests"}]
    return seen(
        case={"drive": "powerflex400", "where": "DAQ", "fault": "one frame lost", "number": 0},
        code=0,
        said="2 samples are missing",
        recording=recorded("stop", "plan finished") | {"events": [*marks, [end, "stop", "plan finished"]]},
        wire=seen()["wire"] | {"recorded": 170_000},
        bench=[*turning, *events, *slowing],
    )


def test_a_message_that_was_never_hit_is_no_fault_injected() -> None:
    begins = {"fault": 0, "kind": "drop", "on": "daq", "t": 5.0, "event": "begins"}
    assert judge(finished(begins)).wrong == ("the fault was not injected",)
    assert judge(finished(begins, begins | {"event": "ends", "hits": 1})).wrong == ()


def test_a_plan_that_ended_before_its_time_was_not_finished() -> None:
    begins = {"fault": 0, "kind": "drop", "on": "daq", "t": 5.0, "event": "begins"}
    hit = (begins, begins | {"event": "ends", "hits": 1})
    assert judge(finished(*hit, end=11.5)).wrong == ("the rotor turned at 383 rpm at the mark 'end', want 200 rpm",)
    never = finished(*hit)
    never["recording"]["events"] = never["recording"]["events"][2:]
    assert judge(never).wrong == ("the plan was not run to the mark 'down'", "the plan was not run to the mark 'end'")


def test_page_and_text_count_what_was_judged() -> None:
    judged = [judge(seen()), judge(seen(code=0, wire=seen()["wire"] | {"lost": 3}))]
    assert totals(judged) == {
        "runs": 2,
        "faults_injected": 2,
        "faults_detected": 1,
        "rotor_stopped": 2,
        "samples_lost": 3,
        "wrong": 1,
    }
    assert "3 scans were on the wire" in text(judged)
    written = page(judged, versions=["1"])
    assert all(fault.words in written for fault in FAULTS)
    assert "1/2/2, 7.5 s, **3 lost**" in written


def test_every_run_has_a_name_and_a_seed_of_its_own() -> None:
    cases = [Case(drive=d, where=f.where, fault=f.name, number=n) for d in DRIVES for f in FAULTS for n in range(3)]
    assert len({case.name for case in cases}) == len({case.seed for case in cases}) == len(cases)
    assert len(cases) >= 500
