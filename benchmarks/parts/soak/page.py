"""What the fault campaign found, as docs/faults.md and for a terminal."""

from collections.abc import Sequence

from benchmarks.parts.soak.controllers import CONTROLLERS
from benchmarks.parts.soak.faults import FAULTS
from benchmarks.parts.soak.judge import Verdict
from benchmarks.parts.soak.results import campaign, summary
from benchmarks.parts.tables import markdown

_LISTED = 40  # runs that were otherwise than they should be

_HEAD = """# Faults, and what becomes of them

Written by `make soak` (benchmarks/soak.py) from the results kept in `benchmarks/parts/soak/results/`: {runs} runs,
{dates}, code {codes}. Each run is the program `rotor sweep` on a terminal of its own, against a bench of peers: a drive
scripted from its manual on a pymodbus server, a `canopen` node, or a controller written from its specification, and a
DAQ board that samples the peer's own rotor. The peers (`tests/peers/`) share no code with rotorrig. The plan is slow
roll, 1200 rpm, stop: some 12 s in real time. Faults strike at random moments, often at the start and in the run-down,
and the judge goes by the peer's true speed.

- **said at rest, turning**: a line on the terminal, exit status 0, or the recording said "at rest" or "stopped" while
  the rotor turned above 30 rpm.
- **gone, turning**: the program ended by itself above 30 rpm, or was killed and nothing stopped the rotor, though the
  drive could be reached or has a watchdog.
- **samples lost**: scans that reached the program while the rotor turned and are in no recording, but for what the
  fault took.
- **left**: the program went on until the operator left it by two Ctrl-C, as it should where nothing can stop the rotor.
- **rest after**: from the first fault to rest, with what is left of the plan; median and longest.
"""


def page(verdicts: Sequence[Verdict]) -> str:
    """Return docs/faults.md."""
    counted = campaign(verdicts)
    dates = sorted({verdict.date for verdict in counted})
    head = _HEAD.format(
        runs=len(counted),
        dates=" to ".join(dict.fromkeys((dates[0], dates[-1]))) if dates else "none yet",
        codes=" and ".join(sorted({verdict.code for verdict in counted})),
    )
    singles = [verdict for verdict in counted if verdict.set == "singles"]
    pairs = [verdict for verdict in counted if verdict.set == "pairs"]
    parts = [head.strip(), "## In all", _table("runs", [("single faults", singles), ("pairs", pairs)])]
    parts += ["## Single faults", _by_fault(singles), "## Single faults, by controller", _by_controller(singles)]
    parts += ["## Pairs, by either fault", _by_fault(pairs), "## The faults", _faults()]
    parts += ["## Otherwise than it should be", _wrong(counted) or "Nothing."]
    return "\n\n".join(parts) + "\n"


def text(verdicts: Sequence[Verdict]) -> str:
    """Return a table by fault and what was wrong, for a terminal."""
    return "\n\n".join(part for part in (_by_fault(verdicts), _wrong(verdicts)) if part)


def _by_fault(verdicts: Sequence[Verdict]) -> str:
    rows = [("none", [v for v in verdicts if not v.faults])]
    rows += [(fault.name, [v for v in verdicts if fault.name in v.faults]) for fault in FAULTS]
    return _table("fault", [(name, some) for name, some in rows if some])


def _table(first: str, rows: Sequence[tuple[str, Sequence[Verdict]]]) -> str:
    head = [first, "runs", "said at rest, turning", "gone, turning", "tracebacks", "samples lost", "left", "rest after"]
    return markdown(head, [[name, *_figures(some)] for name, some in rows])


def _figures(verdicts: Sequence[Verdict]) -> list[str]:
    found = summary(verdicts)
    counts = [found[key] for key in ("runs", "said_stopped_turning", "gone_turning", "tracebacks", "samples_lost")]
    times = sorted(v.stop_s for v in verdicts if v.stop_s is not None and v.faults)
    rest = f"{times[len(times) // 2]:.1f}, {times[-1]:.1f} s" if times else ""
    return [*map(str, counts), str(sum(v.left for v in verdicts)), rest]


def _by_controller(verdicts: Sequence[Verdict]) -> str:
    """Return how each single fault ended on each controller: exit status, seconds to rest, what was wrong."""
    rows = []
    for fault in FAULTS:
        of_fault = {v.controller: v for v in verdicts if fault.name in v.faults}
        rows.append([fault.name, *(_cell(of_fault.get(controller)) for controller in CONTROLLERS)])
    said = "Exit status (negative: killed by that signal) and time from the fault to rest."
    return f"{said}\n\n{markdown(['fault', *CONTROLLERS], rows)}"


def _cell(verdict: Verdict | None) -> str:
    if verdict is None:
        return ""
    rest = "turning" if verdict.stop_s is None else f"{verdict.stop_s:.1f} s"
    return f"{verdict.status}, {rest}" + (f", **{', '.join(verdict.wrong)}**" if verdict.wrong else "")


def _faults() -> str:
    lasts = {None: "for good"}
    rows = [[f.where, f.name, f.words, lasts.get(f.seconds) or f"{f.seconds:g} s"] for f in FAULTS]
    return markdown(["where", "fault", "what is done", "how long"], rows)


def _wrong(verdicts: Sequence[Verdict]) -> str:
    found = [
        f"- {v.run}: {', '.join(v.wrong)}; status {v.status}, {v.rpm_at_end:.0f} rpm at its end; {v.last_line[:120]}"
        for v in verdicts
        if v.wrong
    ]
    more = [f"- and {len(found) - _LISTED} more"] if len(found) > _LISTED else []
    return "\n".join([*found[:_LISTED], *more])
