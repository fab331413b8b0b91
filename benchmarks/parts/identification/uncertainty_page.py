"""docs/uncertainty.md: what an interval of `rotor identify` is, and how often it is right."""

import math
from collections.abc import Mapping
from typing import Any

from benchmarks.parts.identification.coverage_groups import GROUPS, NAMES
from benchmarks.parts.identification.matched_run import LOOKS
from benchmarks.parts.tables import markdown
from rotorrig.identify.uncertainty.settings import UNCERTAINTY

_METHODS = (
    (
        "covariance",
        "(J^T J)^-1 of the whitened residuals and priors at the optimum, times chi2 per degree of freedom where that "
        "exceeds one; ± 1.96 standard deviations, of the logarithm for direct stiffness and damping",
        "unless below",
        "nothing",
    ),
    (
        "profile likelihood",
        "all values with which the fit, everything else fitted again, is worse by no more than 3.84 (95 % of chi2 with "
        "one degree of freedom, scaled as above)",
        f"for all estimates of a fit if one is nearer than {UNCERTAINTY.near:g} standard deviations to a bound of the "
        f"search or known to no better than {100 * UNCERTAINTY.curved:g} %; always with `--profile`",
        "2 to 8 Jacobians an end",
    ),
    (
        "bootstrap",
        "the percentiles of refits to simulated measurements: the fitted rig, nuisances from their priors, noise from "
        "the stated covariance",
        f"with `--bootstrap N`, {UNCERTAINTY.fewest_draws} or more, for the whole sweep",
        "N refits, on `--workers` processes",
    ),
)


def page(coverage: Mapping[str, Any]) -> str:
    """Return the page for the groups of `summarise`."""
    return f"""# Uncertainty

Written by `benchmarks/identification_coverage.py --write`; do not edit.

`rotor identify` gives every estimate a standard deviation, ±, and a 95 % interval. Both hold for this data and this
model: nuisances are free within the priors of the config, and model error is not included ([the adequacy
test](adequacy.md) detects it).

{markdown(["interval by", "what it is", "when", "takes"], _METHODS)}

They agree where chi2 is a parabola over the width of the interval. Where it is not, the covariance is wrong, as it
holds only the curvature at the optimum; it is then wrong for correlated estimates too. The profile follows chi2
itself, and does not depend on whether c or log c is fitted. At a bound it is one-sided: a damping at its lower bound
has no standard deviation, but the data still give an upper limit, "below 2.8 N s/m". Such limits are cautious: they
contain a truth at the bound in 97.5 % of cases.

The bootstrap needs no parabola either. It shows the scatter of estimates about a truth at the estimate, so where that
scatter depends on the truth, above all at a bound, trust the profile. Ctrl-C ends it and keeps the finished draws; the
same `--seed` gives the same draws on any number of processes.

None of the three sees another minimum far away. Coefficients along an axis without a probe have several, and get no
interval; `words` in fit.json says so. So does a resonance that hardly stands out of the noise: with 30 times the noise
of the first group below and speeds only up to 1600 rpm, some fits take a bump of the noise for it, and the intervals of
kxx contained the truth in 18 of 24 such cases.

## Measured coverage

How often the interval contains the truth, in %. {_cases(coverage)}

{table(coverage)}

"95 % range" is the confidence interval of the share over all estimates, from the number of cases (exact binomial,
counting the estimates of a case as one); "by profile" is the share of intervals from the profile likelihood. Every
case is a different rig: kxx and kyy log-uniform from 15 to 80 kN/m, cxx and cyy from 5 to 40 N s/m unless stated
otherwise, 5 to 30 g mm anywhere; modulus, disk mass, the left bearings, probe gains, angles and run-out drawn from
the priors of `configs/rk4.toml`; up and down between 480 and 3600 rpm at 90 rpm/s unless stated otherwise. The
response is the rotor model's own, so this tests the statistics and nothing else. Noise is drawn from the covariance
of a spectrum, white and a random force at the spring bearing; the fit gets an estimate of it from {LOOKS} segments, as
`rotor track` makes one. All of `fit` runs, including the search.

{_groups(coverage)}
"""


def table(coverage: Mapping[str, Any]) -> str:
    """Return the shares of every group and estimate."""
    rows = [
        [
            GROUPS[name].title,
            f"{group['cases']:,d}",
            *(f"{100 * group[key]['share']:.1f}" for key in NAMES),
            f"{100 * group['all']['share']:.1f}",
            f"{100 * group['all']['low']:.1f} to {100 * group['all']['high']:.1f}",
            f"{100 * group['all']['profiled']:.0f} %",
        ]
        for name, group in coverage.items()
    ]
    return markdown(["", "cases", *NAMES, "all", "95 % range", "by profile"], rows)


def _cases(coverage: Mapping[str, Any]) -> str:
    counts = sorted({group["cases"] for group in coverage.values()}, reverse=True)
    half = [f"± {196 * (0.95 * 0.05 / count) ** 0.5:.1f} with {count:,d} cases" for count in counts]
    return f"By chance alone 95 % of such values lie within 95 {', '.join(half)}."


def _groups(coverage: Mapping[str, Any]) -> str:
    return "\n".join(_group(name, group) for name, group in coverage.items())


def _group(name: str, group: Mapping[str, Any]) -> str:
    known = ", ".join(f"{_percent(group[key]['relative_sigma_median'])} of {key}" for key in ("kxx", "cxx", "u"))
    return (
        f"- **{GROUPS[name].title}**: {GROUPS[name].says}. Standard deviations, medians: {known}; "
        f"estimates off by {group['all']['rms_off']:.2f} standard deviations rms, where they have one."
    )


def _percent(sigma: float) -> str:
    return f"{100 * sigma:.2g} %" if math.isfinite(sigma) else "no value"
