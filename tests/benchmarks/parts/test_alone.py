"""A job has a process of its own: one that hangs, crashes or dies costs its own result and no other."""

import os
import signal
import time
from collections.abc import Iterator
from typing import Any

from benchmarks.parts.jobs import run_limited


def job(kind: str) -> Iterator[dict[str, Any]]:
    """Yield the kind, and then do what it says."""
    yield {"kind": kind, "pid": os.getpid()}
    if kind == "hangs":
        time.sleep(600)
    if kind == "crashes":
        raise RuntimeError("on purpose")
    if kind == "is killed":
        os.kill(os.getpid(), signal.SIGKILL)
    yield {"whole": True}


def test_what_a_job_had_said_is_kept_however_it_ends() -> None:
    seen: dict[str, tuple[Any, str]] = {}
    began = time.monotonic()
    run_limited(
        job,
        ["hangs", "crashes", "is killed", "ends"],
        workers=2,
        limit=8.0,
        done=lambda kind, parts, ending: seen.update({kind: (parts, ending)}),
    )
    assert {kind: ending for kind, (_, ending) in seen.items()} == {
        "hangs": "killed",
        "crashes": "died",
        "is killed": "died",
        "ends": "ended",
    }
    assert all(parts["kind"] == kind for kind, (parts, _) in seen.items())
    assert [kind for kind, (parts, _) in seen.items() if "whole" in parts] == ["ends"]
    assert len({parts["pid"] for parts, _ in seen.values()}) == 4, "a process each"
    assert 8.0 <= time.monotonic() - began < 60.0
