"""From a fit to a `Diagnosis`: is the model adequate, and if not, where does it part from the measurement.

Naming the cause is not built yet: a model found wrong is `unexplained`, with no cause tried, and says so.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from rotorrig.identify.adequacy import FALSE_ALARM_RATE, FOCUSED_LIMIT, GLOBAL_LIMIT, Adequacy, Misfit, assess
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.provenance import Provenance


class Verdict(StrEnum):
    """What a diagnosis may conclude."""

    ADEQUATE = "adequate"
    NAMED = "named"
    TIED = "tied"
    UNEXPLAINED = "unexplained"
    CANNOT_TELL = "cannot tell"


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagnosis:
    """The verdict on the base model, with its evidence."""

    verdict: Verdict
    sentence: str  # the verdict for a person, in one or two sentences
    false_alarm_rate: float  # of the adequacy test, as stated
    noise_floor: float  # m, median 1-sigma of a 1X component
    chi2: float
    dof: int
    p: float
    worst: tuple[Misfit, ...]  # most serious first
    residual: NDArray[np.complex128]  # (speed, probe, order) m, measured less model, orders as in the response
    sigmas: NDArray[np.float64]  # (speed, probe, order) the same in standard deviations
    causes: tuple[dict[str, Any], ...] = ()
    tied: tuple[tuple[str, ...], ...] = ()
    next_run: dict[str, Any] = field(default_factory=dict)
    gain: dict[str, Any] = field(default_factory=dict)
    source: Provenance


_SHOWN = 12  # stretches listed, worst first


def diagnose(response: OrderTrackedResponse, found: Identification) -> Diagnosis:
    """Judge the whole-sweep fit of `found` against the response it was made from."""
    fit = found.fits[0]
    adequacy = assess(response, fit)
    return Diagnosis(
        verdict=Verdict.ADEQUATE if adequacy.adequate else Verdict.UNEXPLAINED,
        sentence=_sentence(adequacy),
        false_alarm_rate=FALSE_ALARM_RATE,
        noise_floor=adequacy.noise_floor,
        chi2=fit.chi2,
        dof=fit.dof,
        p=float(chdtrc(fit.dof, fit.chi2)),  # as scipy.stats.chi2.sf, whose import takes half a second
        worst=adequacy.misfits[:_SHOWN],
        residual=adequacy.residual,
        sigmas=adequacy.sigmas,
        source=found.source,
    )


def _sentence(adequacy: Adequacy) -> str:
    if adequacy.adequate:
        return (
            f"The model is adequate: 1X residuals at {adequacy.reduced_chi2:.2f} chi2 per degree of freedom "
            f"(limit {GLOBAL_LIMIT:g}), the worst stretch of speeds at {adequacy.worst_sigma:.1f} sigma "
            f"(limit {FOCUSED_LIMIT:g})."
        )
    worst = " ".join({m.order: m.sentence for m in reversed(adequacy.misfits)}.values())  # the loudest of each order
    return (
        f"The model is NOT adequate: 1X residuals at {adequacy.reduced_chi2:.3g} chi2 per degree of freedom "
        f"(limit {GLOBAL_LIMIT:g}), the worst stretch of speeds at {adequacy.worst_sigma:.0f} sigma "
        f"(limit {FOCUSED_LIMIT:g}). {worst} No cause was tried: naming causes is not built yet."
    )
