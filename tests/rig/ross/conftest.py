"""Rotors that ROSS has saved, what it says of them, and ROSS itself where it is installed."""

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[3]
STORED = ROOT / "tests/data/ross"


@pytest.fixture(scope="session")
def stored() -> Callable[[str], Path]:
    return lambda name: STORED / f"{name}.toml"


@pytest.fixture(scope="session")
def said() -> dict[str, Any]:
    """What ROSS 2.3.0 said of the stored rotors."""
    return json.loads((STORED / "said.json").read_text())


@pytest.fixture(scope="session")
def ask_ross() -> Callable[..., dict[str, Any]]:
    """Have ROSS load rotors, save them again in a folder and say what it thinks of them."""
    python = Path(os.environ.get("ROSS_PYTHON", ROOT / ".venv-ross/bin/python"))
    if not python.exists():
        pytest.skip(f"ROSS is not installed: no {python}; ROSS_PYTHON may name the Python of its environment")

    def ask(folder: Path, *files: Path) -> dict[str, Any]:
        command = [python, STORED / "make.py", folder, *files]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads((folder / "said.json").read_text())

    return ask
