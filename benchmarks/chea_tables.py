"""The seed chapter's Tables 2 to 4: calls, success and minima listed, over seeds.

    python benchmarks/chea_tables.py --seeds 20
    python benchmarks/chea_tables.py --seeds 100 --json > chea_tables.json

Every call counts, finite differences included. "shifted" moves the box at random per seed, so that neither the middle
nor the symmetry of the function about it helps. Success is within 1e-3 of the global minimum in every parameter;
for eq. (3), of all four, each in the list of minima.
"""

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds

from rotorrig.identify.chea.chea import chea
from rotorrig.identify.chea.result import CheaResult
from rotorrig.identify.chea.settings import SEED

Array = NDArray[np.float64]


def banana(x: Array) -> Array:
    """Eq. (2), with the square the print lost."""
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


def multimodal(x: Array) -> Array:
    """Eq. (3), to be minimised."""
    u, v = np.pi * x.T
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))


def rastrigin(x: Array) -> Array:
    """Eq. (4), with the x_i the print lost."""
    return 20 + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=1)


@dataclass(frozen=True)
class Case:
    """A function, its box [-half, half]^2, its global minima and the chapter's figures."""

    name: str
    fun: Callable[[Array], Array]
    half: float
    minima: tuple[tuple[float, float], ...]
    chapter: str
    shift: float = 0.0  # the box's middle is uniform within this share of its half


PEAKS = tuple((a * 0.43880, b * 0.30585) for a in (1, -1) for b in (1, -1))
CASES = (
    Case("f1 banana", banana, 2.0, ((1.0, 1.0),), "1120"),
    Case("f2 multimodal", multimodal, 1.0, PEAKS, "1131, all four"),
    Case("f2 shifted", multimodal, 1.0, PEAKS, "-", shift=0.4),
    Case("f3 rastrigin", rastrigin, 5.0, ((0.0, 0.0),), "2100, 99 %"),
    Case("f3 shifted", rastrigin, 5.0, ((0.0, 0.0),), "-", shift=0.6),
)


@dataclass(frozen=True)
class Row:
    """What came out for one case."""

    name: str
    mean_calls: float
    median_calls: float
    max_calls: int
    success_percent: float
    minima_listed: float
    chapter: str


def solve(case: Case, seed: int) -> CheaResult:
    """Run one case with one seed."""
    rng = np.random.default_rng(seed)
    middle = rng.uniform(-case.shift, case.shift, 2) * case.half
    bounds = Bounds(middle - case.half, middle + case.half)
    return chea(case.fun, bounds, rng=rng, vectorized=True, settings=SEED)


def success(case: Case, result: CheaResult) -> bool:
    """Return whether all global minima are listed to 1e-3."""
    off = np.abs(result.xl[:, None] - np.array(case.minima)).max(axis=2)
    return bool((off.min(axis=0, initial=np.inf) < 1e-3).all())


def measure(case: Case, seeds: int) -> Row:
    """Run one case with seeds 0, 1, ..."""
    results = [solve(case, seed) for seed in range(seeds)]
    calls = [result.nfev for result in results]
    return Row(
        name=case.name,
        mean_calls=float(np.mean(calls)),
        median_calls=float(np.median(calls)),
        max_calls=max(calls),
        success_percent=100 * float(np.mean([success(case, result) for result in results])),
        minima_listed=float(np.mean([len(result.xl) for result in results])),
        chapter=case.chapter,
    )


def main() -> None:
    """Print the table, or the same as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20, help="runs per function (default 20)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    options = parser.parse_args()
    if options.seeds < 1:
        parser.error(f"--seeds is {options.seeds}, expected at least 1")
    rows = [measure(case, options.seeds) for case in CASES]
    if options.json:
        print(json.dumps({"profile": "seed", "seeds": options.seeds, "rows": [asdict(row) for row in rows]}, indent=2))
        return
    print(f"{'':14}  {'mean':>6} {'median':>6} {'max':>6}  {'success':>7}  {'minima':>6}  chapter")
    for row in rows:
        print(
            f"{row.name:14}  {row.mean_calls:6.0f} {row.median_calls:6.0f} {row.max_calls:6d}"
            f"  {row.success_percent:5.0f} %  {row.minima_listed:6.1f}  {row.chapter}"
        )


if __name__ == "__main__":
    main()
