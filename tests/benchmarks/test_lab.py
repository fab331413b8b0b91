"""The lab's benchmark: what it counts as a difference, and what it says of what is kept."""

import json
import subprocess
import sys
from pathlib import Path

from benchmarks.lab import KEPT, measure_import
from benchmarks.parts.lab.compare import count_differences
from benchmarks.parts.lab.runs import Memory
from rotorrig.app.lab import LabSettings, find_jobs
from rotorrig.app.lab.steps import Outcome
from rotorrig.app.lab.task import write_outcome

ROOT = Path(__file__).parents[2]


def make_lab(folder: Path, *, sentence: str, stiffness: float, wall_s: float) -> Path:
    """Make a lab with one recording that failed, and a fit beside it."""
    folder.mkdir()
    (folder / "run.mcap").write_bytes(b"no recording")
    (job,) = find_jobs(folder, LabSettings())
    write_outcome(job, Outcome(sentence=sentence))
    fit = job.lab.results(job.recording.run_id, job.key) / "fit.json"
    fit.parent.mkdir(parents=True)
    fit.write_text(json.dumps({"kxx": stiffness, "wall_s": wall_s}))
    return folder


def test_labs_that_differ_in_times_alone_have_no_difference(tmp_path: Path) -> None:
    one = make_lab(tmp_path / "one", sentence="is damaged", stiffness=33.9e3, wall_s=1.0)
    other = make_lab(tmp_path / "other", sentence="is damaged", stiffness=33.9e3, wall_s=2.0)
    assert count_differences(one, other) == 0


def test_a_bit_in_a_file_a_word_in_a_row_and_a_missing_file_are_differences(tmp_path: Path) -> None:
    one = make_lab(tmp_path / "one", sentence="is damaged", stiffness=33.9e3, wall_s=1.0)
    other = make_lab(tmp_path / "other", sentence="is cut", stiffness=33.9e3 * (1 + 2**-52), wall_s=1.0)
    assert count_differences(one, other) == 2
    next(other.glob("lab/results/*/*/fit.json")).unlink()
    assert count_differences(one, other) == 2
    assert count_differences(other, other) == 0


def test_the_memory_after_a_share_is_the_largest_of_the_next_tenth() -> None:
    memory = Memory(seen=[(0, 500.0), (10, 300.0), (15, 310.0), (50, 400.0), (95, 320.0)])
    assert (memory.after(0.1, of=100), memory.after(0.9, of=100)) == (310.0, 320.0)


def test_an_import_is_measured_in_a_process_of_its_own() -> None:
    loaded = "rotorrig" in sys.modules
    assert measure_import() > 0.1  # ms: less would be of a package that had been imported already
    assert ("rotorrig" in sys.modules) is loaded


def test_the_summary_is_of_what_is_kept() -> None:
    command = [sys.executable, "benchmarks/lab.py", "--summary", "--json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=True)
    result = json.loads(done.stdout.splitlines()[-1])
    assert result == json.loads(KEPT.read_text(encoding="utf-8").splitlines()[-1])
    assert {"efficiency", "overhead_ms", "resumed_twice", "differences", "recordings", "orphans"} <= set(result)
