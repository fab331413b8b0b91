"""`make fuzz`: many damaged inputs through every reader, on several cores, with limits; findings are kept.

An input is a function of seed and number, so a run can be cut and taken up again: `progress.json` in the folder of
findings says how far it came. Exits 1 if there was a finding.
"""

import argparse
import sys
from pathlib import Path

from tests.fuzz.campaign import campaign
from tests.fuzz.piece import run_piece


def main() -> int:
    """Parse, run, print a summary."""
    asked = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    asked.add_argument("--inputs", type=int, default=100_000)
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--workers", type=int, default=2)
    asked.add_argument("--findings", type=Path, default=Path("fuzz-findings"), help="folder for findings and progress")
    asked.add_argument("--piece", type=int, nargs=2, metavar=("FROM", "TO"), help=argparse.SUPPRESS)
    told = asked.parse_args()
    if told.piece:
        return run_piece(*told.piece, seed=told.seed, findings=told.findings)
    return campaign(told.inputs, seed=told.seed, workers=told.workers, findings=told.findings)


if __name__ == "__main__":
    sys.exit(main())
