"""False alarms of the adequacy test: healthy simulated rigs, nameplate errors included, straight from the plant.

Prints the two test figures per seed and their quantiles; docs/adequacy.md is written from them (--write).
The wire and the file are left out (they change no sample); sweep, sensors, tracking and fit are the real ones.
"""

import argparse
import json
import math
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from benchmarks.parts.blind.run import record
from rotorrig.identify import identify
from rotorrig.identify.adequacy import ADEQUACY, assess
from rotorrig.processing import track
from rotorrig.rig.config import load
from rotorrig.sims.plant import draw, expected_estimates

ROOT = Path(__file__).parents[1]


def case(arguments: tuple[Path, int]) -> dict[str, float]:
    """Return the test figures of one healthy rig, and the errors of what was identified in sigmas."""
    config, seed = arguments
    rig = load(config)
    response = track(record(rig, seed=seed))
    found = identify(response, seed=seed)
    adequacy = assess(response, {1: found.fits[0].prediction}, reduced_chi2=found.fits[0].chi2 / found.fits[0].dof)
    truth = expected_estimates(rig, draw(rig, seed=seed))
    row = {"seed": seed, "chi2": adequacy.reduced_chi2, "worst": adequacy.worst_sigma}
    for name, value in truth.items():
        estimate = found.fits[0].estimate(name)
        off = estimate.value - value
        row[name] = (math.remainder(off, math.tau) if name == "phase" else off) / estimate.sigma
    return row


def main() -> None:
    """Run the seeds and print a line each, then the quantiles."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--first", type=int, default=1000)
    parser.add_argument("--config", type=Path, default=ROOT / "configs/rk4.toml")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--write", action="store_true", help="write docs/adequacy.md")
    options = parser.parse_args()
    began = time.perf_counter()
    jobs = [(options.config, options.first + i) for i in range(options.seeds)]
    rows = []
    with ProcessPoolExecutor(options.workers) as pool:
        for row in pool.map(case, jobs):
            rows.append(row)
            print(" ".join(f"{k} {v:.3g}" for k, v in row.items()), flush=True)
    summary = summarise(rows, time.perf_counter() - began)
    if options.write:
        (ROOT / "docs/adequacy.md").write_text(page(summary, options.first), encoding="utf-8")
    print(json.dumps(summary) if options.json else "\n".join(f"{k}: {v}" for k, v in summary.items()))


def summarise(rows: list[dict[str, float]], seconds: float) -> dict[str, float]:
    """Return alarms, quantiles of both figures and the share of true values within two sigmas."""
    chi2, worst = (np.array([row[k] for row in rows]) for k in ("chi2", "worst"))
    off = np.array([[row[k] for k in ("kxx", "kyy", "cxx", "cyy", "u", "phase")] for row in rows])
    return {
        "cases": len(rows),
        "false_alarms": int(((chi2 > ADEQUACY.global_limit) | (worst > ADEQUACY.focused_limit)).sum()),
        "chi2_median": float(np.median(chi2)),
        "chi2_max": float(chi2.max()),
        "worst_median": float(np.median(worst)),
        "worst_max": float(worst.max()),
        "within_2_sigma": float((np.abs(off) < 2).mean()),
        "rms_sigma": float(np.sqrt((off**2).mean())),
        "seconds_per_case": seconds / len(rows),
    }


def page(summary: dict[str, float], first: int) -> str:
    """Return docs/adequacy.md."""
    n, alarms = int(summary["cases"]), int(summary["false_alarms"])
    upper = 1 - 0.05 ** (1 / n) if alarms == 0 else float("nan")
    bound = f" (95 % upper bound of the rate: {upper:.1%})" if alarms == 0 else ""
    chi2_limit, sigma_limit = ADEQUACY.global_limit, ADEQUACY.focused_limit
    return f"""# The adequacy test and its false alarm rate

Written by `benchmarks/healthy.py --write`; do not edit.

A fit is called adequate if chi2 per degree of freedom of the 1X residuals is at most {chi2_limit:g} and no stretch
of neighbouring rows of one run, probe and order exceeds {sigma_limit:g} sigma rms. The sigmas combine the noise found
in the data with `prior.probe_linearity` of the reading. It was run on healthy simulated rigs of `configs/rk4.toml`,
each with its own stiffness, damping, unbalance, modulus, mass, probe gains and angles, runout and noise (seeds
{first} to {first + n - 1}):

| | |
|---|---|
| cases | {n} |
| found not adequate | {alarms}{bound} |
| chi2 per degree of freedom, median and largest | {summary["chi2_median"]:.2f}, {summary["chi2_max"]:.2f} |
| worst stretch, median and largest | {summary["worst_median"]:.2f}, {summary["worst_max"]:.2f} sigma |
| identified values within two sigmas of the truth | {summary["within_2_sigma"]:.0%} |
| root mean square error in sigmas | {summary["rms_sigma"]:.2f} |

The thresholds were set on other seeds of the same rig. None of this was measured on real rigs: their noise is rougher
and their deviations have other causes.
"""


if __name__ == "__main__":
    main()
