"""Critical speeds in words and table cells: rpm, amplification factor, damping ratio, separation margin."""

from rotorrig.app.text.quantities import quantity_with_sigma
from rotorrig.processing import Resonance, SpeedWindow, Uncertain, required_margin
from rotorrig.rig.config import RPM

NOTHING = "–"
NO_RESONANCE = "No critical speed: the 1X amplitude has no peak within a run that stands out of the noise."


def critical_speed_cells(resonance: Resonance | None) -> list[str]:
    """Return critical speed [rpm], amplification factor and damping ratio [%], ± 1 sigma where that is known."""
    if resonance is None:
        return [NOTHING] * 3
    factor, damping = resonance.amplification, resonance.damping
    return [_number(resonance.omega, RPM), _number(factor), _number(damping, 100.0)]


def half_power_text(resonance: Resonance) -> str:
    """Return the half-power speeds [rpm], a dash for one that is not within the run.

    >>> top = Uncertain(value=200.0, sigma=0.1)
    >>> half_power_text(Resonance(omega=top, amplitude=top, lower=top, upper=None, amplification=None, damping=None))
    '1910 to –'
    """
    ends = (resonance.lower, resonance.upper)
    return " to ".join(NOTHING if end is None else f"{end.value * RPM:.0f}" for end in ends)


def resonance_text(resonance: Resonance) -> str:
    """Return "2246 rpm, AF 18.2, ζ 2.75 %"; without half-power speeds the speed alone."""
    speed = f"{resonance.omega.value * RPM:.0f} rpm"
    if resonance.amplification is None or resonance.damping is None:
        return speed
    return f"{speed}, AF {resonance.amplification.value:.3g}, ζ {100 * resonance.damping.value:.3g} %"


def critical_words(run: str, resonance: Resonance) -> str:
    """Return the resonance of a run as a sentence."""
    return f"Critical speed of run {run}: {resonance_text(resonance)}."


def margin_text(resonance: Resonance, operating: SpeedWindow) -> str:
    """Return the separation margin to the operating speeds and the one that API wants: "23.1 %, wanted 16.0 %"."""
    speed = resonance.omega.value
    if operating.low <= speed <= operating.high:
        margin, above = 0.0, False
    else:
        above = speed > operating.high
        margin = speed / operating.high - 1 if above else 1 - speed / operating.low
    if resonance.amplification is None:
        return f"{margin:.1%}, wanted: unknown without AF".replace("%", " %")
    wanted = required_margin(resonance.amplification.value, above=above)
    words = f"{margin:.1%}, wanted {wanted:.1%}".replace("%", " %")
    return words if margin >= wanted else f"{words}: too small"


def _number(value: Uncertain | None, factor: float = 1.0) -> str:
    if value is None:
        return NOTHING
    return quantity_with_sigma(value.value * factor, value.sigma * factor, "")
