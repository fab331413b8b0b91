"""False alarms of the diagnosis: healthy simulated rigs, nameplate errors included, straight from the plant.

Prints the test figures per rig and their quantiles; docs/adequacy.md is written from them (--write). The wire and the
file are left out (they change no sample); sweep, sensors, tracking and diagnosis are the real ones.
"""

import argparse
import json
import math
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from benchmarks.parts.blind.records import source_version
from benchmarks.parts.blind.run import record
from rotorrig.identify import diagnose, identify
from rotorrig.identify.adequacy import ADEQUACY
from rotorrig.processing import track
from rotorrig.rig.config import load
from rotorrig.sims.plant import draw, expected_estimates

ROOT = Path(__file__).parents[1]
NAMES = ("kxx", "kyy", "cxx", "cyy", "u", "phase")
KINDS = {True: "with what no nameplate speaks of", False: "as the nameplate says, within its tolerances"}


def case(arguments: tuple[Path, int, bool]) -> dict[str, Any]:
    """Return the figures of one healthy rig, and the errors of what was identified in sigmas."""
    config, seed, unmodelled = arguments
    rig = load(config)
    response = track(record(rig, seed=seed, unmodelled=unmodelled))
    found = diagnose([response], seed=seed)
    fit = identify([response], seed=seed).fits[0]
    truth = expected_estimates(rig, draw(rig, seed=seed))
    off = {}
    for name in NAMES:
        estimate = fit.estimate(name)
        error = estimate.value - truth[name]
        off[name] = (math.remainder(error, math.tau) if name == "phase" else error) / estimate.sigma
    return {
        "seed": seed,
        "unmodelled": unmodelled,
        "chi2": found.chi2 / found.dof,
        "p": found.p,
        "verdict": str(found.verdict),
        "named": [cause.label for cause in found.causes if cause.chosen],
        **off,
    }


def main() -> None:
    """Run the seeds and print a line each, then the quantiles."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first", type=int, default=2000)
    parser.add_argument("--config", type=Path, default=ROOT / "configs/rk4.toml")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--write", action="store_true", help="write docs/adequacy.md")
    options = parser.parse_args()
    began = time.perf_counter()
    jobs = [(options.config, options.first + i, kind) for kind in KINDS for i in range(options.seeds)]
    rows = []
    with ProcessPoolExecutor(options.workers) as pool:
        for row in pool.map(case, jobs):
            rows.append(row)
            print(" ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in row.items()), flush=True)
    summary: dict[str, Any] = {
        ("unmodelled" if kind else "nameplate"): summarise([row for row in rows if row["unmodelled"] is kind])
        for kind in KINDS
    }
    summary |= {"first": options.first, "seconds_per_case": (time.perf_counter() - began) / len(rows)}
    if options.write:
        (ROOT / "docs/adequacy.md").write_text(page(summary), encoding="utf-8")
    print(json.dumps(summary) if options.json else "\n".join(f"{k}: {v}" for k, v in summary.items()))


def summarise(rows: Sequence[dict[str, Any]]) -> dict[str, float]:
    """Return alarms, quantiles of chi2, and how the identified values lie about the truth."""
    chi2 = np.array([row["chi2"] for row in rows])
    off = np.array([[row[name] for name in NAMES] for row in rows])
    return {
        "cases": len(rows),
        "inadequate": sum(row["p"] < ADEQUACY.false_alarm_rate for row in rows),
        "not_adequate": sum(row["verdict"] != "adequate" for row in rows),
        "named": sum(row["verdict"] in ("named", "tied") for row in rows),
        "chi2_mean": float(chi2.mean()),
        "chi2_least": float(chi2.min()),
        "chi2_most": float(chi2.max()),
        "within_2_sigma": float((np.abs(off) < 2).mean()),
        "rms_sigma": float(np.sqrt((off**2).mean())),
    }


def page(summary: dict[str, Any]) -> str:
    """Return docs/adequacy.md."""
    first, each = summary["first"], [summary["nameplate"], summary["unmodelled"]]
    n = each[0]["cases"]
    upper = [stats.beta.ppf(0.95, s["inadequate"] + 1, n - s["inadequate"]) for s in each]

    def line(words: str, cells: Sequence[str]) -> str:
        return f"| {words} | {' | '.join(cells)} |"

    table = [
        line("", [KINDS[False], KINDS[True]]),
        "|---|---|---|",
        line("rigs", [str(s["cases"]) for s in each]),
        line(
            "test failed (95 % upper bound of the rate)",
            [f"{s['inadequate']} ({u:.1%})" for s, u in zip(each, upper, strict=True)],
        ),
        line("verdict other than adequate", [str(s["not_adequate"]) for s in each]),
        line("a cause named, alone or tied", [str(s["named"]) for s in each]),
        line(
            "chi2 per degree of freedom: mean, least, most",
            [f"{s['chi2_mean']:.3f}, {s['chi2_least']:.2f}, {s['chi2_most']:.2f}" for s in each],
        ),
        line("identified values within two sigmas of the truth", [f"{s['within_2_sigma']:.0%}" for s in each]),
        line("root mean square error in sigmas", [f"{s['rms_sigma']:.2f}" for s in each]),
    ]
    return "\n".join(
        [
            "# The adequacy test and its false alarms",
            "",
            "Written by `benchmarks/healthy.py --write`; do not edit.",
            "",
            f"A model is called adequate if p is at least {ADEQUACY.false_alarm_rate:g}: the probability that a right",
            "model leaves residuals as large as it does, its own error of `prior.model_error` taken off.",
            "They are held against their own scatter from row to row, all 1X rows together and every stretch of",
            f"{ADEQUACY.stretch} neighbouring rows of one run, probe and order; the number of stretches is paid for.",
            "The diagnosis was run on healthy simulated rigs of `configs/rk4.toml`, each with its own stiffness,",
            "damping, unbalance, modulus, mass, probe gains and angles, run-out and noise, half of them with what no",
            "nameplate speaks of as well (docs/plant.md): the coupling's stiffness, ripple of the supply, drift with",
            "temperature, noise and damping that change with speed. One recording each,",
            f"seeds {first} to {first + n - 1}, sources {source_version()}:",
            "",
            *table,
            "",
            "None of this was measured on real rigs: their noise is rougher and their deviations have other causes.",
            "",
        ]
    )


if __name__ == "__main__":
    main()
