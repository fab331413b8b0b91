"""The one cause without an unknown: that the speed moved, where the analyst's model takes every row as steady.

A sweep delays a resonance and lowers its peak, and the tracking window smears it (EFFECTS E22, E23 of the catalogue of
causes); both follow from the keyphasor's pulses and the window alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.causes import SELECTION
from rotorrig.identify.verdict.cause import Cause
from rotorrig.identify.verdict.cross_validation import cross_validate
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM

LABEL = "moving speed"


def moving_speed(still: AssessedFit, swept: AssessedFit, responses: Sequence[OrderTrackedResponse]) -> Cause | None:
    """Return what a base that knows the moving speed makes better than one that does not; None if the data do not say.

    It has no unknown, so its evidence is the fall of chi2, and it is never part of a config: the swept model has it.
    """
    if not all(recording.swept for recording in swept.problem.recordings):
        return None
    lam = still.polished.chi2 - swept.polished.chi2
    if lam <= SELECTION.detected:
        return None
    return Cause(
        label=LABEL,
        effect="moving_speed",
        where="",
        title="moving speed and tracking window",
        words=f"the speed was moving, {_describe_ramp(responses)}: {_describe_lag(still, swept)}",
        chosen=False,
        plausible=True,
        evidence=lam,
        lam=lam,
        heldout_before=cross_validate(still.problem, still.polished.p).error,
        heldout_after=cross_validate(swept.problem, swept.polished.p).error,
        parameters={},
        theta={},
        sigmas={},
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Lag:
    """By how much the passing response differs from the steady one of the same rotor."""

    probe: str
    shift: float  # rad/s, from the steady peak to the passing one, in the sense in which the speed moves
    lower: float  # of the steady peak
    apart: float  # m, largest distance of the two vectors
    omega: float  # rad/s, where that is


def lag(still: AssessedFit, swept: AssessedFit) -> Lag:
    """Return the lag at 1X, where steady and passing responses to the unbalance of the swept fit part most.

    The two problems have the same unknowns, so the steady one can be asked for the rotor that the swept one found.
    """
    p = swept.polished.p
    pairs = zip(swept.problem.recordings, still.problem.model.predict(p), swept.problem.model.predict(p), strict=True)
    return max(
        (
            _lag(recording.response, recording.rows, steady[1][:-1], passing[1][:-1])
            for recording, steady, passing in pairs
        ),
        key=lambda each: each.apart,
    )


def _lag(
    response: OrderTrackedResponse,
    rows: NDArray[np.intp],
    steady: NDArray[np.complex128],
    passing: NDArray[np.complex128],
) -> Lag:
    """Compare steady and passing vectors (row, probe) of the rows of one recording."""
    apart = np.abs(passing - steady)
    row, probe = np.unravel_index(np.argmax(apart), apart.shape)
    run, omega = response.run[rows], response.omega[rows]
    same = run == run[row]
    old, new = np.abs(steady[same, probe]), np.abs(passing[same, probe])
    moved = omega[same][new.argmax()] - omega[same][old.argmax()]
    return Lag(
        probe=response.probes[probe],
        shift=float(response.runs[run[row]].direction * moved),
        lower=float(1 - new.max() / old.max()),
        apart=float(apart[row, probe]),
        omega=float(omega[row]),
    )


def _describe_ramp(responses: Sequence[OrderTrackedResponse]) -> str:
    alpha = np.concatenate([np.abs(r.alpha[np.isfinite(r.alpha)]) for r in responses])
    turns = float(np.median(np.concatenate([r.revolutions for r in responses])))
    averaged = "a single turn" if turns == 1 else f"{turns:.0f} turns"
    return f"by {np.quantile(alpha, 0.9) * RPM:.0f} rpm/s, with {averaged} to a row"


def _describe_lag(still: AssessedFit, swept: AssessedFit) -> str:
    """Say how far off a steady rotor of the same parameters is, and what becomes of its peak."""
    worst = lag(still, swept)
    off = f"a model in steady motion is off by {worst.apart * 1e6:.2g} um 0-peak at {worst.omega * RPM:.0f} rpm"
    words = f"{off}, at probe {worst.probe}"
    if worst.shift > 0 and worst.lower > 0:
        words += f"; the peak comes {worst.shift * RPM:.0f} rpm late and is {100 * worst.lower:.0f} % lower"
    return words
