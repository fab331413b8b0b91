"""What one unbalance response costs: ours, condensed, beside ROSS, the real form of eq. (11) and a dense solve.

    make bench                                  (sets ROSS up in .venv-ross, writes docs/forward-speed.md)
    python benchmarks/forward.py --json         (one JSON object on the last line)

Everything in one run and one thread, the parts taken in turns, medians. Times are of the process's CPU, so that other
work on the machine counts little; wall times stand beside them. ROSS runs in its own environment (`--ross-python`).
"""

import argparse
import json
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks.parts.forward.growth import POPULATION, growth_tables
from benchmarks.parts.forward.page import page, table
from benchmarks.parts.forward.peers import dense, real_form, ross, ross_case
from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.sims.rotor.model import RotorModel, assemble
from rotorrig.sims.rotor.steady import Receptance
from rotorrig.sims.rotor.steady.receptance import condense

ROOT = Path(__file__).parents[1]
ORACLES = ROOT / "tests/data/oracle"  # whose speeds are used
CHECKED = 5  # candidates of the population whose response is compared with the dense solve


@dataclass(frozen=True, kw_only=True)
class Case:
    """One of the chapter's two rotors and its speeds."""

    rig: RigConfig
    model: RotorModel
    omega: NDArray[np.float64]
    bearings: tuple[str, ...]
    disk: str
    truth: tuple[float, float, float, float, float]  # kxx, kyy, cxx, cyy, u as in the config
    receptance: Receptance

    @classmethod
    def of(
        cls, config: Path, oracle: str, *, bearings: tuple[str, ...], disk: str, u: float, max_element: float
    ) -> "Case":
        """Load a config, mesh it, condense it at the speeds of an oracle."""
        rig, omega = load(config), np.load(ORACLES / oracle)["rpm"] / RPM
        model = assemble(rig, max_element=max_element)
        b = rig.bearing(bearings[0])
        return cls(
            rig=rig,
            model=model,
            omega=omega,
            bearings=bearings,
            disk=disk,
            truth=(b.constant("kxx"), b.constant("kyy"), b.constant("cxx"), b.constant("cyy"), u),
            receptance=condense(model, omega, bearings=bearings, disk=disk),
        )

    def population(self, rng: np.random.Generator) -> NDArray[np.float64]:
        """Return candidates within a factor of ten of the truth, (5, POPULATION)."""
        return np.array(self.truth)[:, None] * 10 ** rng.uniform(-1, 1, (5, POPULATION))


@dataclass
class Times:
    """Samples of (CPU, wall) time per call [us], by what was timed."""

    samples: dict[str, list[tuple[float, float]]] = field(default_factory=dict)

    def take(self, name: str, work: Callable[[], object], *, calls: int = 1, per: int = 1) -> None:
        """Add one sample: `calls` calls in a row, each for `per` candidates."""
        cpu, wall = time.process_time(), time.perf_counter()
        for _ in range(calls):
            work()
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        self.samples.setdefault(name, []).append((cpu / calls / per * 1e6, wall / calls / per * 1e6))

    def median(self, name: str) -> tuple[float, float]:
        """Return the medians of CPU and wall time [us]."""
        cpu, wall = zip(*self.samples[name], strict=True)
        return statistics.median(cpu), statistics.median(wall)


def main() -> None:
    """Measure, print, and write the page if asked."""
    options = arguments()
    with threadpool_limits(1):
        rk4 = Case.of(
            ROOT / "configs/rk4.toml",
            "oracle_rk4_pair.npz",
            bearings=("spring",),
            disk="disk",
            u=15e-6,
            max_element=0.02,
        )
        lalanne = Case.of(
            ROOT / "benchmarks/lalanne.toml",
            "oracle_lalanne.npz",
            bearings=("left", "right"),
            disk="2",
            u=200e-6,
            max_element=0.1,
        )
        cases = {"RK4": rk4, "Lalanne": lalanne}
        measured = {name: measure(case, options.rounds) for name, case in cases.items()}
        answers = ross(
            options.ross_python,
            {n: ross_case(c.rig, c.model, c.omega, disk=c.disk, u=c.truth[-1]) for n, c in cases.items()},
        )
        for name, case in cases.items():
            add_ross(measured[name], case, answers["cases"][name])
        growth = growth_tables(rk4.rig, rk4.omega)
    text = "\n\n".join([*(table(name, found) for name, found in measured.items()), *growth])
    summary = summarise(measured)
    if options.write:
        versions = f"ROSS {answers['version']} with numpy {answers['numpy']}, here numpy {np.__version__}"
        (ROOT / "docs/forward-speed.md").write_text(page(text, summary, versions, options.rounds), encoding="utf-8")
    print(text)
    print(json.dumps(summary) if options.json else "\n".join(f"{k}: {v:.4g}" for k, v in summary.items()))


def arguments() -> argparse.Namespace:
    """Return the checked command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = ROOT / ".venv-ross/bin/python"
    parser.add_argument("--ross-python", type=Path, default=default, help="the Python of an environment with ROSS")
    parser.add_argument("--rounds", type=int, default=25, help="samples per figure (default 25)")
    parser.add_argument("--json", action="store_true", help="end with one JSON object on the last line")
    parser.add_argument("--write", action="store_true", help="write docs/forward-speed.md")
    options = parser.parse_args()
    if options.rounds < 1:
        parser.error(f"--rounds is {options.rounds}, want at least 1")
    if not options.ross_python.exists():
        parser.error(f"{options.ross_python} does not exist, want a Python with ROSS 2.3.0: make .venv-ross/ready")
    return options


def measure(case: Case, rounds: int) -> dict[str, Any]:
    """Return medians (CPU, wall) [us] of everything but ROSS, and the largest relative difference."""
    rng = np.random.default_rng(0)
    theta = case.population(rng)
    ours, one = case.receptance, case.truth
    z = ours.response(*one)
    amplitude = np.abs(z[:-1] - z[-1:]) * rng.lognormal(0, 0.05, (len(z) - 1, z.shape[1]))
    K, C, u = np.diag(one[:2])[None], np.diag(one[2:4])[None], np.array([one[4]])
    peers = {
        "dense numpy": dense(case.model, case.omega, bearings=case.bearings, disk=case.disk),
        "real 2N form": real_form(case.model, case.omega, bearings=case.bearings, disk=case.disk),
    }
    times = Times()
    works: list[tuple[str, Callable[[], object], int, int]] = [
        ("population", lambda: ours.response(*theta), 5, POPULATION),
        (
            "population + objective",
            lambda: ours.misfit(amplitude, *theta, objective="f2", slow_roll=True),
            5,
            POPULATION,
        ),
        ("single", lambda: ours.response(*one), 200, 1),
        ("single, all coefficients", lambda: ours.general_response(K, C, u), 200, 1),
        ("single + Jacobian", lambda: ours.response_and_derivatives(K, C, u), 200, 1),
    ]
    for _, work, _, _ in works:
        work()  # compiles
    for turn in range(rounds):
        for name, work, calls, per in works:
            times.take(name, work, calls=calls, per=per)
        if turn % 5 == 0:
            for name, response in peers.items():
                times.take(name, lambda response=response: response(*one))
    candidates = [one, *theta.T[:CHECKED]]
    difference = max(relative(ours.response(*x), response(*x)) for x in candidates for response in peers.values())
    return {"times": {name: times.median(name) for name in times.samples}, "difference": difference}


def add_ross(measured: dict[str, Any], case: Case, answer: dict[str, Any]) -> None:
    """Add ROSS's times and its difference to what was measured."""
    names = {"fresh": "ROSS, built anew", "response": "ROSS, response", "cached": "ROSS, asked again"}
    for key, name in names.items():
        cpu, wall = answer["cpu_wall"][key]
        measured["times"][name] = (cpu * 1e6, wall * 1e6)
    z = np.array(answer["re"]) + 1j * np.array(answer["im"])
    measured["difference"] = max(measured["difference"], relative(case.receptance.response(*case.truth), z))


def relative(got: NDArray[np.complex128], want: NDArray[np.complex128]) -> float:
    """Return the largest difference as a part of the peak."""
    return float(np.abs(got - want).max() / np.abs(want).max())


def summarise(measured: dict[str, Any]) -> dict[str, float]:
    """Return the headline figures: CPU time [us], ratios, and the largest relative difference to any peer."""
    cpu = {case: {name: pair[0] for name, pair in found["times"].items()} for case, found in measured.items()}
    rk4, lalanne = cpu["RK4"], cpu["Lalanne"]
    return {
        "rk4_us": rk4["population + objective"],
        "lalanne_us": lalanne["population + objective"],
        "rk4_single_us": rk4["single"],
        "rk4_vs_ross": rk4["ROSS, response"] / rk4["population + objective"],
        "lalanne_vs_ross": lalanne["ROSS, response"] / lalanne["population + objective"],
        "jacobian_over_value": max(c["single + Jacobian"] / c["single, all coefficients"] for c in cpu.values()),
        "max_rel_diff": max(found["difference"] for found in measured.values()),
    }


if __name__ == "__main__":
    main()
