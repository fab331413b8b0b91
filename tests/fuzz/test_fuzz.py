"""A short run of `make fuzz`, and that the fuzzer finds what it is there to find."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rotorrig.rig.errors import DataError
from tests.fuzz import campaign, one_input, targets
from tests.fuzz.corpus import build
from tests.fuzz.generated import STRATEGIES, generated
from tests.fuzz.one_input import Sandbox, input_number, outcome
from tests.fuzz.targets import TARGETS
from tests.parameters import defer_rest

ROOT = Path(__file__).parents[2]


def fuzz(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "tests.fuzz", "--findings", str(folder), *words]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("inputs", defer_rest([25, 500]))
def test_damaged_and_made_up_inputs_are_read_or_refused(inputs: int, tmp_path: Path) -> None:
    done = fuzz(tmp_path, "--inputs", str(inputs), "--workers", "1", "--seed", "20261121")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{inputs} inputs in" in done.stdout and ", 0 findings" in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["progress.json"]
    again = fuzz(tmp_path, "--inputs", str(inputs), "--workers", "1", "--seed", "20261121")
    assert f"{inputs} inputs in 0 s, 0 findings" in again.stdout


@pytest.fixture(scope="module")
def corpus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[bytes]]:
    return build(tmp_path_factory.mktemp("corpus"))


def test_the_corpus_is_small_and_of_every_kind(corpus: dict[str, list[bytes]]) -> None:
    assert set(corpus) == set(TARGETS) == set(STRATEGIES)
    assert all(0 < len(data) < 40_000 for seeds in corpus.values() for data in seeds)


def test_an_input_is_a_function_of_seed_and_number(corpus: dict[str, list[bytes]]) -> None:
    made = [input_number(number, seed=3, corpus=corpus) for number in range(200)]
    assert made == [input_number(number, seed=3, corpus=corpus) for number in range(200)]
    assert made != [input_number(number, seed=4, corpus=corpus) for number in range(200)]
    assert {kind for kind, _ in made} == set(TARGETS)
    assert len(set(made)) > 180


@pytest.mark.campaign
@pytest.mark.parametrize("kind", STRATEGIES)
def test_hypothesis_makes_inputs_of_every_kind(kind: str) -> None:
    made = {generated(kind, np.random.default_rng(seed)) for seed in range(20)} - {None}
    assert len(made) > 5


@pytest.fixture(scope="module")
def box(tmp_path_factory: pytest.TempPathFactory) -> Sandbox:
    return Sandbox(tmp_path_factory.mktemp("sandbox") / "box")


@pytest.fixture
def reader(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, targets.Read]]:
    """Give a table in which a test puts its own reader under "csv"."""
    readers = dict(TARGETS)
    monkeypatch.setattr(one_input, "TARGETS", readers)
    monkeypatch.setattr(one_input, "SECONDS", 0.2)
    yield readers


def _refuses(data: bytes, folder: Path) -> None:
    raise DataError("in.csv: is no CSV")


def _crashes(data: bytes, folder: Path) -> None:
    raise KeyError("x")


def _hangs(data: bytes, folder: Path) -> None:
    while True:
        try:
            pass
        except Exception:
            continue


def _exits(data: bytes, folder: Path) -> None:
    sys.exit(0)


def _writes_elsewhere(data: bytes, folder: Path) -> None:
    (folder.parent / "escaped").write_bytes(data)


def _removes(data: bytes, folder: Path) -> None:
    (folder / ".." / "escaped").unlink()


def _starts_a_program(data: bytes, folder: Path) -> None:
    subprocess.run(["true"], check=True)


def _writes_where_it_may(data: bytes, folder: Path) -> None:
    (folder / "out.mcap").write_bytes(data)
    (folder / "out.mcap").unlink()


@pytest.mark.parametrize(
    ("read", "said", "is_finding"),
    [
        (_refuses, "refused", False),
        (_writes_where_it_may, "read", False),
        (_crashes, "KeyError: 'x'", True),
        (_hangs, "takes more than", True),
        (_exits, "SystemExit", True),
        (_writes_elsewhere, "escaped' for writing", True),
        (_removes, "os.remove", True),
        (_starts_a_program, "subprocess.Popen", True),
    ],
)
def test_what_a_reader_must_not_do_is_a_finding(
    read: targets.Read, said: str, is_finding: bool, reader: dict[str, targets.Read], box: Sandbox
) -> None:
    reader["csv"] = read
    found = outcome("csv", b"x", box)
    assert found.is_finding is is_finding
    assert said in found.said


DEADLY = """
import os, sys
from tests.fuzz import __main__ as fuzz, one_input, piece
one_input.TARGETS["line"] = lambda data, folder: os._exit(9) if len(data) % 2 else bytearray(3 << 30)
piece._warm_up = lambda corpus, folder: None
sys.exit(fuzz.main())
"""


@pytest.mark.campaign
def test_a_process_that_dies_or_wants_too_much_memory_is_a_finding_and_the_run_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "deadly.py"
    program.write_text(DEADLY)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setattr(campaign, "COMMAND", [sys.executable, str(program)])
    assert campaign.campaign(60, seed=1, workers=1, findings=tmp_path / "found") == 1
    printed = capsys.readouterr().out
    assert re.search(r"^60 inputs in \d+ s, [1-9]\d* findings in ", printed, re.MULTILINE)
    said = {path: path.read_text() for path in (tmp_path / "found").glob("*-line.txt")}
    assert all(path.with_suffix(".bin").is_file() for path in said)
    assert "the process died (exit 9)" in said.values()
    assert any("MemoryError" in words for words in said.values())


def test_a_fuzzer_that_cannot_begin_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign, "COMMAND", [sys.executable, "-c", "raise SystemExit(3)"])
    with pytest.raises(SystemExit, match=r"the fuzzer itself failed \(exit 3\)"):
        campaign.campaign(60, seed=1, workers=1, findings=tmp_path)
