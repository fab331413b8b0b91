"""Table 10: the chapter's test of a rotor kit, done on simulated rigs whose truth is known.

The blind plant (its own beam theory, its own nameplate errors, probes with gain, angle, run-out and curvature) runs up
through 480 to 2140 rpm, one plane of probes, its bearing excited until the 1X amplitude fluctuates by 5 % as in Fig.
12; the pipeline tracks it, one row every 20 rpm, slow-roll vector at 500 rpm. f1, f2 and f3 see the amplitudes less the
slow roll, as the chapter's did; `fit` sees the vectors. The truth is opened afterwards. Each rig has its own
Cramer-Rao bounds, of its own covariance.
"""

import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.parts.blind.run import record
from benchmarks.parts.identification.chapter import (
    NAMES,
    OBJECTIVES,
    TABLE10,
    TABLE10_CALLS,
    TABLE10_REFERENCE,
    TABLE10_SECONDS,
    errors,
)
from benchmarks.parts.identification.cramer_rao import amplitude_root, bounds
from benchmarks.parts.identification.table8 import HALF
from benchmarks.parts.tables import markdown
from rotorrig.acquisition import RawRecording
from rotorrig.identify import identify, measurement
from rotorrig.identify.base_fit import BaseProblem
from rotorrig.identify.base_model import ObjectiveName, Space
from rotorrig.identify.base_model.global_search import search_amplitudes
from rotorrig.identify.base_model.objectives import Amplitudes
from rotorrig.identify.base_model.steady_forward import Steady
from rotorrig.identify.extended_model import ExtendedParameters, recordings_of
from rotorrig.identify.measurement import Measurement
from rotorrig.processing import OrderTrackedResponse, Tracking, track
from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.sims.plant import draw, expected_estimates
from rotorrig.sims.plant.truth import Noise

Real = NDArray[np.float64]

ROOT = Path(__file__).parents[3]
SPEEDS = np.arange(480, 2141, 20) / RPM
SLOW_ROLL = 500 / RPM
RAMP = 10 / RPM  # rad/s^2: slow, since f1 to f3 take the speed as steady
FLUCTUATION = 1e-2  # N per root Hz on the bearing: 5 % of the amplitude above 1200 rpm, 0.2 um below
FIRST_SEED = 100
_CLEAR = 3.0  # standard deviations: smaller amplitudes are left out


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What one way of identification came to on one rig."""

    error: Real  # (5,) %
    calls: int
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One rig."""

    outcomes: dict[str, Outcome]  # "f1".., "f1 uncompensated".., "residual"
    bounds: dict[str, Real]  # "amplitudes", "vectors"; with " exact" the nameplate known exactly: (5,) %


def measure(pool: ProcessPoolExecutor, *, rigs: int) -> list[Case]:
    """Return the cases of as many rigs."""
    return list(pool.map(case, range(FIRST_SEED, FIRST_SEED + rigs)))


def case(seed: int) -> Case:
    """Return what comes of the rig of that seed."""
    return identified(simulated(seed), seed)


def identified(response: OrderTrackedResponse, seed: int) -> Case:
    """Identify the rig of that seed in every way, and only then look at its truth."""
    measured = measurement.measure(response)
    found = {"residual": _fitted(response)}
    for objective in OBJECTIVES:
        found[objective] = _searched(response, measured, objective, slow_roll=True)
        found[f"{objective} uncompensated"] = _searched(response, measured, objective, slow_roll=False)
    hidden = expected_estimates(response.rig, draw(response.rig, seed=seed))
    truth = np.array([hidden[name] for name in NAMES])
    outcomes = {
        name: Outcome(error=100 * (theta / truth - 1), calls=calls, seconds=seconds)
        for name, (theta, calls, seconds) in found.items()
    }
    return Case(outcomes=outcomes, bounds=_bounds(response, measured, truth))


@cache
def rig() -> RigConfig:
    """Return the RK4 with one plane of probes and the chapter's run."""
    rk4 = load(ROOT / "configs/rk4.toml")
    assert rk4.identify is not None
    run = {"slow_roll": SLOW_ROLL, "start": SPEEDS[0], "end": SPEEDS[-1] + 20 / RPM, "ramp": RAMP}
    plan = rk4.plans["default"].model_copy(update=run)  # unchecked: no plan of ours begins below its slow roll
    changes = {"probes": rk4.probes[:2], "plans": {"default": plan}}
    return rk4.model_copy(update={**changes, "identify": rk4.identify.model_copy(update={"bands": {}})})


def recorded(seed: int) -> RawRecording:
    """Return a run-up of the plant of that seed."""
    return record(rig(), seed=seed, noise=Noise(bearing_force=FLUCTUATION), unmodelled=False)


def simulated(seed: int) -> OrderTrackedResponse:
    """Return what the pipeline makes of the plant of that seed: the rows of the run-up next to SPEEDS."""
    response = track(recorded(seed), Tracking(orders=(1.0,)))
    (up,) = (i for i, run in enumerate(response.runs) if run.name == "up")
    rows = np.flatnonzero(response.run == up)
    rows = rows[np.abs(response.omega[rows, None] - SPEEDS).argmin(axis=0)]
    picked = ("run", "t", "omega", "alpha", "revolutions", "z", "covariance", "usable")
    return replace(
        response,
        **{name: getattr(response, name)[rows] for name in picked},
        reasons=tuple(response.reasons[i] for i in rows),
    )


def _fitted(response: OrderTrackedResponse) -> tuple[Real, int, float]:
    began = time.perf_counter()
    found = identify([response]).fits[0]
    theta = np.array([found.estimate(name).value for name in NAMES])
    return theta, found.evaluations, time.perf_counter() - began


def _searched(
    response: OrderTrackedResponse, measured: Measurement, objective: ObjectiveName, *, slow_roll: bool
) -> tuple[Real, int, float]:
    """Return the minimum of f1, f2 or f3; without `slow_roll` the prediction's is not subtracted, as in the chapter."""
    began = time.perf_counter()
    amplitudes = chapter_amplitudes(response, measured, slow_roll=slow_roll)
    optima, calls, *_ = search_amplitudes(amplitudes, objective=objective, rng=np.random.default_rng(0))
    return np.array(optima[0].theta), calls, time.perf_counter() - began


def chapter_amplitudes(response: OrderTrackedResponse, measured: Measurement, *, slow_roll: bool) -> Amplitudes:
    """Return the amplitudes of all rows less the slow roll."""
    space = Space.of(response.rig)
    omega = response.omega[measured.rows]
    if slow_roll:
        omega = np.append(omega, response.slow_roll_omega)
    steady = Steady.of(response.rig, omega, space, planes=space.planes, probes=response.probes)
    vector = measured.z[:-1] - measured.z[-1]
    return Amplitudes(steady, np.where(_clear(vector, measured), np.abs(vector), np.nan), slow_roll=slow_roll)


def _clear(vector: NDArray[np.complex128], measured: Measurement) -> NDArray[np.bool_]:
    return measured.usable[:-1] & (np.abs(vector) > _CLEAR * np.sqrt(2) * measured.sigma[:-1])


def _bounds(response: OrderTrackedResponse, measured: Measurement, truth: Real) -> dict[str, Real]:
    """Return the bounds in %, at the true coefficients and the unbalance and run-out these lead to."""
    problem = BaseProblem.of(recordings_of([response], orders=(1,))).problem
    p = problem.begin(truth[:-1])
    z, root = problem.model.predict(p)[0][1], problem.jacobian(p)
    of_amplitudes = amplitude_root(root, measured, z, used=_clear(z[:-1] - z[-1], measured))
    return {
        **_two_bounds("vectors", root, p, problem.parameters, phase=True),
        **_two_bounds("amplitudes", of_amplitudes, p, problem.parameters, phase=False),
    }


def _two_bounds(name: str, root: Real, p: Real, names: ExtendedParameters, *, phase: bool) -> dict[str, Real]:
    """Return the bounds with the nuisances within their priors, and with the nameplate known exactly, without any.

    Amplitudes less a slow roll know neither `phase` nor run-out.
    """
    base = names.base
    u = complex(*p[base.unbalance])
    amount_and_phase = root[:, base.unbalance] @ np.array([[u.real, -u.imag], [u.imag, u.real]])
    sought = np.column_stack([root[:, base.sought], amount_and_phase[:, : 1 + phase]])
    others = np.setdiff1d(np.arange(len(names)), np.r_[base.sought, base.unbalance, base.runout])
    runout = root[:, base.runout][:, : None if phase else 0]
    nuisances = np.column_stack([root[:, others], runout])
    data = slice(0, len(root) - len(names.priors))
    return {
        name: 100 * bounds(np.column_stack([sought, nuisances]))[: len(NAMES)],
        f"{name} exact": 100 * bounds(np.column_stack([sought, runout])[data])[: len(NAMES)],
    }


def summarise(cases: list[Case]) -> dict[str, Any]:
    """Return table10 of the JSON object: by column the median |error| in %, calls and seconds; "crb" is of vectors."""
    found: dict[str, Any] = {name: _row([case.outcomes[name] for case in cases]) for name in (*OBJECTIVES, "residual")}
    for name in OBJECTIVES:
        found[name]["uncompensated"] = _row([case.outcomes[f"{name} uncompensated"] for case in cases])
    for data, key in (("vectors", "crb"), ("amplitudes", "crb_amplitudes")):
        for exact in ("", " exact"):
            values = np.median([case.bounds[data + exact] for case in cases], axis=0)
            found[key + exact.replace(" ", "_")] = _by_name(values)
    found["rigs"] = len(cases)
    return found


def _row(outcomes: list[Outcome]) -> dict[str, Any]:
    error = np.array([outcome.error for outcome in outcomes])
    return {
        **_by_name(np.median(np.abs(error), axis=0)),
        "bias": _by_name(np.median(error, axis=0)),
        "calls": float(np.median([outcome.calls for outcome in outcomes])),
        "seconds": float(np.median([outcome.seconds for outcome in outcomes])),
    }


def _by_name(values: Iterable[float]) -> dict[str, float]:
    return {name: float(value) for name, value in zip(NAMES, values, strict=True)}


def text(cases: list[Case]) -> str:
    """Return the tables in Markdown, and what can be read from them."""
    summary = summarise(cases)
    readings = "\n".join(f"- {line}" for line in _readings(summary))
    return (
        f"### Table 10: {len(cases)} simulated rigs\n\n{_errors(summary)}\n\n"
        "Slow roll subtracted from the measurement only, as in the chapter (one side), or from the prediction "
        f"too (both): medians of the signed errors:\n\n{_uncompensated(summary)}\n\n{readings}"
    )


def _readings(summary: dict[str, Any]) -> list[str]:
    crb, exact, amplitudes = (summary[key] for key in ("crb", "crb_exact", "crb_amplitudes"))
    attained = ", ".join(f"{summary['residual'][name] / crb[name]:.2f} ({name})" for name in NAMES)
    one_side = ", ".join(f"{name} {_off(summary[name]['uncompensated'])}" for name in OBJECTIVES)
    both = ", ".join(f"{name} {_off(summary[name])}" for name in OBJECTIVES)
    return [
        f'An unbiased estimate that attains a bound has a median |error| of {HALF} of it. Those of "residual" are '
        f"{attained} of the bounds for vectors; the simulated nameplates err less than the priors allow. The bounds "
        "are linear: one of half a damping's value or more means no more than that the damping is poorly determined.",
        f"Of the bound of {crb['kxx']:.2g} % of kxx from vectors, noise alone makes {exact['kxx']:.2g} %. The rest is "
        "the nameplate's uncertainty of shaft, disk, other bearings and probes, which f1 to f3 take as exact.",
        f"From vectors the bounds of cxx and cyy are {crb['cxx']:.2g} % and {crb['cyy']:.2g} %, from amplitudes "
        f"{amplitudes['cxx']:.2g} % and {amplitudes['cyy']:.2g} %.",
        f"With the slow roll subtracted on one side, kxx and u are in error by {one_side}; on both, by {both}. In the "
        "chapter's table f1 and f2 give both too low.",
    ]


def _off(row: dict[str, Any]) -> str:
    return f"{row['bias']['kxx']:+.2g} % and {row['bias']['u']:+.2g} %"


def _errors(summary: dict[str, Any]) -> str:
    printed = errors(TABLE10, TABLE10_REFERENCE)
    head = ["median of \\|error\\|, %", *NAMES, "calls", "s"]
    rows = []
    for name in (*OBJECTIVES, "residual"):
        row = summary[name]
        if name in printed:
            figures = [_percent(abs(off)) for off in printed[name].values()]
            rows.append([f"{name}, chapter", *figures, f"{TABLE10_CALLS[name]:,}", f"{TABLE10_SECONDS:,.0f}"])
        figures = [_percent(row[n]) for n in NAMES]
        rows.append([f"{name}, here", *figures, f"{row['calls']:.0f}", f"{row['seconds']:.2g}"])
    for key, label in _BOUNDS.items():
        rows.append([label, *(_percent(summary[key][n]) for n in NAMES), "", ""])
    return markdown(head, rows)


_BOUNDS = {
    "crb_amplitudes": "Cramer-Rao, amplitudes",
    "crb_amplitudes_exact": "the same, nameplate exact",
    "crb": "Cramer-Rao, vectors",
    "crb_exact": "the same, nameplate exact",
}


def _uncompensated(summary: dict[str, Any]) -> str:
    rows = []
    for name in OBJECTIVES:
        for label, row in ((f"{name}, one side", summary[name]["uncompensated"]), (f"{name}, both", summary[name])):
            rows.append([label, *(f"{row['bias'][n]:+.2g}" for n in NAMES)])
    return markdown(["error, %", *NAMES], rows)


def _percent(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.2g}"
