"""What a wheel installs, used from a folder that is no checkout."""

import os
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
INFO = f"rotorrig-{VERSION}.dist-info"
ROTOR = "import sys; from rotorrig.app.cli import main; sys.argv[0] = 'rotor'; main()"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True, timeout=120)
    (path,) = folder.glob("*.whl")
    return zipfile.ZipFile(path)


@pytest.fixture(scope="module")
def installed(wheel: zipfile.ZipFile, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel's files, as pip lays them out; what it depends on is there already."""
    folder = tmp_path_factory.mktemp("site-packages")
    wheel.extractall(folder)
    return folder


def rotor(installed: Path, folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-P", "-c", ROTOR, *words],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(installed)}, capture_output=True, text=True, timeout=1200,
    )  # fmt: skip


def test_it_holds_the_program_its_configs_and_its_licence_and_nothing_else(wheel: zipfile.ZipFile) -> None:
    names = wheel.namelist()
    shared = {path.name: path for path in (ROOT / "configs").iterdir()}
    assert {n for n in names if n.startswith("rotorrig/configs/")} == {f"rotorrig/configs/{name}" for name in shared}
    assert {name.split("/")[0] for name in names} == {"rotorrig", INFO}
    assert wheel.read(f"{INFO}/licenses/LICENSE") == (ROOT / "LICENSE").read_bytes()
    assert b"rotor = rotorrig.app.cli:main" in wheel.read(f"{INFO}/entry_points.txt")
    assert {f"rotorrig/app/assets/report.{kind}" for kind in ("css", "html", "js")} <= set(names)


def test_a_bundled_config_is_written_once_and_found_by_its_name(installed: Path, tmp_path: Path) -> None:
    assert rotor(installed, tmp_path, "--version").stdout == f"rotorrig {VERSION}\n"
    assert "rk4 " in rotor(installed, tmp_path, "init").stdout
    checked = rotor(installed, tmp_path, "check", "rk4")
    assert "2226, 2237" in checked.stdout, checked.stderr
    assert rotor(installed, tmp_path, "init", "rk4").returncode == 0
    assert (tmp_path / "rk4.toml").read_bytes() == (ROOT / "configs/rk4.toml").read_bytes()
    again = rotor(installed, tmp_path, "init", "rk4")
    refusal = "error: rk4.toml: is there already, want another name, or --force to replace it\n"
    assert (again.returncode, again.stderr) == (1, refusal)


@pytest.mark.campaign
def test_the_demo_runs_from_it(installed: Path, tmp_path: Path) -> None:
    done = rotor(installed, tmp_path, "demo")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "demo/report.html").stat().st_size > 1_000_000
    assert (tmp_path / "demo/bowed/report.html").exists()
