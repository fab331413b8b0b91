"""A lab's numbers do not depend on whether numba had to compile its kernels on the way."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.parts.blind.run import record
from benchmarks.parts.lab.recordings import brisk_rig
from rotorrig.app.lab.catalogue import query_table
from rotorrig.processing.files.response_mcap import write_response
from rotorrig.processing.pipeline import track

ROOT = Path(__file__).parents[3]


@pytest.mark.campaign
def test_a_first_run_with_an_empty_cache_comes_to_the_bits_of_the_second(tmp_path: Path) -> None:
    """Two sweeps of the plant, as a fit of a swept response shows it: in both, one worker, and a cache of its own."""
    swept = [track(record(brisk_rig(), seed=seed)) for seed in (1, 2)]
    found = []
    for name in ("first", "second"):
        folder = tmp_path / name
        folder.mkdir()
        for i, response in enumerate(swept):
            write_response(folder / f"{i}.mcap", response)
        words = [sys.executable, "-m", "rotorrig.app.cli", "lab", "run", str(folder), "--workers", "1"]
        environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        done = subprocess.run(
            words, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=500, check=False
        )
        assert (done.returncode, done.stderr) == (0, "")
        found.append(query_table(folder, "select run_id, name, value, sigma from estimates order by all").to_pylist())
    assert len({row["run_id"] for row in found[0]}) == 2
    assert found[0] == found[1]
