"""What the response to a moving speed costs, its derivatives against differences of it, other orders and force laws.

    python benchmarks/swept.py
    python benchmarks/swept.py --json           (one JSON object on the last line)

configs/rk4.toml as a fit asks for it: 22 coordinates, each probe also at right angles to its axis, the default plan's
run-up and a coast-down, a row every eight turns, ten structural parameters. One thread; medians of CPU time, all parts
taken in turns within one run. The error is that of the derivatives against central differences.
"""

import argparse
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks.parts.tables import markdown
from rotorrig.rig.config import RPM, load
from rotorrig.sims.rotor.model import (
    Direction,
    Load,
    RotorModel,
    along_bearing,
    along_disk_mass,
    along_modulus,
    assemble,
    reduce,
    scale_properties,
    unbalance_loads,
    with_bearing,
)
from rotorrig.sims.rotor.nonlinear import ForceLaw, LawChange, swept_law_derivatives, swept_with_law
from rotorrig.sims.rotor.swept import Timeline, TrackedRows, swept_columns, swept_derivatives, tracked_rows

ROOT = Path(__file__).parents[1]
STEP = 1e-4  # relative, of the differences
UP, DOWN = (480, 3600, 30), (3600, 480, -45)  # rpm, rpm, rpm/s
TURNS_PER_ROW = 8
UNBALANCE, CUBIC = 15e-6, 1e10  # kg m, N/m^3

Change = Callable[[float], RotorModel]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20, help="samples of each part")
    parser.add_argument("--json", action="store_true", help="one JSON object on the last line")
    options = parser.parse_args()
    with threadpool_limits(1):
        found = measure(options.rounds)
    cells = [[name, f"{found[f'{key}_ms']:.1f}"] for name, key in NAMES.items()]
    print(markdown(["part", "CPU ms"], cells))
    print(f"\n{found['rows']} rows, {found['turns']} turns, {found['directions']} parameters.")
    print(
        f"Derivatives cost 1 / {found['ratio']:.1f} of forward differences; error {found['error']:.1e} of their peak."
    )
    if options.json:
        print(json.dumps(found))


NAMES = {
    "rows laid out, once": "layout",
    "response": "response",
    "response and derivatives": "derivatives",
    "response and forward differences": "differences",
    "second order, constant force": "second",
    "response with a cubic spring": "law",
    "that and its ten derivatives": "law_derivatives",
}


def measure(rounds: int) -> dict[str, float]:
    """Return CPU times [ms], the ratio and the error."""
    timeline = Timeline(pulses())
    t = timeline.t[TURNS_PER_ROW:-TURNS_PER_ROW:TURNS_PER_ROW]

    def layout() -> TrackedRows:
        return tracked_rows(timeline, t=t, revolutions=TURNS_PER_ROW, window="hann")

    model, rows = rotor(), layout()
    changes, directions = zip(*parameters(model), strict=True)

    def derivatives() -> NDArray[np.complex128]:
        return swept_derivatives(model, rows, unbalance=["disk"], directions=directions).by

    def differences() -> None:
        for change in (lambda p: model, *changes):
            swept_columns(change(STEP), rows, unbalance=["disk"])

    loads = unbalance_loads(model, ["disk"])
    twice = [Load(model.disk("disk").rows[0].astype(complex), "constant", 2)]
    bent = [LawChange(direction=direction) for direction in directions]
    spring = ForceLaw(rows=model.bearing("spring").rows, force=cubic, constants=np.array([CUBIC]))
    parts = {
        "layout": layout,
        "response": lambda: swept_columns(model, rows, unbalance=["disk"]),
        "derivatives": derivatives,
        "differences": differences,
        "second": lambda: swept_columns(model, rows, loads=twice, order=2),
        "law": lambda: swept_with_law(model, rows, loads, [UNBALANCE], [spring]),
        "law_derivatives": lambda: swept_law_derivatives(model, rows, loads, [UNBALANCE], [spring], changes=bent),
    }
    times: dict[str, list[float]] = {name: [] for name in parts}
    for _ in range(rounds + 1):
        for name, part in parts.items():
            began = time.process_time()
            part()
            times[name].append(1e3 * (time.process_time() - began))
    median = {f"{name}_ms": statistics.median(samples[1:]) for name, samples in times.items()}
    return median | {
        "ratio": median["differences_ms"] / median["derivatives_ms"],
        "error": max(error(by, change, rows) for by, change in zip(derivatives(), changes, strict=True)),
        "rows": len(t),
        "turns": len(timeline.t),
        "directions": len(directions),
    }


@njit(cache=True)
def cubic(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return the force of a cubic spring."""
    k = -constants[0] * (x * x + y * y)
    return k * x, k * y


def rotor() -> RotorModel:
    """Return the reduced model, its probes and these turned by 90 degrees."""
    rig = load(ROOT / "configs/rk4.toml")
    across = [p.model_copy(update={"name": f"{p.name}+90", "angle": p.angle + np.pi / 2}) for p in rig.probes]
    return reduce(assemble(rig.model_copy(update={"probes": (*rig.probes, *across)})), modes=6)


def pulses() -> NDArray[np.float64]:
    """Return the pulse times of a run-up and a coast-down at constant acceleration."""
    times = [np.zeros(1)]
    for start, end, rate in (UP, DOWN):
        omega, alpha = start / RPM, rate / RPM
        turns = int((end**2 - start**2) / RPM**2 / (2 * alpha) / (2 * np.pi))
        theta = 2 * np.pi * np.arange(1, turns + 1)
        times.append(times[-1][-1] + (np.sqrt(omega**2 + 2 * alpha * theta) - omega) / alpha)
    return np.concatenate(times)


def parameters(model: RotorModel) -> list[tuple[Change, Direction]]:
    """Return ten relative changes of the model as a fit makes them, and their directions."""
    found: list[tuple[Change, Direction]] = [
        (lambda p: scale_properties(model, youngs_modulus=1 + p), along_modulus(model)),
        (lambda p: scale_properties(model, disk_mass=1 + p), along_disk_mass(model)),
    ]
    for name, kinds in (("spring", "KC"), ("left A", "K"), ("left B", "K")):
        for kind in kinds:
            for axis in (0, 1):
                found.append(bearing_parameter(model, name, kind, axis))
    return found


def bearing_parameter(model: RotorModel, name: str, kind: str, axis: int) -> tuple[Change, Direction]:
    """Return a relative change of one direct coefficient."""
    bearing = model.bearing(name)
    of = {"K": bearing.K, "C": bearing.C}
    by = np.zeros((2, 2))
    by[axis, axis] = of[kind][axis, axis]

    def change(p: float) -> RotorModel:
        moved = of | {kind: of[kind] + p * by}
        return with_bearing(model, name, moved["K"], moved["C"])

    return change, along_bearing(model, name, **{kind: by})


def error(by: NDArray[np.complex128], change: Change, rows: TrackedRows) -> float:
    """Return the error of a derivative against central differences, as a part of its peak."""
    up, down = (swept_columns(change(p), rows, unbalance=["disk"]) for p in (STEP, -STEP))
    want = (up - down) / (2 * STEP)
    return float(np.abs(by - want).max() / np.abs(want).max())


if __name__ == "__main__":
    main()
