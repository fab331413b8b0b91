"""One run of the fault campaign: a peer bench, the program sweeping it, faults at their moments, and what was seen."""

import math
import shutil
import tempfile
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

from benchmarks.parts.soak.controllers import DWELL, LIMITS, PLAN, RATE, ROOT, config
from benchmarks.parts.soak.faults import BY_NAME, Case, Fault, Moment
from benchmarks.parts.soak.peer import Peer
from benchmarks.parts.soak.program import Line, Program

LOOK = 0.02  # s between looks
OPENING = 40.0  # s for the program to start the DAQ's stream, on a busy machine
AT_REST = 30.0  # rpm
TURNING_ON = 20.0  # s after the last fault for which a rotor that turns is watched
RESTED = 22.0  # s after it has come to rest: a proof from the probes takes 8 s
LONGEST = 90.0  # s after the first sample
LEAVE = (0.0, 1.0, 16.0, 17.0)  # s from when the operator wants to go: Ctrl-C, twice, and after a while twice again
PATIENCE = 6.0  # s after them
PLAN_ENDS, DWELL_ENDS = 15.0, 30.0  # s after the first sample, of plans nothing happens to
AFTERWARDS = 25.0  # s for which a rotor is watched after the program has gone
Result = TypeVar("Result")
_PRESSURE = Path("/proc/pressure/cpu")  # https://docs.kernel.org/accounting/psi.html


@dataclass(slots=True)
class Seen:
    """What was seen of a run."""

    case: Case
    began: float = float("nan")  # first sample, s monotonic; NaN: the stream was never started
    struck: dict[str, float] = field(default_factory=dict)  # fault -> when, s monotonic
    lines: list[Line] = field(default_factory=list)
    status: int | None = None
    ended: float = float("nan")  # of the program
    left: float | None = None  # when the operator left it, by two Ctrl-C, s monotonic
    killed: bool = False  # and that did not do either
    guardians: int = 0
    guardian_ended: float = float("nan")  # NaN: it lived to the end of the run, or there was none
    rested: float = float("nan")  # when the rotor came to rest for good
    cpu: float = 0.0
    peer_cpu: float = 0.0
    crowded: float = 0.0  # share of the time that some process of the machine waited for a processor


def run(case: Case, look: Callable[["Seen", Peer, Path], Result]) -> Result:
    """Run a case; return what `look` makes of it before the folder goes."""
    mark = uuid.uuid4().hex
    with tempfile.TemporaryDirectory(prefix="rotorrig-soak-", ignore_cleanup_errors=True) as scratch:
        folder = Path(scratch)
        (folder / "bench").mkdir()
        (folder / "out").mkdir()
        peer = Peer(case.controller, folder / "bench", root=ROOT, seed=case.seed, rate=RATE, rolling=case.rolling)
        program = None
        try:
            for name, value in case.extra:
                peer.switch(name, value=value)
            text = config(
                case.controller,
                peer.ports,
                plan=DWELL if case.dwell else PLAN,
                limits={**LIMITS, **({"run_down": case.run_down} if case.run_down else {})} if case.limits else None,
                **dict(case.motor),
            )
            (folder / "rig.toml").write_text(text, encoding="utf-8")
            words = ("sweep", str(folder / "rig.toml"), "--out", str(folder / "out/run.mcap"))
            piped = "stdout closed" in case.faults
            program = Program(words, folder=folder, root=ROOT, mark=mark, piped=piped)
            seen = _watch(case, program, peer, folder)
            seen.peer_cpu = peer.cpu
        finally:
            if program is not None:
                program.close()
            peer.close()
        return look(seen, peer, folder)


def _watch(case: Case, program: Program, peer: Peer, folder: Path) -> Seen:
    """Strike at the moments, wait for the end of the program and of the rotor."""
    began, waited = time.monotonic(), _waited()
    seen = Seen(case=case)
    _until_stream(seen, program, peer)
    due = list(zip(case.moments(), case.faults, strict=True))
    undo: list[tuple[float, Fault]] = []
    operator = _Operator(seen, program)
    next_search = 0.0
    while program.status is None and seen.began == seen.began:
        program.listen(LOOK)
        peer.follow()
        now = time.monotonic()
        for moment, name in tuple(due):
            if now - _origin(moment, seen, peer) >= moment.seconds:
                due.remove((moment, name))
                seen.struck[name] = now
                _strike(BY_NAME[name], program, peer, folder, undo)
        for end, fault in tuple(undo):
            if now >= end:
                program.strike("SIGCONT")
                undo.remove((end, fault))
        if now >= next_search:
            next_search = now + 2.0
            program.find_guardians()
        if not undo and now > _patience(seen, peer):
            operator.leave(now)
    seen.ended, seen.status, seen.cpu = program.ended, program.status, program.cpu
    _afterwards(seen, program, peer)
    seen.lines = program.lines
    seen.crowded = (_waited() - waited) / (time.monotonic() - began)
    return seen


def _until_stream(seen: Seen, program: Program, peer: Peer) -> None:
    deadline = time.monotonic() + OPENING
    while program.status is None and time.monotonic() < deadline:
        program.listen(LOOK)
        peer.follow()
        if stream := peer.first("stream"):
            seen.began = stream["t"]
            return
    if program.status is None:
        program.strike("SIGKILL")
        seen.killed = True
        while program.status is None:
            program.listen(LOOK)


def _origin(moment: Moment, seen: Seen, peer: Peer) -> float:
    """Return from when a moment is counted, s monotonic; infinite: that is still to come."""
    if moment.after:
        return seen.struck.get(moment.after, math.inf)
    if moment.above:
        passed = (t for t, rpm in zip(peer.t, peer.rpm, strict=True) if t >= seen.began and rpm > moment.above)
        return next(passed, math.inf)
    return seen.began


def _strike(fault: Fault, program: Program, peer: Peer, folder: Path, undo: list[tuple[float, Fault]]) -> None:
    """Let a fault strike."""
    for switch in fault.switches:
        peer.switch(switch, value=fault.value, seconds=fault.seconds)
    if fault.signal:
        program.strike(fault.signal)
        if fault.seconds:
            undo.append((time.monotonic() + fault.seconds, fault))
    elif fault.name == "terminal closed":
        program.close_terminal()
    elif fault.name == "stdout closed":
        program.close_pipe()
    elif fault.name == "disk full":
        sizes = [path.stat().st_size for path in (folder / "out").glob("*") if path.is_file()]
        program.fill_disk(max(sizes, default=0))
    elif fault.name == "folder deleted":
        shutil.rmtree(folder / "out", ignore_errors=True)
    elif fault.name == "guardian killed":
        program.kill_guardians()


def _patience(seen: Seen, peer: Peer) -> float:
    """Return when to stop waiting for the program's end, s monotonic."""
    last = max([seen.began, *seen.struck.values()])
    if _at_rest(peer) and len(peer.rpm) > 1:
        rested = next((t for t, rpm in zip(peer.t[::-1], peer.rpm[::-1], strict=True) if rpm > AT_REST), seen.began)
        return min(max(rested + RESTED, last + RESTED), seen.began + LONGEST)
    until = DWELL_ENDS if seen.case.dwell else PLAN_ENDS
    return min(max(last, seen.began + until) + TURNING_ON, seen.began + LONGEST)


class _Operator:
    """Leaves a program that does not end: two Ctrl-C, two more once it may have offered to be left, then kill -9."""

    def __init__(self, seen: Seen, program: Program) -> None:
        self._seen, self._program = seen, program
        self._pressed = 0

    def leave(self, now: float) -> None:
        """Do what it is time for."""
        self._seen.left = self._seen.left or now
        passed = now - self._seen.left
        if self._pressed < len(LEAVE):
            if passed >= LEAVE[self._pressed]:
                self._pressed += 1
                self._program.strike("SIGINT")
        elif passed > LEAVE[-1] + PATIENCE and not self._seen.killed:
            self._seen.killed = True
            self._program.strike("SIGKILL")


def _afterwards(seen: Seen, program: Program, peer: Peer) -> None:
    """Wait until the rotor is at rest for good, whoever stops it."""
    deadline = time.monotonic() + AFTERWARDS
    while time.monotonic() < deadline:
        program.listen(LOOK)
        peer.follow()
        living = program.find_guardians() if int(time.monotonic() * 2) % 2 else None
        if living == [] and program.guardians and seen.guardian_ended != seen.guardian_ended:
            seen.guardian_ended = time.monotonic()
        if _at_rest(peer) and not peer.on[-1] and peer.t[-1] - max(_last_turn(peer), seen.ended) > 0.5:
            break
    seen.guardians = len(program.guardians)
    seen.rested = _last_turn(peer) if _at_rest(peer) else float("nan")


def _at_rest(peer: Peer) -> bool:
    return peer.speed <= AT_REST


def _last_turn(peer: Peer) -> float:
    """Return when the rotor was last above rest, s monotonic."""
    return next((t for t, rpm in zip(peer.t[::-1], peer.rpm[::-1], strict=True) if rpm > AT_REST), 0.0)


def _waited() -> float:
    """Return for how long, of all time, some process of this machine has waited for a processor [s]; 0 if not known."""
    try:
        some = _PRESSURE.read_text(encoding="ascii").splitlines()[0]
    except OSError:  # not Linux, or an old one
        return 0.0
    return int(some.rpartition("=")[2]) * 1e-6
