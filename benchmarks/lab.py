"""What it costs to work through many recordings by `rotor lab run`, and what a kill costs.

    python benchmarks/lab.py --write                              (1000 recordings; hours; kept for docs/lab.md)
    python benchmarks/lab.py --recordings 40 --diagnose 4         (minutes)
    python benchmarks/lab.py --summary --json                     (of the run that is kept)

The recordings are short sweeps of simulated RK4s (parts/lab/recordings.py), made once. Two workers are compared with
two plain processes side by side, in time and in every bit of the results; overhead is of tasks that do nothing; a
worker and the command are killed, and the same command goes on. The pages are those of a made-up lab of as many runs.
Figures of time want a machine that does nothing else.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.parts.lab.compare import count_differences
from benchmarks.parts.lab.page_speed import measure_page
from benchmarks.parts.lab.recordings import link_recordings, make_recordings
from benchmarks.parts.lab.runs import Memory, run_command, run_plainly, run_with_kills
from rotorrig.app.lab import query_table
from rotorrig.app.lab.cluster import connect, do_jobs
from rotorrig.rig import code_version

ROOT = Path(__file__).parents[1]
KEPT = ROOT / "benchmarks/parts/lab/results.jsonl"
LABS = ROOT / ".cache/lab/labs"
WORKERS = 2
STEPS = "track,identify"
EMPTY_TASKS = 500
IMPORTS = 5  # processes
KILLED = 40  # recordings of the run with kills, at most


def main() -> None:
    """Measure, print, and keep the result if asked."""
    options = arguments()
    result = newest(KEPT) if options.summary else measure(options.recordings, options.diagnose)
    for key, value in result.items():
        print(f"{key:24} {value}")
    if options.write and not options.summary:
        with KEPT.open("a", encoding="utf-8") as file:
            file.write(json.dumps(result) + "\n")
    if options.json:
        print(json.dumps(result))


def newest(path: Path) -> dict[str, Any]:
    """Return the last result that is kept."""
    lines = path.read_text(encoding="utf-8").splitlines()
    kept: dict[str, Any] = json.loads(lines[-1])
    return kept


def measure(number: int, diagnosed: int) -> dict[str, Any]:
    """Return all figures of that many recordings, some of them diagnosed too."""
    load = os.getloadavg()[0]
    paths = make_recordings(number, workers=WORKERS)
    shutil.rmtree(LABS, ignore_errors=True)
    run_command(
        link_recordings(LABS / "first", paths[:WORKERS]), workers=WORKERS, steps=STEPS
    )  # compiles what there is
    together, plain = (link_recordings(LABS / name, paths) for name in ("together", "plain"))
    memory = Memory()
    seconds_plain = run_plainly(plain, workers=WORKERS, steps=STEPS)
    seconds = run_command(together, workers=WORKERS, steps=STEPS, memory=memory)
    again = run_command(together, workers=WORKERS, steps=STEPS)
    killed = run_with_kills(link_recordings(LABS / "killed", paths[:KILLED]), workers=WORKERS, steps=STEPS)
    return {
        "recordings": number,
        "workers": WORKERS,
        "seconds": round(seconds, 1),
        "seconds_plain": round(seconds_plain, 1),
        "efficiency": round(seconds_plain / seconds, 3),
        **measure_overhead(EMPTY_TASKS),
        "seconds_again": round(again, 1),
        "differences": count_differences(plain, together),
        "memory_tenth_mib": round(memory.after(0.1, of=number)),
        "memory_end_mib": round(memory.after(0.9, of=number)),
        "killed_recordings": min(number, KILLED),
        "killed_before": killed.before,
        "resumed_twice": killed.twice,
        "orphans": killed.orphans,
        "missing": killed.missing,
        **measure_diagnoses(paths[:diagnosed]),
        **{name: round(value, 1) for name, value in measure_page(number).items()},
        "import_ms": round(measure_import(), 1),
        "load_before": round(load, 1),
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "version": code_version(),
    }


def measure_overhead(tasks: int) -> dict[str, float]:
    """Return what a task costs that does nothing [ms].

    `overhead_ms` is of a worker's time, from one task to its next; `overhead_cpu_ms` is of the processor's time in the
    process of command and scheduler, which other programs on the machine hardly change.
    """
    with connect(workers=WORKERS) as client:
        for _ in do_jobs(client, do_nothing, range(-WORKERS * 5, 0), name=str):
            pass  # connections are open now
        began, worked = time.perf_counter(), time.process_time()
        for _, future in do_jobs(client, do_nothing, range(tasks), name=str):
            future.result()
        wall, cpu = time.perf_counter() - began, time.process_time() - worked
    return {
        "overhead_ms": round(1e3 * WORKERS * wall / tasks, 2),
        "overhead_cpu_ms": round(1e3 * cpu / tasks, 2),
    }


def measure_import() -> float:
    """Return how long `import rotorrig` takes a new process [ms]: the least of several, what disturbs only adds."""
    words = "import time; began = time.perf_counter(); import rotorrig; print(1e3 * (time.perf_counter() - began))"
    command = [sys.executable, "-c", words]
    return min(
        float(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)
        for _ in range(IMPORTS)
    )


def do_nothing(number: int) -> dict[str, Any]:
    """Return about as much as a recording's task does."""
    return {"run_id": f"{number:016x}", "key": f"{number:016x}", "file": f"{number}.mcap", "status": "done"}


def measure_diagnoses(paths: Sequence[Path]) -> dict[str, Any]:
    """Return time and verdicts of recordings that are diagnosed too."""
    if not paths:
        return {"diagnosed": 0}
    folder = link_recordings(LABS / "diagnosed", paths)
    seconds = run_command(folder, workers=WORKERS, steps=f"{STEPS},diagnose")
    counts = query_table(folder, "select verdict, count(*) as n from runs group by verdict order by n desc").to_pylist()
    return {
        "diagnosed": len(paths),
        "seconds_diagnosed": round(seconds, 1),
        "verdicts": {row["verdict"]: row["n"] for row in counts},
    }


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recordings", type=int, default=1000, help="how many are tracked and identified (1000)")
    parser.add_argument("--diagnose", type=int, default=100, help="how many of them are diagnosed too (100)")
    parser.add_argument("--summary", action="store_true", help="print the result that is kept")
    parser.add_argument("--write", action="store_true", help="keep the result in parts/lab/results.jsonl")
    parser.add_argument("--json", action="store_true", help="print it as one JSON object on the last line")
    options = parser.parse_args()
    if options.recordings < 8:
        parser.error("--recordings: want 8 or more, for some to be done when the command is killed")
    return options


if __name__ == "__main__":
    main()
