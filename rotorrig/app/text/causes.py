"""Causes, cross-validation, ties and hidden effects of a diagnosis as text, for terminal, report and viewer."""

import math
from collections.abc import Iterator

from rotorrig.app.text.amplitude_units import AS_STATED, AmplitudeUnit
from rotorrig.app.text.nameplate import off_text
from rotorrig.app.text.quantities import quantity_text, quantity_with_sigma, unit_of, without_sigma
from rotorrig.identify import Diagnosis
from rotorrig.identify.verdict import VERDICT, Cause, HiddenEffect, ParameterValue
from rotorrig.rig.config import UM

LISTED = 8  # causes in a table
CAUSES_TITLE = "Causes tried: in the model first, then by evidence"


def causes_to_list(diagnosis: Diagnosis) -> tuple[Cause, ...]:
    """Return the causes worth a line: the chosen ones, the tied ones and the next best."""
    tied = {label for group in diagnosis.tied for label in group}
    return tuple(cause for i, cause in enumerate(diagnosis.causes) if cause.chosen or cause.label in tied or i < LISTED)


def cause_size(cause: Cause, *, coarse: bool = False) -> str:
    """Return the estimated parameters of a cause: "18.0 ± 0.3 µm at 110 ± 2°", named where there are several.

    A size that no rig has is that of a misfit, not of the cause: "–". A `coarse` one is without its sigma and
    has no digit beyond the first of that; ratios are in percent.
    """
    if not cause.plausible:
        return "–"
    found = cause.parameters.items()
    if cause.nameplate:
        return ", ".join(off_text(f.value, f.sigma, f.unit) for f in cause.parameters.values())
    values = {name: _coarse(f) if coarse else quantity_with_sigma(f.value, f.sigma, f.unit) for name, f in found}
    angles = {name: values.pop(f"{name} angle") for name in cause.parameters if f"{name} angle" in values}
    phasors = {name: f"{value} at {angles[name]}" if name in angles else value for name, value in values.items()}
    return ", ".join(f"{name} {value}" if len(phasors) > 1 else value for name, value in phasors.items())


def _coarse(value: ParameterValue) -> str:
    """Return a parameter for a headline.

    >>> _coarse(ParameterValue(value=1.65e-5, unit="m", sigma=2.2e-6))
    '16 µm'
    >>> _coarse(ParameterValue(value=0.0312, unit="", sigma=0.002))
    '3.1 %'
    """
    factor, unit = (1.0, value.unit) if value.unit else (100.0, "%")
    return without_sigma(quantity_with_sigma(factor * value.value, factor * 10 * value.sigma, unit))


def cause_evidence(cause: Cause) -> str:
    """Return the gain in BIC, "≥ 120" where the fit was stopped early."""
    return f"{'≥ ' if cause.given_up else ''}{cause.evidence:.0f}"


def cause_prediction_error(cause: Cause, unit: AmplitudeUnit = AS_STATED) -> str:
    """Return the cross-validation error without and with the cause, in a unit: "12.3 → 0.410"."""
    if not (math.isfinite(cause.heldout_before) and math.isfinite(cause.heldout_after)):
        return "–"
    before, after = (f"{error * unit.by:#.3g}".rstrip(".") for error in (cause.heldout_before, cause.heldout_after))
    return f"{before} → {after}"


def cause_status(cause: Cause, diagnosis: Diagnosis) -> str:
    """Return "in the model", "config wrong", "tied", "not plausible", or nothing for a rejected cause."""
    tied = any(cause.label in group for group in diagnosis.tied)
    status = ["config wrong" if cause.nameplate else "in the model"] if cause.chosen else []
    status += ["tied"] if tied else []
    status += [] if cause.plausible else ["not plausible"]
    return ", ".join(status)


def tie_sentences(diagnosis: Diagnosis) -> list[str]:
    """Return a sentence for every set of causes the data cannot separate."""
    return [f"Tied: {'; '.join(group)}. This data cannot separate them." for group in diagnosis.tied]


def next_run_sentence(diagnosis: Diagnosis) -> str:
    """Return the run that would tell more, or why there is none; empty if nothing is open."""
    run = diagnosis.next_run
    if run is None:
        return ""
    words = [run.words]
    if math.isfinite(run.minutes):
        words.append(f"It takes about {max(1, round(run.minutes))} min, hands included.")
    if math.isfinite(run.lam):
        words.append(f"Expected separation: {run.lam:.3g} in chi2, where {VERDICT.nameable:g} names a cause.")
    if math.isfinite(run.share_of_limit):
        how = "may come near the limit: below" if run.share_of_limit > VERDICT.of_limit else "stays below"
        words.append(f"Its vibration {how} {100 * run.share_of_limit:.0f} % of the limit, with 95 % probability.")
    return " ".join(words)


def gain_sentence(diagnosis: Diagnosis) -> str:
    """Return the cross-validation error of base and extended model; empty if it was not measured."""
    gain = diagnosis.gain
    if gain is None or not (math.isfinite(gain.heldout_before) and math.isfinite(gain.heldout_after)):
        return ""
    sentence = f"On unseen data ({gain.on}), the prediction error goes"
    sentence += f" from {gain.heldout_before * UM:.3g} to {gain.heldout_after * UM:.3g} µm 0-peak"
    if gain.noise_floor > 0:
        sentence += f", {gain.over_noise_floor:.2f} times the noise floor of {gain.noise_floor * UM:.2g} µm 0-peak"
    return sentence + "."


def parameter_shifts(diagnosis: Diagnosis) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, value before, value after and shift in sigmas of every base parameter moved by the extension."""
    for name, shift in diagnosis.gain.base.items() if diagnosis.gain else ():
        if not (math.isfinite(shift.before) and math.isfinite(shift.after)):
            continue
        unit = unit_of(name)
        difference = shift.after - shift.before
        difference = math.remainder(difference, math.tau) if unit == "rad" else difference
        sigma = shift.sigma if shift.sigma > 0 and math.isfinite(shift.sigma) else math.nan
        sigmas = "–" if math.isnan(sigma) else f"{difference / sigma:+.1f} σ"
        yield name, quantity_text(shift.before, unit), quantity_with_sigma(shift.after, sigma, unit), sigmas


def hidden_effect_text(effect: HiddenEffect) -> str:
    """Return an effect below the detection limit of this data, with that limit and the measurement needed."""
    limit = "not detectable at any size"
    if math.isfinite(effect.smallest):
        limit = f"detectable from {quantity_text(float(f'{effect.smallest:.2g}'), effect.unit)}"
    return f"{effect.effect}: {limit}" + (f"; needs {effect.missing}" if effect.missing else "")


def hidden_effects_sentence(diagnosis: Diagnosis) -> str:
    """Return the effects this data would not show at their typical size; empty if it would show all."""
    names = [effect.effect for effect in diagnosis.hidden]
    return f"At their typical size this data would not show: {'; '.join(names)}." if names else ""


def hidden_effect_lines(diagnosis: Diagnosis) -> list[str]:
    """Return a line for every effect below the detection limit of this data."""
    return [hidden_effect_text(effect) for effect in diagnosis.hidden]
