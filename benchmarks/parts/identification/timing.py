"""How long an identification takes: its search alone, and the whole command from start-up to fit.json.

On a healthy simulated RK4, swept as configs/rk4.toml says. On a busy machine the CPU time, which stands beside, says
more than the wall time.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.parts.blind.run import record
from rotorrig.identify.base_model import Space, search
from rotorrig.identify.measurement import measure as measured_rows
from rotorrig.processing import OrderTrackedResponse, track
from rotorrig.processing.files import write_response
from rotorrig.rig.config import load

ROOT = Path(__file__).parents[3]
SEED = 7  # of the plant
SEARCHES = 9
COMMANDS = 3


def measure() -> dict[str, Any]:
    """Return search_ms and wall_s of the JSON object, medians, and the CPU times beside them."""
    response = track(record(load(ROOT / "configs/rk4.toml"), seed=SEED))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "response.mcap"
        write_response(path, response)
        identify(path)  # fills numba's cache
        commands = np.median([identify(path) for _ in range(COMMANDS)], axis=0)
    timed_search(response)
    searches = np.median([timed_search(response) for _ in range(SEARCHES)], axis=0)
    return {
        "search_ms": 1000 * float(searches[0]),
        "search_cpu_ms": 1000 * float(searches[1]),
        "wall_s": float(commands[0]),
        "cpu_s": float(commands[1]),
    }


def timed_search(response: OrderTrackedResponse) -> tuple[float, float]:
    """Return wall and CPU time [s] of the search over the whole sweep, the condensing of the rotor included."""
    rows, space = measured_rows(response), Space.of(response.rig)
    began, cpu = time.perf_counter(), time.process_time()
    search(response, rows, space)
    return time.perf_counter() - began, time.process_time() - cpu


def identify(response: Path) -> tuple[float, float]:
    """Return wall and CPU time [s] of `rotor identify`. Raises CalledProcessError if it fails."""
    rotor, fit = Path(sys.executable).with_name("rotor"), response.with_name("fit.json")
    began, before = time.perf_counter(), os.times()
    words = [str(rotor), "identify", str(response), "--out", str(fit), "--force"]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return time.perf_counter() - began, cpu


def text(measured: dict[str, Any]) -> str:
    """Return the figures in Markdown."""
    return (
        "### Time\n\n"
        f"On a simulated RK4 (configs/rk4.toml): the search, including model reduction, takes "
        f"{measured['search_ms']:.0f} ms ({measured['search_cpu_ms']:.0f} ms of CPU), `rotor identify` from start-up "
        f"to fit.json, two bands, {measured['wall_s']:.1f} s ({measured['cpu_s']:.1f} s of CPU). Medians of {SEARCHES} "
        f"and {COMMANDS}."
    )
