"""Balancing in words: corrections, what of them is known, what the next run will show.

Angles are from the keyphasor mark in the sense of rotation, and beside it against it; amplitudes are in a unit of
AMPLITUDE_UNITS, µm 0-peak unless another is asked for.
"""

import math
from dataclasses import dataclass

import numpy as np

from rotorrig.app.text.amplitude_units import AMPLITUDE_UNITS, amplitude_factor
from rotorrig.balancing import Balance, Combination, Correction, Prediction
from rotorrig.rig.config import RPM

GMM = 1e6  # g mm per kg m
CONVENTION = "masses to add; angles from the keyphasor mark in the sense of rotation; ± is half the 95 % interval"


@dataclass(frozen=True, slots=True, kw_only=True)
class Highest:
    """The largest amplitude a probe showed and will show, in text."""

    probe: str
    before: str
    after: str
    band: str


def correction_rows(balance: Balance) -> list[tuple[str, ...]]:
    """Return plane, method, amount, mass at the radius, angle, and angle against the rotation, of every correction."""
    rows: list[tuple[str, ...]] = []
    for i, plane in enumerate(balance.planes):
        shown = [*balance.corrections, *([_named(balance.chosen, "without what is not known")] * balance.left_out)]
        for correction in shown:
            rows.append((plane, correction.by, *_amounts(correction, i, balance.radii.get(plane))))
        if balance.min_max is not None:
            w = complex(balance.min_max[i])
            rows.append((plane, "min-max", *_plain(w, balance.radii.get(plane))))
    return rows


def _named(correction: Correction, by: str) -> Correction:
    return Correction(
        by=by, planes=correction.planes, W=correction.W, covariance=correction.covariance, dof=correction.dof
    )


def _amounts(correction: Correction, i: int, radius: float | None) -> tuple[str, str, str, str]:
    w, (amount, angle) = complex(correction.W[i]), correction.half_widths[i]
    turned = f"{angle_text(w)} ± {math.degrees(angle):.2g}°" if math.isfinite(angle) else "any angle"
    mass = f"{_with(abs(w) / radius * 1e3, amount / radius * 1e3)} g" if radius else "–"
    return f"{_with(abs(w) * GMM, amount * GMM)} g mm", mass, turned, angle_text(w.conjugate())


def _plain(w: complex, radius: float | None) -> tuple[str, str, str, str]:
    mass = f"{abs(w) / radius * 1e3:.4g} g" if radius else "–"
    return f"{abs(w) * GMM:.4g} g mm", mass, angle_text(w), angle_text(w.conjugate())


def _with(value: float, half: float) -> str:
    """Return a value and half its interval, to two digits of that.

    >>> _with(10.9963, 0.1296)
    '11.00 ± 0.13'
    """
    if not (half > 0 and math.isfinite(half)):
        return f"{value:.4g}"
    decimals = max(0, 1 - math.floor(math.log10(half)))
    return f"{value:.{decimals}f} ± {half:.{decimals}f}"


def angle_text(w: complex) -> str:
    """Return the angle of a mass from the mark in degrees, 0 to 360.

    >>> angle_text(-1j)
    '270.0°'
    """
    degrees = round(math.degrees(math.atan2(w.imag, w.real)) % 360.0, 1) % 360.0
    return f"{degrees:.1f}°"


def mass_text(plane: str, w: complex) -> str:
    """Return a mass as `--trial` reads it.

    >>> mass_text("disk", 12e-6j)
    'disk: 12 g mm at 90.0 deg'
    """
    return f"{plane}: {abs(w) * GMM:.4g} g mm at {angle_text(w).removesuffix('°')} deg"


def hole_lines(balance: Balance) -> list[str]:
    """Return what goes into which hole, plane by plane."""
    if not balance.placing:
        return []
    lines = []
    for plane, filled, w in zip(balance.planes, balance.placing.filled, balance.placing.W, strict=True):
        holes = " and ".join(f"{mass * 1e3:.4g} g into hole {hole}" for hole, mass in filled) or "nothing"
        lines.append(f"{plane}: {holes} ({abs(w) * GMM:.4g} g mm at {angle_text(complex(w))})")
    return lines


def known_sentences(balance: Balance) -> list[str]:
    """Return what the intervals rest on, how the methods agree, and what of the correction is not determined."""
    sentences = []
    if balance.conditions:
        sentences.append(_scatter_sentence(balance))
    if not balance.compensated:
        sentences.append("There is no slow roll: runout is balanced as if it were vibration.")
    if len(balance.corrections) > 1:
        sentences.append(_agreement_sentence(balance))
    determinacy = balance.determinacy
    if len(balance.planes) > 1:
        sentences.append(f"Condition number of the influence coefficients: {determinacy.condition:.3g}.")
    if determinacy.alike:
        sentences.append(_alike_sentence(balance))
    return sentences


def _scatter_sentence(balance: Balance) -> str:
    number = len(balance.conditions)
    if math.isfinite(balance.dof):
        return f"Intervals are from the scatter of {number} conditions, {balance.dof:.0f} degrees of freedom."
    return (
        f"{number} conditions leave none to show how well the rig repeats: intervals rest on the rows' noise and on "
        f"repeatability in the config's [prior]; repeat a run, newly mounted, to measure it."
    )


def _agreement_sentence(balance: Balance) -> str:
    if balance.disagreement <= 1:
        return (
            "Influence coefficients and fitted model agree; they are combined by their covariances (covariance "
            "intersection, as both have runs in common)."
        )
    return (
        f"Influence coefficients and fitted model DISAGREE, {balance.disagreement:.1f} times the 95 % limit: a mark, a "
        f"scale of angles or the model is off. The influence coefficients are used."
    )


def _alike_sentence(balance: Balance) -> str:
    determinacy, planes = balance.determinacy, balance.planes
    known, weak = (_combination_text(c, planes) for c in (determinacy.best, determinacy.worst))
    ending = (
        "It is within its error of zero, and left out of the masses to mount."
        if balance.left_out
        else "It is needed beyond doubt, and kept."
    )
    return (
        f"The planes move the probes nearly alike. Well known is {known}: {_amount_text(determinacy.best)}. "
        f"Ill-determined is {weak}: {_amount_text(determinacy.worst)}; it moves the probes "
        f"{determinacy.condition:.0f} times less. {ending}"
    )


def _amount_text(combination: Combination) -> str:
    return f"{_digits(abs(combination.amount) * GMM)} ± {_digits(combination.sigma * GMM, 2)} g mm (1 sigma)"


def _digits(value: float, digits: int = 3) -> str:
    """Return a number with so many significant digits; 1230, not 1.23e+03."""
    return f"{float(f'{value:.{digits}g}'):g}"


def _combination_text(combination: Combination, planes: tuple[str, ...]) -> str:
    """Return "1.00 on disk 1 with 0.98 on disk 2 at 180 deg to it"."""
    order = np.argsort(-np.abs(combination.weights))
    first, *others = (int(i) for i in order)
    size = abs(combination.weights[first])
    parts = [
        f"{abs(w) / size:.2f} on {planes[i]} at {math.degrees(np.angle(w)):.0f}° to it"
        for i in others
        if abs(w := complex(combination.weights[i])) > 0.005 * size
    ]
    return " with ".join([f"1 on {planes[first]}", *parts])


def highest_rows(prediction: Prediction, unit: str = AMPLITUDE_UNITS[0]) -> list[Highest]:
    """Return the largest amplitudes before and after, probe by probe, with the band and the speed."""
    factor = amplitude_factor(unit)
    low, high = (factor * edge for edge in prediction.band)
    before, after = (factor * np.abs(z) for z in (prediction.before, prediction.after))
    rows = []
    for i, name in enumerate(prediction.probes):
        mine = np.flatnonzero(prediction.probe == i)
        if mine.size:
            b, a = (int(mine[np.argmax(values[mine])]) for values in (before, after))
            rows.append(
                Highest(
                    probe=name,
                    before=f"{_digits(before[b])} at {prediction.omega[b] * RPM:.0f} rpm",
                    after=f"{_digits(after[a])} at {prediction.omega[a] * RPM:.0f} rpm",
                    band=f"{_digits(low[a])} to {_digits(high[a])}",
                )
            )
    return rows


def mounted_sentence(balance: Balance) -> str:
    """Return what the prediction is of, and by which method."""
    masses = "; ".join(mass_text(p, complex(w)) for p, w in zip(balance.planes, balance.mounted, strict=True))
    return f"Predicted by the {balance.by}, with {masses}."


def grade_sentence(balance: Balance) -> str:
    """Return the balance quality grade and what it was reckoned from."""
    grade = balance.grade
    met = f"G {grade.grade:g}" if math.isfinite(grade.grade) else "no grade"
    return (
        f"ISO 21940-11: {met}, as at most {grade.unbalance * GMM:.3g} g mm (95 %) of the correction are left undone; "
        f"rotor {grade.mass:.3g} kg by the config, top speed {grade.top_speed * RPM:.0f} rpm, e omega = "
        f"{grade.product:.2g} mm/s. The grade is for a rotor below its first critical speed."
    )


def comparison_sentence(balance: Balance) -> str:
    """Return how a run with the masses on compares with its prediction; empty without one."""
    compared = balance.comparison
    if compared is None:
        return ""
    inside, number = int(compared.inside.sum()), len(compared.inside)
    where = ""
    if inside < number:
        worst = int(np.argmax(compared.distance))
        where = (
            f"; furthest {compared.prediction.probes[compared.prediction.probe[worst]]} at "
            f"{compared.prediction.omega[worst] * RPM:.0f} rpm, {compared.distance[worst]:.1f} times the edge"
        )
    share = f"{inside} of {number} vectors ({100 * compared.share:.0f} %)"
    return f"The run after is inside the 95 % region at {share}{where}."


def comparison_rows(balance: Balance, unit: str = AMPLITUDE_UNITS[0]) -> list[tuple[str, str, str, str]]:
    """Return probe, vectors inside, largest amplitude measured and predicted."""
    compared = balance.comparison
    if compared is None:
        return []
    rows = []
    for i, name in enumerate(compared.prediction.probes):
        mine = compared.prediction.probe == i
        if mine.any():
            both = compared.measured, compared.prediction.after
            largest = [float(np.abs(z[mine]).max()) * amplitude_factor(unit) for z in both]
            rows.append(
                (name, f"{compared.inside[mine].sum()} of {mine.sum()}", f"{largest[0]:.3g}", f"{largest[1]:.3g}")
            )
    return rows
