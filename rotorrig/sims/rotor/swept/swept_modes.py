"""A rotor on its way through the speeds of some rows: what all loads, forces and directions of it share."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rotorrig.sims.rotor.model import RotorModel
from rotorrig.sims.rotor.swept.envelope import Envelope
from rotorrig.sims.rotor.swept.passed_modes import Spectra, passage, spectra
from rotorrig.sims.rotor.swept.tracking_windows import TrackedRows

KEPT = 2  # models whose passing is kept: a fit asks for a response, then for its derivatives, or for those before


@dataclass(frozen=True, slots=True, kw_only=True)
class Passing:
    """The poles over the speed, and the steps from turn to turn."""

    spectra: Spectra
    envelope: Envelope
    marches: list[tuple[Any, Any]] = field(default_factory=list, repr=False, compare=False)  # of swept_motion.py


def passing(model: RotorModel, rows: TrackedRows) -> Passing:
    """Return the passing of `model` through the rows at their order; the last few are kept with the rows.

    Raises ConfigError on a bearing that depends on speed.
    """
    for known, found in rows.passings:
        if known is model:
            return found
    found = _worked_out(model, rows)
    rows.passings.append((model, found))
    del rows.passings[:-KEPT]
    return found


def _worked_out(model: RotorModel, rows: TrackedRows) -> Passing:
    found = spectra(model, rows.speeds, order=rows.order)
    modes = passage(found, np.zeros((model.dof, 0), dtype=complex))
    return Passing(spectra=found, envelope=Envelope(modes.L, modes.T, rows))
