"""Table 7: the three-disk rotor of Lalanne and Ferraris identified from its amplitudes without noise.

The data are another program's (tests/data/oracle), 75 speeds and the amplitudes at nodes 2 and 12, along x and y; the
box is that of eq. (20). "Scalar" is CHEA on f1, f2 and f3 as a black box, "vector" the search that is given residuals
and their derivatives. Both stop by themselves. Then as many random truths, log-uniform over the whole box, whose data
are the model's own.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.identification.searches import black_box
from benchmarks.parts.tables import markdown
from rotorrig.identify.base_model import ObjectiveName, Space
from rotorrig.identify.base_model.global_search import search_amplitudes, search_residual
from rotorrig.identify.base_model.objectives import Amplitudes, ComplexResidual
from rotorrig.identify.base_model.steady_forward import Steady, shaft_stiffness
from rotorrig.rig.config import RPM, load
from rotorrig.sims.rotor.model import assemble
from rotorrig.sims.rotor.steady.receptance import condense

ROOT = Path(__file__).parents[3]
TRUTH = np.array([50e6, 70e6, 500.0, 700.0, 200e-6])  # Table 5: kxx, kyy, cxx, cyy, u
OBJECTIVES: tuple[ObjectiveName, ...] = ("f1", "f2", "f3")
CHAPTER = {"f1": 2993, "f2": 2768, "f3": 3150}  # calls, Table 7
EXACT = 1e-3  # relative: what the table's three digits show
SAME_RESPONSE = 1e-8  # of the response, root mean square


@dataclass(frozen=True)
class Run:
    """One search: calls of the model, largest relative error of a parameter."""

    calls: int
    error: float


@dataclass(frozen=True)
class RandomRun:
    """One search for a random truth."""

    calls: int
    residual: float  # rms difference of the response, relative
    error: float  # largest relative error of a parameter the data determine
    determined: bool  # whether they determine all


def measure(pool: ProcessPoolExecutor, *, seeds: int, truths: int) -> dict[str, Any]:
    """Return what `summarise` and `text` need."""
    jobs = [(kind, seed) for kind in (*OBJECTIVES, *VECTORS) for seed in range(seeds)]
    runs: dict[str, list[Run]] = {}
    for (kind, _), run in zip(jobs, pool.map(_run, jobs, chunksize=5), strict=True):
        runs.setdefault(kind, []).append(run)
    return {"runs": runs, "random": list(pool.map(random_run, range(truths), chunksize=10))}


def summarise(measured: dict[str, Any]) -> dict[str, Any]:
    """Return table7 of the JSON object. "residual" is the vector search for f2; the others stand beside it."""
    rows = {kind: _row(runs) for kind, runs in measured["runs"].items()}
    random: list[RandomRun] = measured["random"]
    return {
        **{name: rows[name] for name in OBJECTIVES},
        "residual": rows["f2 vector"],
        **{name.replace(" ", "_"): rows[name] for name in VECTORS},
        "random": {
            "truths": len(random),
            "residual_ok": _share(run.residual <= SAME_RESPONSE for run in random),
            "parameters_ok": _share(run.error <= EXACT for run in random if run.residual <= SAME_RESPONSE),
            "undetermined": _share(not run.determined for run in random),
            "calls_median": float(np.median([run.calls for run in random])),
            "calls_p90": float(np.quantile([run.calls for run in random], 0.9)),
        },
    }


def text(measured: dict[str, Any]) -> str:
    """Return the tables in Markdown."""
    summary = summarise(measured)
    names = [*OBJECTIVES, *(name.replace(" ", "_") for name in VECTORS)]
    rows = [
        [
            name.replace("_", ", "),
            f"{CHAPTER[name]:,d}" if name in CHAPTER else "-",
            f"{row['calls_median']:.0f}",
            f"{row['calls_p90']:.0f}",
            f"{row['calls_max']:.0f}",
            f"{row['success']:.0%}",
            f"{row['error']:.1e}",
        ]
        for name in names
        for row in (summary[name],)
    ]
    head = ["search", "chapter's calls", "calls, median", "90 %", "most", "exact", "largest error"]
    random = summary["random"]
    return (
        f"### Table 7: no noise\n\n{markdown(head, rows)}\n\n"
        f"{random['truths']} sets of true values drawn at random within the bounds: the response agrees to "
        f"{SAME_RESPONSE:.0e} in {random['residual_ok']:.1%}, in a median of {random['calls_median']:.0f} calls (90 %: "
        f"{random['calls_p90']:.0f}); there, the parameters that the data determine are within {EXACT:.1%} in "
        f"{random['parameters_ok']:.1%}. In {random['undetermined']:.1%} some parameter is undetermined."
    )


def _row(runs: list[Run]) -> dict[str, float]:
    calls, errors = np.array([run.calls for run in runs]), np.array([run.error for run in runs])
    return {
        "calls_median": float(np.median(calls)),
        "calls_p90": float(np.quantile(calls, 0.9)),
        "calls_max": float(calls.max()),
        "success": float((errors <= EXACT).mean()),
        "error": float(errors.max()),
    }


def _share(true: Iterable[bool]) -> float:
    return float(np.mean(list(true)))


@cache
def steady() -> Steady:
    """Return the model at the oracle's speeds, the mesh the oracle's."""
    rig = load(ROOT / "benchmarks/lalanne.toml")
    omega = _oracle()["rpm"] / RPM
    receptance = condense(assemble(rig, max_element=0.1), omega, bearings=("left", "right"), disk="2")
    return Steady(receptance, Space.of(rig), soft=shaft_stiffness(rig))


@cache
def oracle_response() -> NDArray[np.complex128]:
    """Return the other program's response, (speed, probe) m."""
    return np.stack([_oracle()[name] for name in ("X2", "Y2", "X12", "Y12")], axis=1)


def _oracle() -> Any:
    return np.load(ROOT / "tests/data/oracle/oracle_lalanne.npz")


def scalar(objective: ObjectiveName, seed: int) -> Run:
    """Search f1, f2 or f3 as a black box."""
    found, _, calls = black_box(Amplitudes(steady(), np.abs(oracle_response())), objective=objective, seed=seed)
    return Run(calls, _error(found, TRUTH))


def vector(objective: str, seed: int) -> Run:
    """Search with the amplitudes' residual vector, or the whitened complex one."""
    rng, z = np.random.default_rng(seed), oracle_response()
    if objective == "complex":
        whiten = np.broadcast_to(np.eye(2 * z.shape[1]), (len(z), 2 * z.shape[1], 2 * z.shape[1]))
        optima, calls, *_ = search_residual(ComplexResidual(steady(), z, whiten / np.abs(z).max()), rng=rng)
    else:
        optima, calls, *_ = search_amplitudes(Amplitudes(steady(), np.abs(z)), objective=objective, rng=rng)
    return Run(calls, _error(np.array(optima[0].theta), TRUTH))


VECTORS: dict[str, Callable[[int], Run]] = {
    f"{name} vector": lambda seed, name=name: vector(name, seed) for name in (*OBJECTIVES, "complex")
}


def _run(job: tuple[str, int]) -> Run:
    kind, seed = job
    return VECTORS[kind](seed) if kind in VECTORS else scalar(kind, seed)


def random_run(seed: int) -> RandomRun:
    """Draw a truth from the box of eq. (20), search for it, and compare what the data determine."""
    rng = np.random.default_rng([7, seed])
    truth, v = random_truth(rng)
    amplitude = np.abs(steady().receptance.response(*truth))
    amplitudes = Amplitudes(steady(), amplitude)
    optima, calls, *_ = search_amplitudes(amplitudes, objective="f2", rng=rng)
    found = np.array(optima[0].theta)
    ratio = np.abs(steady().receptance.response(*found)) / amplitude
    sigma = standard_deviations(amplitudes, v, noise=SAME_RESPONSE)
    known = sigma < EXACT / 3
    return RandomRun(
        calls=calls,
        residual=float(np.sqrt(np.mean((ratio - 1) ** 2))),
        error=_error(found[known], truth[known]) if known.any() else 0.0,
        determined=bool(known.all()),
    )


def random_truth(rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return kxx, kyy, cxx, cyy and u drawn from the box of eq. (20), (5,) in SI, and their place in the unit cube."""
    v = np.append(rng.random(steady().dim), rng.random())
    model = Amplitudes(steady(), np.ones((len(oracle_response()), 4)))
    return np.array(model.theta(v)), v


def standard_deviations(amplitudes: Amplitudes, v: NDArray[np.float64], *, noise: float) -> NDArray[np.float64]:
    """Return the Cramer-Rao bounds of the parameters' logarithms for relative noise on the amplitudes, (5,)."""
    _, by_v = amplitudes.log_ratios(v)
    space = amplitudes.steady.space
    widths = [*np.diff(np.log(space.bounds)).ravel(), *(np.log(a.high / a.low) for a in space.amounts)]
    jacobian = by_v * np.log(10.0) / widths
    _, size, directions = np.linalg.svd(jacobian, full_matrices=False)
    return noise * np.sqrt(((directions / np.maximum(size, np.finfo(float).tiny)[:, None]) ** 2).sum(axis=0))


def _error(found: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    return float(np.abs(found / truth - 1).max())
