"""The process of a piece: its limits of memory, its place to write, and the inputs one after the other."""

import resource
import sys
import tempfile
import warnings
from pathlib import Path

from tests.fuzz.corpus import build
from tests.fuzz.one_input import Sandbox, input_number, outcome

READY = "ready"  # first line of a piece
ROOM = 1024 * 2**20  # bytes of memory a process may take beyond what it has when it begins


def run_piece(begin: int, end: int, *, seed: int, findings: Path) -> int:
    """Run inputs `begin` to `end`, a line each on stdout; save those that show something."""
    sys.dont_write_bytecode = True
    with tempfile.TemporaryDirectory(prefix="rotor-fuzz-", dir=_memory_disk()) as name:
        corpus = build(Path(name))
        _warm_up(corpus, Path(name) / "warm")
        resource.setrlimit(resource.RLIMIT_AS, (_address_space() + ROOM,) * 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        warnings.simplefilter("error")  # a warning on a user's terminal is no sentence
        sandbox = Sandbox(Path(name) / "box")
        print(READY, flush=True)
        for number in range(begin, end):
            kind, data = input_number(number, seed=seed, corpus=corpus)
            found = outcome(kind, data, sandbox)
            if found.is_finding:
                _save(findings, number, kind, data, found.said)
            print(number, "findings" if found.is_finding else f"{kind}: {found.said}", flush=True)
    return 0


def _warm_up(corpus: dict[str, list[bytes]], folder: Path) -> None:
    """Read every seed, so that what is imported, cached or asked of git is no doing of an input. Each must be good."""
    sandbox = Sandbox(folder)
    for again in (False, True):
        for kind, seeds in corpus.items():
            for number, data in enumerate(seeds):
                if (found := outcome(kind, data, sandbox)).said != "read" and again:
                    raise AssertionError(f"{kind}, seed {number}: {found.said}")


def _memory_disk() -> str | None:
    return "/dev/shm" if Path("/dev/shm").is_dir() else None  # a recording is synced to the medium when it is closed


def _address_space() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


def save_input(number: int, said: str, *, seed: int, findings: Path) -> None:
    """Save an input by its number: that of a process which could not do so itself."""
    with tempfile.TemporaryDirectory(prefix="rotor-fuzz-") as name:
        kind, data = input_number(number, seed=seed, corpus=build(Path(name)))
    _save(findings, number, kind, data, said)


def _save(findings: Path, number: int, kind: str, data: bytes, said: str) -> None:
    stem = f"{number:08d}-{kind.replace(' ', '-')}"
    (findings / f"{stem}.bin").write_bytes(data)
    (findings / f"{stem}.txt").write_text(said)
    print(f"\ninput {number} ({kind}): {said.strip().splitlines()[-1][:200]}", file=sys.stderr)
