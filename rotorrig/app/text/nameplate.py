"""The config against a fit: pulled groups, found values beside stated ones, and the misfit of a fit."""

import math
from collections.abc import Iterator

from rotorrig.app.text.quantities import p_value_text, quantity_with_sigma
from rotorrig.identify import Deviation, Fit, NameplateCheck

PULLED = 2.0  # sigmas: a group that the fit pulls less is not worth a line
#: SI unit of a config's statement -> (unit shown, factor), where it is another than a result's
STATED = {"m": ("mm", 1e3), "V/m": ("mV/µm", 1e-3)}
IMPOSSIBLE = "none that can be"
NOTHING_PULLED = f"The fit pulls at nothing the config states by more than {PULLED:g} sigma."


def pull_rows(check: NameplateCheck) -> Iterator[tuple[str, str, str, str]]:
    """Yield a pulled group, what in it is pulled most, its value in the config and by the data alone, and the pull."""
    for pull in check.pulls:
        if pull.sigmas > PULLED and pull.deviations:
            most = pull.deviations[0]
            yield most.title, stated_text(most), found_text(most), f"{pull.sigmas:.1f} σ ({pull.group})"


def finding_sentences(check: NameplateCheck) -> list[str]:
    """Return what the data contradict in the config, a sentence each."""
    return [f"{finding.words[:1].upper()}{finding.words[1:]}." for finding in check.findings]


def stated_text(deviation: Deviation) -> str:
    """Return what the config states; a dash where that is no single number."""
    return _stated(deviation.nameplate, math.inf, deviation.nameplate_unit)


def found_text(deviation: Deviation) -> str:
    """Return the value by the data alone ± 1 sigma: that of the part, or how far it is off where none is stated.

    A fit that something else pulls at may ask for a stiffness or a length of less than nothing, which is not shown.
    """
    nameplate, value, sigma = deviation.nameplate, deviation.value, deviation.sigma
    if math.isfinite(nameplate):
        scale = 1.0 if deviation.unit else nameplate
        if nameplate > 0 >= nameplate + scale * value and deviation.nameplate_unit != "rad":
            return IMPOSSIBLE
        return _stated(nameplate + scale * value, abs(scale) * sigma, deviation.nameplate_unit)
    return off_text(value, sigma, deviation.unit)


def off_text(value: float, sigma: float, unit: str) -> str:
    """Return how far a statement is off.

    >>> off_text(2.1e-3, 2e-4, "m"), off_text(-0.04, 0.005, "")
    ('+2.10 ± 0.20 mm', '-4.00 ± 0.50 %')
    """
    sign = "+" if value >= 0 else ""
    return sign + (_stated(value, sigma, unit) if unit else quantity_with_sigma(100 * value, 100 * sigma, "%"))


def misfit_sentence(fit: Fit) -> str:
    """Return the misfit of a fit, and what to do if it is poor."""
    ratio = fit.chi2 / fit.dof if fit.dof > 0 else math.nan
    misfit = f"Misfit: chi2 {fit.chi2:.5g} over {fit.dof} degrees of freedom, {ratio:.3g}"
    if not math.isfinite(fit.p):
        return f"{misfit}."
    scatter = f"1X residuals are {fit.scatter_ratio:.3g} times their scatter from row to row ({p_value_text(fit.p)})"
    if fit.adequate:
        return f"{misfit}; {scatter}."
    return (
        f"The fit is poor: {scatter}, so the values may be wrong by more than they say. Run rotor diagnose. {misfit}."
    )


def _stated(value: float, sigma: float, unit: str) -> str:
    shown, factor = STATED.get(unit, (unit, 1.0))
    return quantity_with_sigma(value * factor, sigma * factor, shown)
