"""The command line of a benchmark whose cases are kept as lines: what to run, or to sum up what is kept."""

import argparse

DEVELOPMENT = 100  # seeds that may be looked at: 0 to 99


def case_parser(document: str, *, seeds: int, of: str) -> argparse.ArgumentParser:
    """Return a parser of what all of them ask; `document` is the benchmark's own, `of` says what seeds are."""
    parser = argparse.ArgumentParser(description=document.splitlines()[0])
    parser.add_argument("--development", action="store_true", help="seeds 0 on, kept in .cache")
    parser.add_argument("--seeds", type=int, default=seeds, help=of)
    parser.add_argument("--summary", action="store_true", help="of the cases that are kept; run none")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    add_workers(parser)
    return parser


def add_workers(parser: argparse.ArgumentParser, *, default: int = 2, of: str = "processes") -> None:
    """Add where the cases are run: in so many processes here, or in those of a Dask scheduler."""
    parser.add_argument("--workers", type=int, default=default, help=f"{of} here (default {default})")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="tcp:// or tls:// of a Dask scheduler, instead of those")


def parse_cases(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Return the checked command line."""
    options = parser.parse_args()
    if not 1 <= options.seeds <= DEVELOPMENT:
        parser.error(f"--seeds is {options.seeds}, want 1 to {DEVELOPMENT}")
    return options
