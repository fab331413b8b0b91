"""`Cause`: one effect a diagnosis tried at one place, with its size and what speaks for it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterValue:
    """One unknown of an effect as found, SI; a phasor is two: its magnitude, and "<name> angle" [rad]."""

    value: float
    unit: str  # "m", "rad", "" for a ratio
    sigma: float  # one standard deviation; infinite if the data do not restrict it


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """One effect at one place, fitted together with the base model."""

    label: str  # "runout, plane 2": one of a kind
    effect: str  # "runout": the file in sims/effects
    where: str  # "plane 2"; empty where there is one place only
    title: str  # "probe runout"
    words: str  # one sentence with the size
    chosen: bool  # it is in the extended model
    plausible: bool  # its parameters are within their plausible ranges
    evidence: float  # BIC of the base less BIC with it; > 0 speaks for it
    lam: float  # chi2 of the base less chi2 with it
    heldout_before: float  # m, rms prediction error on unseen data, base; NaN: not measured
    heldout_after: float  # m, with it
    parameters: dict[str, ParameterValue]
    theta: dict[str, float]  # the effect's own unknowns, as a config carries them
    sigmas: dict[str, float]  # of those
    nameplate: bool = False  # no effect: a statement of the config that is wrong
    given_up: bool = False  # its fit was left before its end, far behind the best: evidence and lam are the least
