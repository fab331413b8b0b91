"""All global minima: how many of them CHEA lists when it is asked for all, beside a published niching method.

    python benchmarks/chea_niching.py --seeds 2 --functions Himmelblau
    python benchmarks/chea_niching.py --seeds 20 --write               (resumable, hours; then docs/chea-niching.md)
    python benchmarks/chea_niching.py --summary --json                 (of the runs that are kept)

A minimum counts as listed by a point within 1e-3 of the half width of the box in every parameter. Every call counts.
CHEA may end before its budget; NEA2 never does. Own time is that of the method alone, without the function.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.parts.blind.records import append_record, open_records, read_records
from benchmarks.parts.case_arguments import add_workers
from benchmarks.parts.chea.niching_runs import (
    CASES,
    KEPT,
    METHODS,
    Job,
    Record,
    read_runs,
    run_job,
    source_version,
    summarise,
    table,
)
from benchmarks.parts.jobs import in_parallel

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/chea-niching.md"


def main() -> None:
    """Run what is not kept yet, print, and write the page if asked."""
    options = arguments()
    version = source_version()
    names = [name for name in CASES if not options.functions or any(part in name for part in options.functions)]
    wanted = [(m, name, seed, version) for seed in range(options.seeds) for name in names for m in options.methods]
    if not options.summary:
        run(wanted, version, options)
    kept = read_runs(version, any_version=options.summary)
    found = summarise([r for r in kept if r["function"] in names])
    print(table(found))
    if options.write:
        PAGE.write_text(page(found, kept), encoding="utf-8")
    if options.json:
        print(json.dumps({"niching": found}))


def run(wanted: Sequence[Job], version: str, options: argparse.Namespace) -> None:
    """Run the jobs of which there is no line of this version."""
    with open_records(KEPT) as file:
        kept = read_records(KEPT, version=version)
        jobs = [job for job in wanted if f"{job[0]} {job[1]} {job[2]}" not in kept]

        def keep(record: Record) -> None:
            append_record(file, record)
            print(f"{record['design']} {record['name']}: {record['listed']} of {record['count']}", flush=True)

        in_parallel(run_job, jobs, workers=options.workers, scheduler=options.scheduler, done=keep)


def page(found: dict[str, dict[str, Any]], kept: Sequence[Record]) -> str:
    """Return docs/chea-niching.md."""
    version = kept[-1]["version"] if kept else "none"
    return f"""# Every global minimum

Written by `benchmarks/chea_niching.py --write` from the runs kept in `benchmarks/parts/chea/niching.jsonl`, of version
{version} (a digest of CHEA's sources, the functions and the other method); do not edit.

`chea(fun, bounds, stop="all")` goes on beyond its natural end until it expects no further minimum as low as the best,
or to its budget: 50,000 calls for the six-hump camel and Himmelblau's function, 200,000 for the others in two
dimensions, 400,000 beyond. NEA2 (Preuss 2012) is nearest-better clustering of a Latin hypercube with a CMA-ES for every
cluster, begun anew until the same budget is used up. A minimum is listed by a point within 1e-3 of the half width of
the box in every parameter; listed is the mean share of the minima, calls and own time (without the function's) are
medians. The compositions, "smooth" and "rugged", are `benchmarks/parts/chea/niching.py`'s.

{table(found)}
"""


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=2, help="runs of a method on a function (default 2)")
    parser.add_argument("--functions", nargs="+", default=[], metavar="NAME", help="those whose name has one of these")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS), help="these alone")
    parser.add_argument("--summary", action="store_true", help="of the runs that are kept; run none")
    parser.add_argument("--write", action="store_true", help=f"write {PAGE.relative_to(ROOT)}")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    add_workers(parser)
    options = parser.parse_args()
    if options.seeds < 1:
        parser.error(f"--seeds is {options.seeds}, want at least 1")
    return options


if __name__ == "__main__":
    main()
