"""Units are read whatever has become of the cache of their definitions."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ASK = "from rotorrig.rig.config.units import to_si; print(to_si('2 mil', 'length'))"


def started(home: Path) -> subprocess.Popen[str]:
    """Start a program of its own that reads two mils: a length of 50.8 um, not pint's angle."""
    env = {**os.environ, "HOME": str(home), "XDG_CACHE_HOME": ""}
    return subprocess.Popen(
        [sys.executable, "-c", ASK], env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def answers(*programs: subprocess.Popen[str]) -> list[str]:
    return [program.communicate(timeout=60)[0].strip() for program in programs]


def caches(home: Path) -> list[Path]:
    return list((home / ".cache" / "rotorrig").iterdir())


@pytest.mark.campaign
def test_programs_that_start_at_once_on_a_fresh_account_all_read_units(tmp_path: Path) -> None:
    assert answers(*[started(tmp_path) for _ in range(12)]) == ["5.08e-05"] * 12
    assert len(caches(tmp_path)) == 1, "what the slower ones wrote was left behind"


def test_a_second_program_reads_what_the_first_one_kept(tmp_path: Path) -> None:
    assert answers(started(tmp_path)) == ["5.08e-05"]
    (kept,) = caches(tmp_path)
    before = {path.name: path.stat().st_mtime_ns for path in kept.iterdir()}
    assert before
    assert answers(started(tmp_path)) == ["5.08e-05"]
    assert {path.name: path.stat().st_mtime_ns for path in kept.iterdir()} == before


def test_a_cache_cut_short_is_done_without(tmp_path: Path) -> None:
    answers(started(tmp_path))
    for path in caches(tmp_path)[0].glob("*.pickle"):
        path.write_bytes(path.read_bytes()[:1000])
    assert answers(started(tmp_path)) == ["5.08e-05"]


def test_an_account_that_cannot_be_written_to_does_without(tmp_path: Path) -> None:
    (tmp_path / ".cache").write_text("a file where the folder of caches would be")
    assert answers(started(tmp_path)) == ["5.08e-05"]
