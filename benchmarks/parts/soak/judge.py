"""Judges a run of the fault campaign by what was seen from outside."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.parts.soak.faults import Ends, Fault
from benchmarks.parts.soak.rigs import FASTEST, SAMPLE_RATE, START
from benchmarks.parts.soak.run import Case
from rotorrig.rig.config import RPM

Seen = Mapping[str, Any]

STATUS = {
    Ends.FINISHED: 0,
    Ends.STOPPED: 1,
    Ends.LINK_LOST: 1,
    Ends.INTERRUPTED: 130,
    Ends.KILLED: -9,
    Ends.DISK_FULL: 1,
}
ENDING = {  # the kind of the event that says in the recording why the sweep ended
    Ends.FINISHED: ("stop",),
    Ends.STOPPED: ("trip", "emergency"),
    Ends.LINK_LOST: ("emergency",),
    Ends.INTERRUPTED: ("abort",),
}
_SHORT = 0.5  # s of the rig's time: samples under way to the program at the moment of the fault
_TOO_FAST = 1.1
_OFF = 0.1  # of a speed: between two words of the bench a second passes
_TAIL = 0.5  # s of wall time: what a killed program had not written yet, and what was still in the line


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """What came of a run; `wrong` says in sentences what should have been otherwise."""

    case: Case
    injected: bool
    detected: bool  # or gone on in spite of, where that is the right thing to do
    stopped: bool
    lost: int  # scans beyond what the fault took
    noticed: float | None  # s of the rig's time from the fault to what the recording says of its end; None: nothing
    seconds: float | None  # of the rig's time from the fault to rest; None: the sweep was to go on
    wrong: tuple[str, ...]


def judge(seen: Seen) -> Judgement:
    """Judge one run."""
    case = Case(**seen["case"])
    if "crashed" in seen:
        why = f"the run itself failed: {_last(seen['crashed'])}"
        return Judgement(
            case=case, injected=False, detected=False, stopped=False, lost=0, noticed=None, seconds=None, wrong=(why,)
        )
    fault = case.what
    struck = _struck(fault, seen)
    rest = _rest(seen)
    unseen = _detection(fault, seen) + (_plan(seen) if fault.ends is Ends.FINISHED else [])
    file_wrong, lost = _recording(fault, seen, struck)
    seconds = rest - struck if rest is not None and struck is not None and fault.ends is not Ends.FINISHED else None
    late = rest is None or (seconds is not None and seconds > fault.stops_within)
    wrong = [] if struck is not None else ["the fault was not injected"]
    wrong += unseen + file_wrong
    wrong += [f"the rotor was not at rest {fault.stops_within:g} s after the fault"] if late else []
    return Judgement(
        case=case,
        injected=struck is not None,
        detected=struck is not None and not unseen,
        stopped=not late,
        lost=lost,
        noticed=_noticed(fault, seen, struck),
        seconds=seconds,
        wrong=tuple(wrong),
    )


def _struck(fault: Fault, seen: Seen) -> float | None:
    """Return when the fault struck [s of the rig's time]; None if it did not."""
    if fault.disk_full:
        cut = "recording" in seen and not seen["recording"]["complete"]
        return seen["wire"]["recorded"] / SAMPLE_RATE if cut else None
    if fault.signals:
        return seen["struck"]["t"] if seen["struck"] else None
    of_fault = [line for line in seen["bench"] if "fault" in line]
    begins = next((line["t"] for line in of_fault if line["event"] == "begins"), None)
    ends = next((line for line in of_fault if line["event"] == "ends"), None)
    missed = ends["hits"] == 0 if ends and "hits" in ends else "count" in (fault.script or {}) and not ends
    return None if missed else begins


def _rest(seen: Seen) -> float | None:
    """Return when the rotor came to rest for good [s of the rig's time]; None if it did not."""
    moves = [line for line in seen["bench"] if line.get("event") in ("turns", "rests")]
    return moves[-1]["t"] if moves and moves[-1]["event"] == "rests" else None


def _detection(fault: Fault, seen: Seen) -> list[str]:
    """Return what is wrong with how the program ended and with what it said."""
    said = " ".join([seen["said"], *(f"{kind}: {text}" for _, kind, text in _events(seen))])
    wrong = []
    if seen["code"] is None:
        wrong.append("the program hung")
    elif seen["code"] != STATUS[fault.ends]:
        wrong.append(f"the program ended with status {seen['code']}, want {STATUS[fault.ends]}: {_last(seen['said'])}")
    kinds = [kind for _, kind, _ in _events(seen)]
    if (want := _ending(fault)) and not set(want) & set(kinds):
        wrong.append(f"the recording has no event of kind {' or '.join(want)}")
    if "Traceback" in said:
        wrong.append("the program showed a traceback")
    if fault.says and not re.search(fault.says, said):
        wrong.append(f"nothing says /{fault.says}/: {_last(seen['said'])}")
    if fault.never and (match := re.search(fault.never, said)):
        wrong.append(f"'{match.group()}' is said of a sweep that should go on")
    return wrong


def _plan(seen: Seen) -> list[str]:
    """Return where the true speed was not that of the plan at the marks of one that was finished."""
    speeds = [(line["t"], line["speed"]) for line in seen["bench"] if "speed" in line]
    marks = {text: t for t, kind, text in _events(seen) if kind == "mark"}
    wrong = []
    for mark, low, high in (("down", FASTEST, FASTEST), ("end", 0.0, START)):
        if mark not in marks:
            wrong.append(f"the plan was not run to the mark '{mark}'")
            continue
        speed = float(np.interp(marks[mark], *np.transpose(speeds)))
        if not (1 - _OFF) * low <= speed <= (1 + _OFF) * high:
            wrong.append(f"the rotor turned at {speed * RPM:.0f} rpm at the mark '{mark}', want {high * RPM:.0f} rpm")
    return wrong


def _noticed(fault: Fault, seen: Seen, struck: float | None) -> float | None:
    """Return how long after the fault the sweep ended for it [s of the rig's time]."""
    if struck is None or fault.ends is Ends.FINISHED:
        return None
    ended = (t for t, kind, _ in _events(seen) if kind in _ending(fault))
    return next((max(0.0, t - struck) for t in ended), None)  # with the DAQ gone its clock stands: before the fault


def _ending(fault: Fault) -> tuple[str, ...]:
    return fault.recorded or ENDING.get(fault.ends, ())


def _recording(fault: Fault, seen: Seen, struck: float | None) -> tuple[list[str], int]:
    """Return what is wrong with the recording, and how many scans it lost."""
    if "recording" not in seen:
        return [f"no recording to be read: {seen['unreadable']} {seen['salvaged']}".strip()], 0
    wire, recording = seen["wire"], seen["recording"]
    wrong = []
    if wire["lost"]:
        wrong.append(f"{wire['lost']} scans were on the wire and are not in the recording")
    if wire["wrong"]:
        wrong.append(f"{wire['wrong']} scans are recorded otherwise than sent")
    if struck is not None and (until := (wire["recorded"] + wire["taken"]) / SAMPLE_RATE) < struck - _SHORT:
        wrong.append(f"the recording ends at {until:.2f} s, before the fault at {struck:.2f} s")
    if recording["faults"] and fault.ends is Ends.FINISHED:
        wrong.append(f"the drive is recorded with the fault {', '.join(recording['faults'])}")
    if recording["fastest"] > _TOO_FAST * FASTEST:
        wrong.append(
            f"the drive is recorded at {recording['fastest'] * RPM:.0f} rpm, asked for {FASTEST * RPM:.0f} rpm"
        )
    cut = fault.ends in (Ends.KILLED, Ends.DISK_FULL)
    if recording["complete"] == cut:
        wrong.append(f"the recording calls itself {'whole' if cut else 'cut'}")
    if fault.ends is not Ends.KILLED and seen["files"] != ["run.mcap"]:
        wrong.append(f"left behind: {', '.join(seen['files'])}")
    if fault.ends is Ends.KILLED and wire["tail"] > _TAIL * SAMPLE_RATE * seen["rate"]:
        wrong.append(f"{wire['tail']} scans before the end are not in what was salvaged")
    return wrong, wire["lost"] + wire["wrong"]


def _events(seen: Seen) -> list[tuple[float, str, str]]:
    return [(t, kind, text) for t, kind, text in seen.get("recording", {}).get("events", [])]


def _last(said: str) -> str:
    """Return the last line that was said."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return lines[-1] if lines else "(nothing)"
