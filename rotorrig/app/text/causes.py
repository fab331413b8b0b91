"""What a diagnosis found beyond its verdict, in words that terminal, report and viewer share."""

import math
from collections.abc import Iterator

from rotorrig.app.text.quantities import plus_minus_of, shown, unit_of
from rotorrig.identify import Diagnosis
from rotorrig.identify.verdict import VERDICT, Cause, HiddenEffect
from rotorrig.rig.config import UM

LISTED = 8  # causes in a table


def listed(found: Diagnosis) -> tuple[Cause, ...]:
    """Return the causes worth a line: the chosen ones, the tied ones and the next best."""
    tied = {label for group in found.tied for label in group}
    return tuple(cause for i, cause in enumerate(found.causes) if cause.chosen or cause.label in tied or i < LISTED)


def size(cause: Cause) -> str:
    """Return the figures of a cause: "18.0 ± 0.3 µm at 110 ± 2°", with their names where there are several."""
    figures = {name: plus_minus_of(f.value, f.sigma, f.unit) for name, f in cause.parameters.items()}
    angles = {name: figures.pop(f"{name} angle") for name in cause.parameters if f"{name} angle" in figures}
    said = {name: f"{words} at {angles[name]}" if name in angles else words for name, words in figures.items()}
    return ", ".join(f"{name} {words}" if len(said) > 1 else words for name, words in said.items())


def evidence(cause: Cause) -> str:
    """Return what speaks for a cause, "≥ 120" where its fit was given up."""
    return f"{'≥ ' if cause.given_up else ''}{cause.evidence:.0f}"


def heldout(cause: Cause) -> str:
    """Return the prediction error on held-out data, before and after: "12.3 → 0.410 µm"."""
    if not (math.isfinite(cause.heldout_before) and math.isfinite(cause.heldout_after)):
        return "–"
    before, after = (f"{error * UM:#.3g}".rstrip(".") for error in (cause.heldout_before, cause.heldout_after))
    return f"{before} → {after} µm"


def standing(cause: Cause, found: Diagnosis) -> str:
    """Return what became of a cause: "in the model", "tied", "not plausible" or nothing."""
    tied = any(cause.label in group for group in found.tied)
    said = ["in the model"] if cause.chosen else []
    said += ["tied"] if tied else []
    said += [] if cause.plausible else ["not plausible"]
    return ", ".join(said)


def ties(found: Diagnosis) -> list[str]:
    """Return a sentence for every set of causes the data cannot separate."""
    return [f"Tied: {'; '.join(group)}. This data cannot tell them apart." for group in found.tied]


def next_run(found: Diagnosis) -> str:
    """Return the run that would tell more, as a sentence; empty if none is known."""
    run = found.next_run
    if run is None or not math.isfinite(run.lam):
        return run.words if run else ""
    return f"{run.words} Expected separation: {run.lam:.3g} in chi2, where {VERDICT.nameable:g} names a cause."


def gain(found: Diagnosis) -> str:
    """Return what the extended model bought, as a sentence; empty if nothing was measured."""
    bought = found.gain
    if bought is None or not (math.isfinite(bought.heldout_before) and math.isfinite(bought.heldout_after)):
        return ""
    said = f"On data no fit saw ({bought.on}), the prediction error goes"
    said += f" from {bought.heldout_before * UM:.3g} to {bought.heldout_after * UM:.3g} µm"
    if bought.noise_floor > 0:
        said += f", {bought.over_noise_floor:.2f} times the noise floor of {bought.noise_floor * UM:.2g} µm"
    return said + "."


def absorbed(found: Diagnosis) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, value before, value after and change in sigmas of every base parameter that the extension moved."""
    for name, shift in found.gain.base.items() if found.gain else ():
        if not (math.isfinite(shift.before) and math.isfinite(shift.after)):
            continue
        unit = unit_of(name)
        change = shift.after - shift.before
        change = math.remainder(change, math.tau) if unit == "rad" else change
        known = shift.sigma > 0 and math.isfinite(shift.sigma)
        moved = f"{change / shift.sigma:+.1f} σ" if known else "–"
        yield (
            name,
            shown(shift.before, unit),
            plus_minus_of(shift.after, shift.sigma if known else math.nan, unit),
            moved,
        )


def hidden(effect: HiddenEffect) -> str:
    """Return one effect this data would not show, with the size that would and the measurement that is missing."""
    said = "would not show at any size"
    if math.isfinite(effect.smallest):
        said = f"would show from {shown(float(f'{effect.smallest:.2g}'), effect.unit)} on"
    missing = f"; what is missing is {effect.missing}" if effect.missing else ""
    return f"{effect.effect}: {said}{missing}"


def not_seen(found: Diagnosis) -> str:
    """Return which effects this data would not show, in one sentence; empty if it would show all."""
    names = [effect.effect for effect in found.hidden]
    return f"At their typical size this data would not show: {'; '.join(names)}." if names else ""


def untold(found: Diagnosis) -> list[str]:
    """Return a sentence for every effect this data would not show."""
    return [hidden(effect) for effect in found.hidden]
