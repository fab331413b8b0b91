"""One input through its reader, within limits of time, memory and places to write: what came of it."""

import os
import shutil
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rotorrig.rig.errors import RigError
from tests.fuzz.generated import generated
from tests.fuzz.mutations import mutated
from tests.fuzz.targets import TARGETS, WEIGHTS

SECONDS = 10  # for one input; the slowest good ones take a tenth of a second
GENERATED = 0.2  # of the inputs are made up, the others mutated
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC
#: what a reader of files has no business with
_FORBIDDEN = {
    "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "socket.connect", "socket.bind",
    "pickle.find_class",
}  # fmt: skip
_CHANGES = {"os.remove", "os.rename", "os.mkdir", "os.rmdir", "os.link", "os.symlink", "os.chmod", "os.truncate"}


class OutOfTime(BaseException):
    """No `Exception`, so that nothing the reader catches hides it."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a reader made of an input."""

    kind: str  # of the input
    said: str  # "read", "refused", or the finding
    is_finding: bool = False


class Sandbox:
    """Watches, from when it is made, what this process opens for writing; `folder` is where it may.

    An audit hook cannot be taken away again, so there is one for a process.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.trespasses: list[str] = []
        self._watching = False
        sys.addaudithook(self._hook)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Watch for the length of the block, which begins with an empty folder."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.trespasses.clear()
        self._watching = True
        try:
            yield
        finally:
            self._watching = False

    def _hook(self, event: str, args: tuple[object, ...]) -> None:
        if not self._watching:
            return
        if event in _FORBIDDEN:
            self.trespasses.append(f"{event} {args!r:.200}")
        elif event == "open":
            path, mode, flags = args
            wants = (isinstance(mode, str) and set(mode) & set("wxa+")) or (isinstance(flags, int) and flags & _WRITES)
            if wants and not self._inside(path):
                self.trespasses.append(f"opens {path!r} for writing")
        elif event in _CHANGES and not self._inside(args[0]):
            self.trespasses.append(f"{event} {args!r:.200}")

    def _inside(self, path: object) -> bool:
        if isinstance(path, int) or path == os.devnull:
            return True
        text = os.fsdecode(path) if isinstance(path, str | bytes | os.PathLike) else ""
        return Path(text).resolve().is_relative_to(self.folder)


def input_number(number: int, *, seed: int, corpus: dict[str, list[bytes]]) -> tuple[str, bytes]:
    """Return kind and bytes of an input; the same for the same `seed` and `number`, whatever ran before."""
    rng = np.random.default_rng([seed, number])
    weights = np.array([WEIGHTS[name] for name in TARGETS], dtype=float)
    kind = list(TARGETS)[rng.choice(len(weights), p=weights / weights.sum())]
    made_up = generated(kind, rng) if rng.random() < GENERATED else None
    return kind, mutated(corpus[kind], rng) if made_up is None else made_up


def outcome(kind: str, data: bytes, sandbox: Sandbox) -> Outcome:
    """Give `data` to the reader of its kind and return what came of it."""
    with sandbox.watching():
        said, is_finding = _said(kind, data, sandbox.folder)
    if sandbox.trespasses and not is_finding:
        said, is_finding = "; ".join(sandbox.trespasses), True
    return Outcome(kind, said, is_finding)


def _said(kind: str, data: bytes, folder: Path) -> tuple[str, bool]:
    try:
        with _within(SECONDS):
            TARGETS[kind](data, folder)
    except RigError as error:
        words = str(error)
        faulty = not words or "\n" in words or len(words) > 2000
        return (f"no sentence: {words[:300]!r}", True) if faulty else ("refused", False)
    except OutOfTime:
        return f"takes more than {SECONDS} s\n{traceback.format_exc(limit=-8)}", True
    except BaseException:  # also SystemExit and KeyboardInterrupt: a reader must not end the program
        return traceback.format_exc(limit=-8), True
    return "read", False


@contextmanager
def _within(seconds: float) -> Iterator[None]:
    """Raise OutOfTime in the block when it takes longer."""

    def ring(signum: int, frame: object) -> None:
        raise OutOfTime

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
