"""SI numbers as people read them: kN/m, g mm, degrees, and no more digits than their uncertainty leaves."""

import math

from rotorrig.identify.identification import Estimate
from rotorrig.rig.description import Identify
from rotorrig.rig.nameplate import Bearing, OverSpeed

#: SI unit -> (unit shown, factor)
SHOWN = {
    "N/m": ("kN/m", 1e-3),
    "N s/m": ("N s/m", 1.0),
    "kg m": ("g mm", 1e6),
    "rad": ("°", 180.0 / math.pi),
    "m": ("µm", 1e6),
    "": ("", 1.0),
}
#: what an estimate's short name stands for
LONG = {
    "kxx": "stiffness, horizontal",
    "kyy": "stiffness, vertical",
    "cxx": "damping, horizontal",
    "cyy": "damping, vertical",
    "u": "unbalance",
    "phase": "unbalance angle from the keyphasor mark",
    "E": "Young's modulus",
    "disk mass": "disk mass",
}
NEAR_BOUND = 1e-3  # relative: nearer to a bound than this, an estimate was stopped by it
UNDETERMINED = "not determined by this data"


def shown(value: float, unit: str, *, sigma: float = math.nan) -> str:
    """Return `value` [SI] in the unit people use, rounded to two digits of `sigma` or to four digits without one.

    >>> shown(33912.7, "N/m", sigma=120.0), shown(1.5e-5, "kg m"), shown(math.nan, "N/m")
    ('33.91 kN/m', '15 g mm', '–')
    """
    name, factor = SHOWN.get(unit, (unit, 1.0))
    if not math.isfinite(value):
        return "–"
    gap = "" if name in ("", "°") else " "
    return f"{_rounded(value * factor, sigma * factor)}{gap}{name}"


def plus_minus(estimate: Estimate) -> str:
    """Return "33.91 ± 0.12 kN/m", or that the data do not determine it."""
    if not determined(estimate):
        return UNDETERMINED
    name, factor = SHOWN.get(estimate.unit, (estimate.unit, 1.0))
    if estimate.unit == "" and estimate.nameplate == 0:
        name, factor = "%", 100.0  # a relative deviation from the nameplate
    value, sigma = estimate.value * factor, estimate.sigma * factor
    gap = "" if name == "°" else " "
    return f"{_rounded(value, sigma)} ± {_rounded(sigma, sigma)}{gap}{name}".rstrip()


def determined(estimate: Estimate) -> bool:
    """Return whether the data say what this is."""
    return estimate.determined and math.isfinite(estimate.sigma) and math.isfinite(estimate.value)


def difference(estimate: Estimate, reference: float) -> float:
    """Return estimate less `reference` [SI]; angles the short way round.

    >>> e = Estimate(name="phase", value=3.1, sigma=0.1, unit="rad", nameplate=0.0)
    >>> round(difference(e, -3.1), 3)
    -0.083
    """
    gap = estimate.value - reference
    return math.remainder(gap, 2 * math.pi) if estimate.unit == "rad" else gap


def change(estimate: Estimate, reference: float) -> str:
    """Return the difference from `reference` in %, in degrees for an angle; "–" where there is none to state.

    >>> change(Estimate(name="kxx", value=33.0e3, sigma=1e3, unit="N/m", nameplate=30.0e3), 30.0e3)
    '+10.0 %'
    """
    if not (determined(estimate) and math.isfinite(reference)):
        return "–"
    gap = difference(estimate, reference)
    if estimate.unit == "rad":
        return f"{math.degrees(gap):+.1f}°"
    return f"{100 * gap / reference:+.1f} %" if reference else "–"


def in_sigmas(estimate: Estimate, reference: float) -> str:
    """Return the difference from `reference` in standard deviations of the estimate."""
    if not (determined(estimate) and math.isfinite(reference) and estimate.sigma > 0):
        return "–"
    return f"{difference(estimate, reference) / estimate.sigma:+.1f} σ"


def at_bound(estimate: Estimate, search: Identify | None) -> str:
    """Return "at its lower bound of 0.1 kN/m", or nothing where the search did not stop it."""
    bounds = {"N/m": search.k_bounds, "N s/m": search.c_bounds, "kg m": search.u_bounds} if search else {}
    for side, bound in zip(("lower", "upper"), bounds.get(estimate.unit, ()), strict=False):
        if math.isclose(estimate.value, bound, rel_tol=NEAR_BOUND):
            return f"at its {side} bound of {shown(bound, estimate.unit)}"
    return ""


def probability(p: float) -> str:
    """Return a p-value as people quote it.

    >>> probability(0.0312), probability(1e-20)
    ('p = 0.031', 'p < 0.0001')
    """
    return "p < 0.0001" if p < 1e-4 else f"p = {p:.2g}"


def _rounded(value: float, sigma: float) -> str:
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
