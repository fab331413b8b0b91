"""A campaign: its pieces run in processes of their own, some at a time, and go on where an earlier run was cut."""

import json
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.fuzz.one_input import SECONDS
from tests.fuzz.piece import READY, save_input

PIECE = 2_000  # inputs of one process
COMMAND = [sys.executable, "-m", "tests.fuzz"]


def campaign(inputs: int, *, seed: int, workers: int, findings: Path) -> int:
    """Run the pieces that are not done yet, `workers` at a time; return 1 if anything was found."""
    findings.mkdir(parents=True, exist_ok=True)
    pieces = [(at, min(at + PIECE, inputs)) for at in range(0, inputs, PIECE)]
    done = _progress(findings, seed)
    begun = time.monotonic()
    with ThreadPoolExecutor(workers) as pool:
        waiting = [piece for piece in pieces if f"{piece[0]}-{piece[1]}" not in done]
        for piece, counts in zip(waiting, pool.map(lambda p: _in_a_process(p, seed, findings), waiting), strict=True):
            done[f"{piece[0]}-{piece[1]}"] = counts
            (findings / "progress.json").write_text(json.dumps({"seed": seed, "done": done}))
            print(f"{sum(sum(c.values()) for c in done.values())} of {inputs}", end="\r", flush=True)
    counts = sum((Counter(done[f"{a}-{b}"]) for a, b in pieces), Counter())
    _summarise(counts, time.monotonic() - begun, findings)
    return 1 if counts["findings"] else 0


def _progress(findings: Path, seed: int) -> dict[str, dict[str, int]]:
    path = findings / "progress.json"
    known = json.loads(path.read_text()) if path.exists() else {}
    return known["done"] if known.get("seed") == seed else {}


def _in_a_process(piece: tuple[int, int], seed: int, findings: Path) -> dict[str, int]:
    """Run a piece in a process of its own; one that dies is a finding, and the piece goes on behind that input."""
    counts: Counter[str] = Counter()
    at, end = piece
    while at < end:
        words = ["--seed", str(seed), "--findings", str(findings), "--piece", str(at), str(end)]
        process = subprocess.Popen([*COMMAND, *words], stdout=subprocess.PIPE, text=True)
        try:
            printed, _ = process.communicate(timeout=60 + (end - at) * SECONDS / 10)
        except subprocess.TimeoutExpired:
            process.kill()
            printed, _ = process.communicate()
        first, *lines = printed.splitlines() or [""]
        if first != READY:
            raise SystemExit(f"the fuzzer itself failed (exit {process.returncode}), see above")
        for line in lines:
            number, _, what = line.partition(" ")
            at = int(number) + 1
            counts[what] += 1
        if at < end:
            save_input(at, f"the process died (exit {process.returncode})", seed=seed, findings=findings)
            counts["findings"] += 1
            at += 1
    return dict(counts)


def _summarise(counts: Counter[str], seconds: float, findings: Path) -> None:
    kinds = sorted({what.partition(":")[0] for what in counts if ":" in what})
    for kind in kinds:
        print(f"{kind:14s} {counts[f'{kind}: read']:8d} read {counts[f'{kind}: refused']:8d} refused")
    total = sum(counts.values())
    print(
        f"{total} inputs in {seconds:.0f} s, {counts['findings']} findings"
        + (f" in {findings}" * bool(counts["findings"]))
    )
