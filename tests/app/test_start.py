"""What a verb loads as it starts: a sweep may be the first thing after power-up, and whoever stops a rotor waits."""

import re
import subprocess
import sys

from tests.conftest import CONFIGS

LOADED = re.compile(r"\| +rotorrig\.(\w+)")


def test_a_sweep_loads_neither_identification_nor_processing() -> None:
    words = ["-X", "importtime", "-m", "rotorrig.app.cli", "sweep", str(CONFIGS / "rk4.toml"), "--dry-run"]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=120, check=True)
    loaded = set(LOADED.findall(done.stderr))
    assert {"acquisition", "app", "rig"} <= loaded
    assert not loaded & {"identify", "processing"}
