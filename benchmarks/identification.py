"""The chapter's identifications, Tables 7, 8 and 10, again: calls, errors, and what the data can tell at all.

    python benchmarks/identification.py --seeds 20
    python benchmarks/identification.py --seeds 100 --json                 (one JSON object on the last line)
    python benchmarks/identification.py --json --quick                     (likewise, a few runs of each: minutes)
    python benchmarks/identification.py --seeds 100 --draws 30 --rigs 20 --write        (docs/identification.md)

One file per table, each with `measure`, `summarise` and `text`. Every call of the model counts, with its derivatives
as one; finite differences count as the calls they are. The last of these takes some 20 minutes of one core.
"""

import argparse
import json
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from threadpoolctl import threadpool_limits

from benchmarks import identification_coverage as coverage
from benchmarks.parts.identification import seed_table7, table7, table8, table10, timing
from benchmarks.parts.identification.coverage_groups import GROUPS
from benchmarks.parts.identification.page import page

ROOT = Path(__file__).parents[1]
#: Enough to see that everything runs, and the JSON's keys; the rates are rough.
QUICK = {
    "seeds": 4,
    "truths": 40,
    "draws": 3,
    "black_boxes": 2,
    "starts": 20,
    "rigs": 3,
    "cases": 6,
    "chapter_truths": 4,
    "chapter_staged": 1,
}
ORDINARY = next(iter(GROUPS))  # coverage95 is of it; the others, bootstraps among them, are identification_coverage's


def main() -> None:
    """Measure, print, and write the page if asked."""
    options = arguments()
    began = time.perf_counter()
    timed = timing.measure()  # before the processes that would share the machine with it
    with ProcessPoolExecutor(options.workers, initializer=threadpool_limits, initargs=(1,)) as pool:
        seventh = table7.measure(pool, seeds=options.seeds, truths=options.truths)
        _tell("Table 7", began)
        chapters = seed_table7.measure(
            pool, seeds=options.seeds, truths=options.chapter_truths, staged=options.chapter_staged
        )
        _tell("Table 7 by the chapter's algorithm", began)
        eighth = table8.measure(
            pool, draws=options.draws, starts=options.starts, black_boxes=min(options.black_boxes, options.draws)
        )
        _tell("Table 8", began)
        tenth = table10.measure(pool, rigs=options.rigs)
        _tell("Table 10", began)
        covered = coverage.measure(pool, cases=options.cases, groups=[ORDINARY])
    texts = [table7.text(seventh), table8.text(eighth), table10.text(tenth)]
    print("\n\n".join([*texts, seed_table7.text(chapters), timing.text(timed), coverage.text(covered)]))
    if options.write:  # what chea_table7.py and identification_coverage.py measure has pages of its own
        written = page(*texts, more=[timing.text(timed)], seeds=options.seeds, starts=options.starts)
        (ROOT / "docs/identification.md").write_text(written, encoding="utf-8")
    if options.json:
        found = {
            "table7": table7.summarise(seventh),
            "seed": {"table7": seed_table7.summarise(chapters)},
            "table8": table8.summarise(eighth),
            "table10": table10.summarise(tenth),
            **coverage.summarise(covered),
            **timed,
        }
        print(json.dumps(found))


def _tell(part: str, began: float) -> None:
    print(f"{part} done after {(time.perf_counter() - began) / 60:.1f} min", file=sys.stderr)


def arguments(argv: list[str] | None = None) -> argparse.Namespace:
    """Return the checked command line, that of the process by default."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20, help="runs per search of Table 7 (default 20)")
    parser.add_argument("--truths", type=int, default=300, help="random truths of Table 7 (default 300)")
    parser.add_argument("--draws", type=int, default=30, help="draws of the noise of Table 8 (default 30)")
    parser.add_argument("--black-boxes", type=int, default=20, help="of these draws, as a black box too (default 20)")
    parser.add_argument("--starts", type=int, default=200, help="of the brute force of Table 8 (default 200)")
    parser.add_argument("--rigs", type=int, default=20, help="simulated rigs of Table 10 (default 20)")
    parser.add_argument("--cases", type=int, default=100, help="of the coverage of intervals (default 100)")
    parser.add_argument(
        "--chapter-truths", type=int, default=20, help="random truths of the chapter's algorithm (default 20)"
    )
    parser.add_argument("--chapter-staged", type=int, default=10, help="of its runs, looked at closely (default 10)")
    parser.add_argument("--quick", action="store_true", help="a few runs of each, unless other options say more")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="processes (default: one per core)")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    parser.add_argument("--write", action="store_true", help="write docs/identification.md")
    if parser.parse_args(argv).quick:
        parser.set_defaults(**QUICK)
    options = parser.parse_args(argv)
    for name in (*QUICK, "workers"):
        if getattr(options, name) < 1:
            parser.error(f"--{name.replace('_', '-')} is {getattr(options, name)}, want at least 1")
    return options


if __name__ == "__main__":
    main()
