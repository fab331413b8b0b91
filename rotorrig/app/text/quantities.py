"""SI values in display units (kN/m, g mm, degrees), rounded to their uncertainty."""

import math
import re

from rotorrig.identify import Estimate
from rotorrig.rig.config import RPM, Bearing, OverSpeed

#: SI unit -> (unit shown, factor)
SHOWN = {
    "N/m": ("kN/m", 1e-3),
    "N s/m": ("N s/m", 1.0),
    "kg m": ("g mm", 1e6),
    "rad": ("°", 180.0 / math.pi),
    "rad/s": ("rpm", RPM),
    "m": ("µm", 1e6),
    "Pa": ("GPa", 1e-9),
    "kg/m^3": ("kg/m³", 1.0),
    "kg m^2": ("kg mm²", 1e6),
    "N/m^3": ("N/mm³", 1e-9),
    "s": ("µs", 1e6),
    "": ("", 1.0),
}
#: what is larger than the usual, in SI: from where on, and in which unit
LARGER = {"s": (0.1, ("s", 1.0)), "m": (5e-3, ("mm", 1e3))}
#: meaning of an estimate's short name
LONG = {
    "kxx": "stiffness, horizontal",
    "kyy": "stiffness, vertical",
    "cxx": "damping, horizontal",
    "cyy": "damping, vertical",
    "kxy": "cross stiffness, force on x by motion along y",
    "kyx": "cross stiffness, force on y by motion along x",
    "cxy": "cross damping, force on x by velocity along y",
    "cyx": "cross damping, force on y by velocity along x",
    "u": "unbalance",
    "phase": "unbalance angle from the keyphasor mark",
    "E": "Young's modulus",
    "density": "density of the shaft",
    "disk mass": "disk mass",
}
UNITS = {
    "k": "N/m",
    "c": "N s/m",
    "u": "kg m",
    "phase": "rad",
    "E": "Pa",
    "density": "kg/m^3",
}  # by name, or its letter
NEAR_BOUND = 1e-3  # relative: closer than this, an estimate is at its bound
UNDETERMINED = "not determined by this data"


def quantity_text(value: float, unit: str) -> str:
    """Return `value` [SI] in its display unit, rounded to four digits.

    >>> quantity_text(33912.7, "N/m"), quantity_text(1.5e-5, "kg m"), quantity_text(math.nan, "N/m")
    ('33.91 kN/m', '15 g mm', '–')
    """
    if not math.isfinite(value):
        return "–"
    name, factor = _display_unit(unit, value)
    gap = "" if name in ("", "°") else " "
    return f"{_round(value * factor, math.nan)}{gap}{name}"


def estimate_text(estimate: Estimate) -> str:
    """Return "33.91 ± 0.12 kN/m", or UNDETERMINED."""
    if not is_determined(estimate):
        return UNDETERMINED
    if estimate.unit == "" and estimate.nameplate == 0:  # a relative deviation from the nameplate
        return quantity_with_sigma(100 * estimate.value, 100 * estimate.sigma, "%")
    return quantity_with_sigma(estimate.value, estimate.sigma, estimate.unit)


def quantity_with_sigma(value: float, sigma: float, unit: str) -> str:
    """Return `value` ± `sigma` [SI] in its display unit; without a finite sigma the value alone.

    >>> quantity_with_sigma(1.8e-5, 3e-7, "m"), quantity_with_sigma(-0.5, math.inf, "rad")
    ('18.00 ± 0.30 µm', '-28.65°')
    >>> quantity_with_sigma(22.51981, 1.4e-5, "s"), quantity_with_sigma(-4e-3, 1.6e-2, "m")
    ('22.519810 ± 0.000014 s', '-4 ± 16 mm')
    """
    if not (math.isfinite(sigma) and sigma > 0):
        return quantity_text(value, unit)
    name, factor = _display_unit(unit, max(abs(value), sigma))
    gap = "" if name == "°" else " "
    return f"{_round(value * factor, sigma * factor)} ± {_round(sigma * factor, sigma * factor)}{gap}{name}".rstrip()


def without_sigma(text: str) -> str:
    """Return a text of values without their uncertainties.

    >>> without_sigma("sits 2.10 ± 0.20 mm further")
    'sits 2.10 mm further'
    """
    return re.sub(r" ± [\d.]+", "", text)


def _display_unit(unit: str, size: float) -> tuple[str, float]:
    """Return the unit in which a quantity of this size [SI] is shown, and the factor to it."""
    least, larger = LARGER.get(unit, (math.inf, (unit, 1.0)))
    return larger if abs(size) >= least else SHOWN.get(unit, (unit, 1.0))


def interval_text(estimate: Estimate, *, unit: bool = True) -> str:
    """Return the 95 % interval, one-sided if it reaches a bound; empty if unknown or reaching both bounds.

    >>> from dataclasses import replace
    >>> c = Estimate(name="cxx", value=1.0, sigma=math.inf, unit="N s/m", nameplate=math.nan, bounds=(1.0, 1e3))
    >>> interval_text(replace(c, interval=(1.0, 2.816))), interval_text(replace(c, interval=(1.2, 2.8163)), unit=False)
    ('below 2.82 N s/m', '1.20 to 2.82')
    """
    if estimate.interval is None:
        return ""
    low, high = estimate.interval
    lowest, highest = estimate.bounds or (0.0 if estimate.name.split()[0] == "u" else -math.inf, math.inf)
    from_bound, to_bound = (math.isclose(*ends, rel_tol=NEAR_BOUND) for ends in ((low, lowest), (high, highest)))
    if from_bound and to_bound:
        return ""
    name, factor = SHOWN.get(estimate.unit, (estimate.unit, 1.0))
    first, last = (_round(factor * end, factor * min((high - low) / 4, abs(end) / 3)) for end in (low, high))
    words = f"below {last}" if from_bound else f"above {first}" if to_bound else f"{first} to {last}"
    gap = "" if name == "°" else " "
    return f"{words}{gap}{name}".rstrip() if unit else words


def is_determined(estimate: Estimate) -> bool:
    """Return whether the data determine the estimate."""
    return estimate.determined and math.isfinite(estimate.sigma) and math.isfinite(estimate.value)


def difference(estimate: Estimate, reference: float) -> float:
    """Return estimate less `reference` [SI]; angles the short way round.

    >>> e = Estimate(name="phase", value=3.1, sigma=0.1, unit="rad", nameplate=0.0)
    >>> round(difference(e, -3.1), 3)
    -0.083
    """
    gap = estimate.value - reference
    return math.remainder(gap, 2 * math.pi) if estimate.unit == "rad" else gap


def change_text(estimate: Estimate, reference: float) -> str:
    """Return the difference from `reference` in %, in degrees for an angle; "–" where there is none to state.

    >>> change_text(Estimate(name="kxx", value=33.0e3, sigma=1e3, unit="N/m", nameplate=30.0e3), 30.0e3)
    '+10.0 %'
    """
    if not (is_determined(estimate) and math.isfinite(reference)):
        return "–"
    gap = difference(estimate, reference)
    if estimate.unit == "rad":
        return f"{math.degrees(gap):+.1f}°"
    return f"{100 * gap / reference:+.1f} %" if reference else "–"


def change_in_sigmas(estimate: Estimate, reference: float) -> str:
    """Return the difference from `reference` in standard deviations of the estimate."""
    if not (is_determined(estimate) and math.isfinite(reference) and estimate.sigma > 0):
        return "–"
    return f"{difference(estimate, reference) / estimate.sigma:+.1f} σ"


def long_name(name: str) -> str:
    """Return an estimate's name with its meaning.

    >>> long_name("spring kxx"), long_name("u disk 2")
    ('spring kxx, stiffness, horizontal', 'u disk 2, unbalance')
    """
    for key in (name, name.split()[0], name.split()[-1]):  # a bearing stands before its quantity, a disk behind
        if key in LONG:
            return f"{name}, {LONG[key]}"
    return name


def unit_of(name: str) -> str:
    """Return the SI unit of an estimate by its name; empty for a ratio.

    >>> unit_of("spring kxx"), unit_of("u disk 2"), unit_of("disk mass")
    ('N/m', 'kg m', '')
    """
    for key in (name.split()[0], name.split()[-1]):
        if key in LONG:
            return UNITS.get(key, UNITS.get(key[0], ""))
    return ""


def bound_text(estimate: Estimate) -> str:
    """Return "at its lower bound of 0.1 kN/m", or nothing away from the bounds."""
    for side, bound in zip(("lower", "upper"), estimate.bounds or (), strict=False):
        if math.isclose(estimate.value, bound, rel_tol=NEAR_BOUND):
            return f"at its {side} bound of {quantity_text(bound, estimate.unit)}"
    return ""


def p_value_text(p: float) -> str:
    """Return a p-value as text.

    >>> p_value_text(0.0312), p_value_text(1e-20), p_value_text(0.998)
    ('p = 0.031', 'p < 0.0001', 'p > 0.99')
    """
    if p > 0.99:
        return "p > 0.99"
    return "p < 0.0001" if p < 1e-4 else f"p = {p:.2g}"


def _round(value: float, sigma: float) -> str:
    if not (math.isfinite(sigma) and sigma > 0):
        return f"{value:.4g}"
    decimals = 1 - math.floor(math.log10(sigma))
    return f"{round(value, decimals):.{max(decimals, 0)}f}"


def bearing_coefficients(bearing: Bearing) -> str:
    """Return a nameplate bearing's direct stiffness and damping.

    >>> bearing_coefficients(Bearing.model_validate({"name": "left", "position": "65 mm", "rigid": True}))
    'rigid'
    """
    if bearing.kxx is None or bearing.kyy is None:
        return "rigid"
    k, c = (
        ", ".join(_over_speed(value, scale) for value in pair)
        for pair, scale in (((bearing.kxx, bearing.kyy), 1e-3), ((bearing.cxx, bearing.cyy), 1.0))
    )
    return f"k {k} kN/m, c {c} N s/m (x, y){' over speed' if bearing.over_speed else ''}"


def _over_speed(value: float | OverSpeed, scale: float) -> str:
    if isinstance(value, OverSpeed):
        return f"{min(value.value) * scale:g} to {max(value.value) * scale:g}"
    return f"{value * scale:g}"
