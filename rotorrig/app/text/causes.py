"""What a diagnosis found beyond its verdict, in words that terminal, report and viewer share."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from rotorrig.app.text.quantities import plus_minus_of, shown, unit_of
from rotorrig.identify import Diagnosis
from rotorrig.identify.verdict import NAMEABLE, Cause
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
    words = str(found.next_run.get("words", ""))
    separation = _finite(found.next_run.get("lam"))
    if words and separation is not None:
        words += f" Expected separation: {separation:.3g} in chi2, where {NAMEABLE:g} names a cause."
    return words


def gain(found: Diagnosis) -> str:
    """Return what the extended model bought, as a sentence; empty if nothing was measured."""
    before, after, floor, ratio = (
        _finite(found.gain.get(key)) for key in ("heldout_before", "heldout_after", "noise_floor", "over_noise_floor")
    )
    if before is None or after is None:
        return ""
    on = found.gain.get("on")
    said = f"On data no fit saw{f' ({on})' if on else ''}, the prediction error goes"
    said += f" from {before * UM:.3g} to {after * UM:.3g} µm"
    if floor is not None and ratio is not None:
        said += f", {ratio:.2f} times the noise floor of {floor * UM:.2g} µm"
    return said + "."


def absorbed(found: Diagnosis) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, value before, value after and change in sigmas of every base parameter that the extension moved."""
    for name, values in found.gain.get("base", {}).items():
        before, after, sigma = (_finite(values.get(key)) for key in ("before", "after", "sigma"))
        if before is None or after is None:
            continue
        unit = unit_of(name)
        change = math.remainder(after - before, math.tau) if unit == "rad" else after - before
        moved = f"{change / sigma:+.1f} σ" if sigma else "–"
        yield name, shown(before, unit), plus_minus_of(after, sigma or math.nan, unit), moved


def hidden(entry: Mapping[str, Any]) -> str:
    """Return one effect this data would not show, with the size that would and the measurement that is missing."""
    said = f"{entry.get('effect', 'an effect')}: "
    smallest = _finite(entry.get("smallest"))
    unit = str(entry.get("unit", ""))
    said += (
        f"would show from {shown(float(f'{smallest:.2g}'), unit)} on"
        if smallest is not None
        else "would not show at any size"
    )
    missing = entry.get("missing")
    return said + (f"; what is missing is {missing}" if missing else "")


def not_seen(found: Diagnosis) -> str:
    """Return which effects this data would not show, in one sentence; empty if it would show all."""
    names = [str(entry.get("effect", "")) for entry in found.hidden]
    return f"At their typical size this data would not show: {'; '.join(names)}." if names else ""


def untold(found: Diagnosis) -> list[str]:
    """Return a sentence for every effect this data would not show."""
    return [hidden(entry) for entry in found.hidden]


def _finite(value: object) -> float | None:
    return float(value) if isinstance(value, (int, float)) and math.isfinite(value) else None
