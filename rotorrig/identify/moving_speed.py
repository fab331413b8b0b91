"""The one cause without an unknown: that the speed moved, where the analyst's model takes every row as steady.

A sweep delays a resonance and lowers its peak, and the tracking window smears it (EFFECTS E22, E23 of the catalogue of
causes); both follow from the keyphasor's pulses and the window alone.
"""

from collections.abc import Sequence

import numpy as np

from rotorrig.identify.base_fit import Assessed
from rotorrig.identify.cause import Cause
from rotorrig.identify.held_out import held_out
from rotorrig.identify.selection import DETECTED
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.units import RPM

LABEL = "moving speed"


def moving_speed(still: Assessed, swept: Assessed, responses: Sequence[OrderTrackedResponse]) -> Cause | None:
    """Return what a base that knows the moving speed makes better than one that does not; None if the data do not say.

    It has no unknown, so its evidence is the fall of chi2, and it is never part of a config: the swept model has it.
    """
    if not all(recording.swept for recording in swept.problem.recordings):
        return None
    lam = still.polished.chi2 - swept.polished.chi2
    if lam <= DETECTED:
        return None
    alpha = np.concatenate([np.abs(r.alpha[np.isfinite(r.alpha)]) for r in responses])
    turns = float(np.median(np.concatenate([r.revolutions for r in responses])))
    return Cause(
        label=LABEL,
        effect="moving_speed",
        where="",
        title="moving speed and tracking window",
        words=(
            f"the speed was moving, by {np.quantile(alpha, 0.9) * RPM:.0f} rpm/s, and each row averages {turns:.0f} "
            "turns: the response lags behind the steady one, and its peak is lower"
        ),
        chosen=False,
        plausible=True,
        evidence=lam,
        lam=lam,
        heldout_before=held_out(still.problem, still.polished.p).error,
        heldout_after=held_out(swept.problem, swept.polished.p).error,
        parameters={},
        theta={},
        sigmas={},
    )
