"""Judges a run from outside: what the program said, its status and its recording, against the rotor's true speed."""

import math
import re
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

from benchmarks.parts.soak.controllers import RATE, has_watchdog
from benchmarks.parts.soak.faults import BY_NAME
from benchmarks.parts.soak.peer import Peer
from benchmarks.parts.soak.run import AT_REST, Seen
from benchmarks.parts.soak.wire import Comparison, compare
from rotorrig.acquisition import RawRecording
from rotorrig.acquisition.files import read_recording, salvage
from rotorrig.rig import RigError

SETTLE = 0.5  # s: what a killed program had not written yet, and what was under way
CLOSING = 1.0  # s between the last sample of a recording and the end of the DAQ's stream
NOTICE = 1.0  # s within which a program is to notice that its folder is gone
_TURNING = re.compile(r"(?i)still (be )?turning|\bunknown\b|not at rest|keeps turning|is turning|\bturning at\b")
_REST = re.compile(r"(?i)\bat rest\b|\bat a standstill\b|rotor (was|is|has) (been )?stopped|stands still")
_GUARDIAN_WRITES = (".json", ".jsonl", ".txt", ".log")  # beside the recording
_LAST_WORDS = 300  # characters of it
WRONG = ("said_stopped_turning", "gone_turning", "tracebacks", "samples_lost", "contradiction", "killed", "untested")
HANGS = "SIGSTOP for 3 s"
_ENDS_STREAM = {"DAQ silent", "DAQ late", "DAQ restarts"}  # a sweep may take no samples after these


@dataclass(slots=True, kw_only=True)
class Verdict:
    """What came of a run; one line of the kept results."""

    run: str
    set: str
    seed: int
    controller: str
    faults: dict[str, float]  # at which moment each struck, s after the first sample
    code: str = ""
    date: str = ""
    status: int | None = None
    last_line: str = ""
    claims: dict[str, str] = field(default_factory=dict)  # by "line", "status", "recording", "guardian"
    said_stopped_turning: bool = False
    said_at_rpm: float = 0.0  # the fastest true speed at which "at rest" or "stopped" was said
    gone_turning: bool = False
    rpm_at_end: float = 0.0  # true speed when the program ended
    tracebacks: int = 0
    samples_lost: int = 0
    contradiction: bool = False
    left: bool = False
    killed: bool = False
    untested: bool = False  # the sweep never took a sample, whatever kept it from that
    guardian_stop_ms: float | None = None  # from the program's death to the first stop at the drive
    first_stop_s: float | None = None  # from the first fault to the first stop at the drive
    stop_s: float | None = None  # from the first fault to rest
    fastest_rpm: float = 0.0  # true speed
    started: bool = False  # the drive was sent to a speed
    seconds: float = 0.0
    cpu_s: float = 0.0
    peer_cpu_s: float = 0.0
    crowded: float = 0.0
    notes: list[str] = field(default_factory=list)

    @property
    def wrong(self) -> list[str]:
        """Names of what must not be."""
        return [name for name in WRONG if getattr(self, name)]


def judge(seen: Seen, peer: Peer, folder: Path) -> Verdict:
    """Judge a run."""
    case = seen.case
    verdict = Verdict(
        run=case.run,
        set=case.set,
        seed=case.seed,
        controller=case.controller,
        faults={name: round(t - seen.began, 2) for name, t in seen.struck.items() if name in BY_NAME},
        status=seen.status,
        last_line=seen.lines[-1].text.replace(f"{folder}/", "")[:300] if seen.lines else "",
        rpm_at_end=round(peer.speed_at(seen.ended), 1),
        tracebacks=sum("Traceback (most recent call last)" in line.text for line in seen.lines),
        left=seen.left is not None,
        killed=seen.killed,
        seconds=round(seen.ended - seen.began, 1),
        cpu_s=round(seen.cpu, 1),
        peer_cpu_s=round(seen.peer_cpu, 1),
        crowded=round(seen.crowded, 2),
    )
    if math.isnan(seen.began):
        verdict.untested = True
        verdict.seconds = 0.0
        return verdict
    recordings = list(_recordings(folder))
    _judge_words(verdict, seen, peer, recordings, folder)
    _judge_end(verdict, seen, peer)
    _judge_samples(verdict, seen, peer, recordings)
    return verdict


def claim(text: str) -> str:
    """Return what a text says of the rotor: "rest", "turning" (or not known), or nothing.

    >>> claim("interrupted: the rotor was stopped; run.mcap holds the sweep so far")
    'rest'
    >>> claim("the rotor is not at rest: still turning at 300 rpm")
    'turning'
    >>> claim("run.mcap: 12.0 s, 60000 scans, 0 gaps recorded")
    ''
    """
    if _TURNING.search(text):
        return "turning"
    return "rest" if _REST.search(text) else ""


def _judge_words(verdict: Verdict, seen: Seen, peer: Peer, recordings: list[RawRecording], folder: Path) -> None:
    """Compare what is said of the rotor, wherever it is said, with its true speed and with one another."""
    orderly = seen.status is not None and seen.status >= 0 and not seen.killed
    spoken = [(line.t, line.text) for line in seen.lines if claim(line.text) == "rest"]
    verdict.claims["line"] = next((claim(line.text) for line in seen.lines[::-1][:3] if claim(line.text)), "")
    if orderly:
        verdict.claims["status"] = "rest" if seen.status == 0 else ""
        if seen.status == 0:
            spoken.append((seen.ended, "status 0"))
    notes = [event.text for recording in recordings for event in recording.events if claim(event.text)]
    if notes:
        verdict.claims["recording"] = claim(notes[-1])
        if claim(notes[-1]) == "rest":
            spoken.append((seen.ended, notes[-1]))
    for path in sorted(folder.rglob("out/*")):
        if path.is_file() and path.suffix in _GUARDIAN_WRITES:
            words = path.read_text(encoding="utf-8", errors="replace").rstrip()[-_LAST_WORDS:]
            verdict.claims["guardian"] = claim(words)
            if claim(words) == "rest":
                spoken.append((path.stat().st_mtime - time.time() + time.monotonic(), f"{path.name}: {words}"))
    false = [(peer.speed_at(t), text) for t, text in spoken if peer.speed_at(t) > AT_REST]
    if false:
        verdict.said_stopped_turning = True
        speed, text = max(false)
        verdict.said_at_rpm = round(speed, 1)
        verdict.notes.append(f"said at {speed:.0f} rpm: {text.replace(f'{folder}/', '')[:200]}")
    if orderly:
        told = {verdict.claims.get(where, "") for where in ("line", "status", "recording")} - {""}
        verdict.contradiction = len(told) > 1


def _judge_end(verdict: Verdict, seen: Seen, peer: Peer) -> None:
    """Judge whether the rotor was left to itself, and how soon it was stopped."""
    first = min(seen.struck.values(), default=seen.began)
    if not math.isnan(seen.rested):
        verdict.stop_s = round(max(0.0, seen.rested - first), 2)
    verdict.fastest_rpm = max((rpm for t, rpm in zip(peer.t, peer.rpm, strict=True) if t >= seen.began), default=0.0)
    verdict.started = any(e["event"] == "command" and e["kind"] == "run" for e in peer.events)
    if stop := peer.first_stop(after=first):
        verdict.first_stop_s = round(stop["t"] - first, 2)
    died = seen.status is not None and seen.status < 0
    death = seen.struck.get("kill -9", seen.ended)  # the end is seen some time after the blow
    if died and not seen.killed and (stop := peer.first_stop(after=death)) and seen.guardians:
        verdict.guardian_stop_ms = round((stop["t"] - death) * 1e3, 1)
    turning = verdict.rpm_at_end > AT_REST
    forever = math.isnan(seen.rested)
    guarded = seen.guardians > 0 and math.isnan(seen.guardian_ended)
    if turning and seen.left is None and not guarded and _path_exists(seen):
        verdict.gone_turning = forever or not died


def _path_exists(seen: Seen) -> bool:
    """Return whether anything could stop the rotor after the program's end: the drive listens, or watches."""
    struck = seen.struck
    obeys = not {"ignores stop", "deaf"} & set(struck)
    link = not {"link closed", "link silent", "one supply"} & set(struck)
    watchdog = has_watchdog(seen.case.controller) and "no watchdog" not in dict(seen.case.extra)
    return (link and obeys) or watchdog


def _judge_samples(verdict: Verdict, seen: Seen, peer: Peer, recordings: list[RawRecording]) -> None:
    """Count the scans that reached the program and are in no recording, but for what the faults took."""
    if not peer.wire.exists():
        return
    sent = peer.wire.read_bytes()
    begin, end = _excused(seen, peer)
    result = compare(sent, recordings, begin=begin, end=end)
    verdict.samples_lost = result.lost + result.wrong
    if verdict.samples_lost:
        verdict.notes.append(f"samples: {_in_words(result)}")


def _excused(seen: Seen, peer: Peer) -> tuple[int, int]:
    """Return between which scans nothing may be missing: while the rotor turns and the program has not ended."""
    began, struck = seen.began, seen.struck
    stream_ended = peer.first("stream ended", after=began)
    end = min(seen.ended, stream_ended["t"] - CLOSING if stream_ended else math.inf)
    if seen.status is None or seen.status < 0 or seen.killed:
        end = min(end, seen.ended - SETTLE)
        if seen.ended - struck.get(HANGS, -math.inf) < BY_NAME[HANGS].seconds:  # it was killed while it hung
            end = min(end, struck[HANGS] - SETTLE)
    else:
        end = min(end, seen.ended - CLOSING)
    if seen.left is not None:
        end = min(end, seen.left)
    if not math.isnan(seen.rested):
        end = min(end, seen.rested)
    for name, t in struck.items():
        if name in _ENDS_STREAM:
            end = min(end, t)
        if name == "disk full":
            end = min(end, t - SETTLE)
    begin = struck["folder deleted"] + NOTICE if "folder deleted" in struck else began
    return round((begin - began) * RATE), round((end - began) * RATE)


def _recordings(folder: Path) -> Iterator[RawRecording]:
    """Yield what was recorded, wherever it is; what was cut is saved first."""
    scratch = folder / "salvaged"
    scratch.mkdir(exist_ok=True)
    paths = [path for path in folder.rglob("*.mcap*") if path.is_file() and scratch not in path.parents]
    for number, path in enumerate(sorted(paths)):
        try:
            if path.suffix == ".mcap":
                yield read_recording(path)
                continue
        except RigError:
            pass
        saved = scratch / f"{number}.mcap"
        try:
            salvage(path, saved)
            yield read_recording(saved)
        except RigError:
            continue


def _in_words(result: Comparison) -> str:
    return ", ".join(f"{key} {value}" for key, value in asdict(result).items())
