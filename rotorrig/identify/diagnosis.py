"""`Diagnosis`: what the model gets wrong, and its file `diagnosis.json`."""

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.provenance import Provenance


class Verdict(StrEnum):
    """What a diagnosis may conclude."""

    ADEQUATE = "adequate"
    NAMED = "named"
    TIED = "tied"
    UNEXPLAINED = "unexplained"
    CANNOT_TELL = "cannot tell"


@dataclass(frozen=True, slots=True, kw_only=True)
class Misfit:
    """A stretch of one probe, order and run where model and measurement part."""

    run: str
    probe: str
    order: float
    speed_from: float  # rad/s
    speed_to: float  # rad/s
    sigma: float  # root mean square of the whitened residual over the stretch
    residual: float  # m, largest 0-peak magnitude in it
    relative: float  # mean (|measured| - |model|) / |model|; NaN where the model has no such order
    phase: float  # rad, mean arg(measured / model); NaN likewise
    sentence: str


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
