"""What the fault campaign found, as text for a terminal and as docs/faults.md."""

import statistics
from collections.abc import Sequence
from datetime import UTC, datetime

from benchmarks.parts.soak.faults import FAULTS, Fault
from benchmarks.parts.soak.judge import Judgement
from benchmarks.parts.soak.rigs import DRIVES
from benchmarks.parts.tables import markdown

_LISTED = 40  # runs that were otherwise than they should be

_HEAD = """# Faults, and what becomes of them

Written by `make soak` (benchmarks/soak.py): {runs} runs on {date}, {versions}. Each run is the program `rotor sweep` on
the wires of a simulated bench, with one fault at a random moment; bench, program and judge are processes of their own.

- **injected**: the bench says that the fault struck (messages hit, port gone, drive tripped), or the signal was sent.
- **detected**: the sweep ended with the right status and said the right thing, in its own words and in the recording;
  or, where a sound program goes on, it went on to the end of its plan and said nothing wrong. No traceback, no hang.
- **rotor stopped**: the true speed of the simulated rotor fell to zero, in time.
- **samples lost**: scans that were in whole frames on the DAQ's wire, behind the fault, and are not in the recording,
  or are in it otherwise than sent. What the fault itself took is not counted. Must be 0.
- **noticed after**: from the fault to the event that ends the sweep in the recording; median and longest, of the rig's
  own time, as the next one.
- **at rest after**: from the fault to standstill; for a rotor that coasts, most of it is coasting.
"""


def totals(judged: Sequence[Judgement]) -> dict[str, int]:
    """Return the figures of the last line."""
    return {
        "runs": len(judged),
        "faults_injected": sum(j.injected for j in judged),
        "faults_detected": sum(j.detected for j in judged),
        "rotor_stopped": sum(j.stopped for j in judged),
        "samples_lost": sum(j.lost for j in judged),
        "wrong": sum(bool(j.wrong) for j in judged),
    }


def text(judged: Sequence[Judgement]) -> str:
    """Return a table by fault and what was wrong, for a terminal."""
    return "\n\n".join([_by_fault(judged), *_wrong(judged)])


def page(judged: Sequence[Judgement], *, versions: Sequence[str]) -> str:
    """Return docs/faults.md."""
    head = _HEAD.format(
        runs=len(judged), date=f"{datetime.now(UTC):%Y-%m-%d}", versions=f"code {' and '.join(versions)}"
    )
    parts = [head.strip(), "## By fault", _by_fault(judged), "## By fault and drive", _by_drive(judged)]
    parts += ["## The faults", _faults(), "## Otherwise than it should be", *(_wrong(judged) or ["Nothing."])]
    return "\n\n".join(parts) + "\n"


def _by_fault(judged: Sequence[Judgement]) -> str:
    head = ["fault", "runs", "injected", "detected", "rotor stopped", "samples lost", "noticed after", "at rest after"]
    rows = [[f"{f.where}: {f.name}", *_figures(_of(judged, f))] for f in FAULTS if _of(judged, f)]
    return markdown(head, [*rows, ["all", *_figures(judged)[:5], "", ""]])


def _figures(judged: Sequence[Judgement]) -> list[str]:
    counts = [sum(getattr(j, name) for j in judged) for name in ("injected", "detected", "stopped", "lost")]
    times = [_median_and_longest([getattr(j, name) for j in judged]) for name in ("noticed", "seconds")]
    return [*map(str, [len(judged), *counts]), *times]


def _median_and_longest(seconds: Sequence[float | None]) -> str:
    known = [s for s in seconds if s is not None]
    return f"{statistics.median(known):.2f}, {max(known):.2f} s" if known else ""


def _by_drive(judged: Sequence[Judgement]) -> str:
    """Return a table of detected of injected; where the rotor was not stopped or scans were lost, that too."""
    rows = [[f"{f.where}: {f.name}", *(_cell(_of(judged, f, drive)) for drive in DRIVES)] for f in FAULTS]
    said = "Detected of injected of runs, and the longest time to rest."
    return f"{said}\n\n{markdown(['fault', *DRIVES], rows)}"


def _cell(judged: Sequence[Judgement]) -> str:
    if not judged:
        return ""
    figures = totals(judged)
    said = f"{figures['faults_detected']}/{figures['faults_injected']}/{len(judged)}"
    times = [j.seconds for j in judged if j.seconds is not None]
    said += f", {max(times):.1f} s" if times else ""
    said += "" if figures["rotor_stopped"] == len(judged) else ", **turning**"
    return said + (f", **{figures['samples_lost']} lost**" if figures["samples_lost"] else "")


def _faults() -> str:
    """Return what every fault is and what is to come of it."""
    rows = [[f"{f.where}: {f.name}", f.words, f"the program {f.ends}", f"{f.stops_within:g} s"] for f in FAULTS]
    return markdown(["fault", "what is done", "what is to come of it", "at rest within"], rows)


def _wrong(judged: Sequence[Judgement]) -> list[str]:
    found = [f"- {j.case.name}: {'; '.join(j.wrong)}" for j in judged if j.wrong]
    more = [f"- and {len(found) - _LISTED} more"] if len(found) > _LISTED else []
    return ["\n".join([*found[:_LISTED], *more])] if found else []


def _of(judged: Sequence[Judgement], fault: Fault, drive: str = "") -> list[Judgement]:
    key = (fault.where, fault.name)
    return [j for j in judged if (j.case.where, j.case.fault) == key and (not drive or j.case.drive == drive)]
