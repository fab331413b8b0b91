"""How probable each cause is after a diagnosis: by BIC, all causes alike before the first run.

exp(-BIC / 2) approximates the probability of the data under a model (Kass and Raftery, J. Am. Stat. Assoc. 90 (1995),
773, eq. 9).
"""

from dataclasses import dataclass

import numpy as np

from rotorrig.identify import Diagnosis, Verdict
from rotorrig.identify.verdict import Cause

NOTHING_MORE = "nothing beyond the config"
NOTHING_KNOWN = "none of the causes known"


@dataclass(frozen=True, slots=True)
class Belief:
    """A cause and its probability among those it is tied with."""

    label: str
    probability: float


def beliefs(diagnosis: Diagnosis) -> tuple[Belief, ...]:
    """Return the causes in the model with their rivals, or what stands for them; the most probable first.

    Each chosen cause shares a probability of 1 with the causes it is tied with; the others are more than 16 behind in
    BIC, less than 1 in 3,000.
    """
    if diagnosis.verdict is Verdict.UNEXPLAINED:
        return (Belief(NOTHING_KNOWN, 1.0),)
    by_label = {cause.label: cause for cause in diagnosis.causes}
    chosen = [cause for cause in diagnosis.causes if cause.chosen]
    if not chosen:
        return _share_out({NOTHING_MORE: 0.0, **{c.label: c.evidence for c in by_label.values() if not c.nameplate}})
    found: list[Belief] = []
    for cause in chosen:
        group = next((each for each in diagnosis.tied if cause.label in each), (cause.label,))
        found += _share_out({label: _evidence(by_label.get(label), cause) for label in group})
    return tuple(sorted(dict.fromkeys(found), key=lambda belief: -belief.probability))


def _evidence(cause: Cause | None, best: Cause) -> float:
    """Return the evidence of a rival; of one without a fit of its own, as of a nameplate's, that of the best."""
    return cause.evidence if cause and np.isfinite(cause.evidence) else best.evidence


def _share_out(evidence: dict[str, float]) -> tuple[Belief, ...]:
    values = np.array(list(evidence.values()))
    weights = np.exp((values - values.max()) / 2)
    shares = weights / weights.sum()
    ranked = sorted(zip(evidence, shares, strict=True), key=lambda each: -each[1])
    return tuple(Belief(label, float(share)) for label, share in ranked if share > 1e-3)
