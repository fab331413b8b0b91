"""Identified values ± 1 sigma beside the nameplate and, for a simulated rig, the truth."""

import math
from collections.abc import Mapping

from rotorrig.app.report.figures import search_map
from rotorrig.app.report.html import Section, details, paragraph, plot, section, table
from rotorrig.app.text import (
    bound_text,
    change_in_sigmas,
    change_text,
    estimate_text,
    interval_text,
    is_determined,
    long_name,
    quantity_text,
    search_line,
    stages_text,
)
from rotorrig.identify import Diagnosis, Estimate, Fit, Identification, Verdict
from rotorrig.rig.config import RPM


def identified_section(
    identification: Identification | None, diagnosis: Diagnosis | None, *, truth: Mapping[str, float] | None
) -> Section | None:
    """Return the section; None without a fit. `truth` maps names of estimates to values in SI."""
    if identification is None:
        return None
    wrong = diagnosis is not None and diagnosis.verdict not in (Verdict.ADEQUATE, Verdict.CANNOT_TELL)
    first = identification.fits[:1]
    return section(
        "identified",
        "Identified values",
        paragraph(_WRONG_MODEL, kind="warning") if wrong else "",
        *(_estimates(fit, truth=truth) for fit in identification.fits),
        paragraph(_PLUS_MINUS),
        *(_limits(fit) for fit in first if fit.budget),
        *(_nuisances(fit) for fit in first if fit.nuisances),
        *(_search(fit) for fit in first if fit.trace.stages),
    )


def _estimates(fit: Fit, *, truth: Mapping[str, float] | None) -> str:
    """Return the identified values of a fit beside the nameplate and, if given, the simulated rig's truth."""
    header = ["parameter", "identified ± 1 σ", "95 %", "nameplate", "difference"]
    header += ["simulated rig", "error", "error in σ"] if truth else []
    rows = [_estimate_row(e, truth) for e in fit.estimates]
    low, high = (speed * RPM for speed in fit.band)
    caption = f"Fit, {fit.name}: {low:.0f} to {high:.0f} rpm"
    marked = [i for i, e in enumerate(fit.estimates) if not is_determined(e)]
    remarks = any(row[-1] for row in rows)  # a column of nothing is left out
    return table(
        caption,
        [*header, "remark"] if remarks else header,
        [row if remarks else row[:-1] for row in rows],
        marked=marked,
    )


def _estimate_row(estimate: Estimate, truth: Mapping[str, float] | None) -> list[str]:
    cells = [long_name(estimate.name), estimate_text(estimate), interval_text(estimate) or "–"]
    cells += [quantity_text(estimate.nameplate, estimate.unit), change_text(estimate, estimate.nameplate)]
    if truth:
        actual = truth.get(estimate.name, math.nan)
        cells += [
            quantity_text(actual, estimate.unit),
            change_text(estimate, actual),
            change_in_sigmas(estimate, actual),
        ]
    return [*cells, bound_text(estimate) or ("" if is_determined(estimate) else "insensitive: barely affects the fit")]


def _search(fit: Fit) -> str:
    """Return the significant minima of the search beside the refined values, what it did and where it looked."""
    units = [fit.estimate(name).unit for name in fit.unknowns]
    rows = [
        [f"minimum {i}", f"{optimum.cost:.5g}", *map(quantity_text, optimum.theta, units)]
        for i, optimum in enumerate(fit.optima, start=1)
    ]
    refined = [fit.estimate(name).value for name in fit.unknowns]
    rows.append(["refined", "–", *map(quantity_text, refined, units)])
    figure = search_map(fit)
    drawn = "Evaluated points, best of each cluster, minima and refined values, over two unknowns at a time"
    return details(
        "Global search: its minima, its stages and where it looked",
        paragraph(search_line(fit), stages_text(fit)),
        table(f"Significant minima of {fit.objective}", ["", fit.objective, *fit.unknowns], rows),
        plot("search-map", figure, caption=drawn, label=drawn) if figure else "",
    )


def _limits(fit: Fit) -> str:
    """Return the uncertainty budget of each estimate."""
    causes = list(next(iter(fit.budget.values())))
    rows = [[name, *(f"{100 * shares[cause]:.0f} %" for cause in causes)] for name, shares in fit.budget.items()]
    return details(
        "Uncertainty budget: noise and nameplate tolerances",
        table("Shares of the variance of each value", ["parameter", *causes], rows),
    )


def _nuisances(fit: Fit) -> str:
    """Return the nuisance parameters, adjusted within the nameplate's tolerance."""
    rows = [[long_name(e.name), estimate_text(e), _pull(e)] for e in fit.nuisances]
    caption = "Deviations from the nameplate, adjusted within its tolerance"
    return details(
        f"Nameplate deviations adjusted by the fit ({len(rows)})",
        table(caption, ["quantity", "deviation ± 1 σ", "pull"], rows),
    )


def _pull(estimate: Estimate) -> str:
    return f"{estimate.pull:+.1f} σ" if math.isfinite(estimate.pull) else "–"


_WRONG_MODEL = (
    "These values belong to a model that does not describe the run: "
    "they may be biased by far more than their standard deviations."
)
_PLUS_MINUS = "± is one standard deviation, assuming this model; bias from effects it lacks is not included."
