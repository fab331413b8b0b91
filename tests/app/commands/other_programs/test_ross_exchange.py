"""`rotor import --ross`, `rotor export --ross`: files that other verbs and ROSS can read; mistakes in a sentence."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from rotorrig.app import cli
from rotorrig.rig.config.description import load
from rotorrig.rig.ross.reading import read_ross

ROOT = Path(__file__).parents[4]
RK4 = ROOT / "configs/rk4.toml"
STEPPED = ROOT / "tests/data/ross/stepped.toml"
Run = Callable[..., tuple[int, str, str]]  # exit code, output, errors


@pytest.fixture
def rotor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Run:
    """Run the command in an empty folder; return its exit code, output and errors."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["rotor", *map(str, words)])
        monkeypatch.setattr(cli.err, "_width", 400)
        with pytest.raises(SystemExit) as ended:
            cli.main()
        printed = capsys.readouterr()
        return int(ended.value.code or 0), printed.out, printed.err

    return run


def test_a_rotor_of_ross_becomes_a_config_that_check_accepts(rotor: Run) -> None:
    code, out, _ = rotor("import", "--ross", STEPPED, "--out", "rig.toml")
    assert code == 0
    lines = out.splitlines()
    assert "Without its axial coefficients here, as the model is of lateral motion: 'ball'." in lines
    assert (
        lines[-1] == "rig.toml: 6 shaft elements, 2 disks, 3 bearings, in 3 sections; its two probes are placeholders"
    )
    assert load(Path("rig.toml")).name == "stepped"
    code, out, _ = rotor("check", "rig.toml")
    assert code == 0
    assert "critical speeds" in out


def test_kept_nodes_survive_the_way_back(rotor: Run) -> None:
    assert rotor("import", "--ross", STEPPED, "--keep-nodes", "-o", "rig.toml")[0] == 0
    code, out, _ = rotor("export", "--ross", "rig.toml", "--max-element", "1 m", "-o", "again.toml")
    assert code == 0
    assert out.splitlines()[-1] == "again.toml: 6 shaft elements, 2 disks, 3 bearings"
    assert read_ross(Path("again.toml")).nodes == read_ross(STEPPED).nodes


def test_export_says_what_ross_has_no_place_for(rotor: Run) -> None:
    code, out, _ = rotor("export", RK4, "--ross", "-o", "rotor.toml")
    assert code == 0
    assert "[motor], [daq]" in out
    assert max(element.length for element in read_ross(Path("rotor.toml")).shaft) < 0.02 + 1e-9


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["import", "--ross", RK4, "-o", "x.toml"], "rk4.toml: has no ross_version and parameters, want a rotor"),
        (["import", "--ross", "none.toml", "-o", "x.toml"], "none.toml: cannot be read"),
        (["import", STEPPED, "-o", "x.toml"], "--config: missing, want the rig's TOML file"),
        (["import", "--ross", STEPPED, "--config", RK4, "-o", "x.toml"], "want neither --config nor --mapping"),
        (["import", "--ross", STEPPED, "-o", "no/x.toml"], "no/x.toml: cannot be written (No such file or directory)"),
        (["import", "--ross", STEPPED, "-o", STEPPED], "stepped.toml: is the input file"),
        (["export", "--ross", STEPPED, "-o", "x.toml"], "stepped.toml: "),
        (["export", "--ross", RK4, "--max-element", "20", "-o", "x.toml"], "--max-element: got '20'"),
        (["export", "--ross", RK4, "--max-element", "0 mm", "-o", "x.toml"], "--max-element: got 0 mm"),
    ],
    ids=lambda v: " ".join(Path(w).name for w in v)[:50] if isinstance(v, list) else "",
)
def test_a_mistake_is_one_sentence(words: list[str], said: str, rotor: Run, tmp_path: Path) -> None:
    before = STEPPED.read_bytes()
    code, _, err = rotor(*words)
    assert code == 1
    assert said in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
    assert STEPPED.read_bytes() == before
