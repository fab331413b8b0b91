"""Unbalance that changes once: a screw works loose, something breaks off or sticks.

From a moment on the response is that of another unbalance, so run-up and coast-down, or two recordings, disagree by a
vector that grows as unbalance does. What is lost stays lost: recordings that were made later have it from their start.
Source: Muszynska, Rotordynamics (2005), ch. 6.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.effects.base import Effect, Parameter, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import place_label, unbalance_sought
from rotorrig.sims.effects.shaft_motion import forward
from rotorrig.sims.rotor.model import Load, RotorModel, recording_at

LONGEST = 1e9  # s: a thousand recordings
OTHER_MOMENTS = (-2.0, -1.0, -0.5, 0.5, 1.0, 2.0)  # s from a step, when part of it may have come: it takes seconds


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """The speeds of one run, to say at which of them a moment was."""

    run: str  # "up"
    t: NDArray[np.float64]  # (row,) s, on the clock of all recordings
    omega: NDArray[np.float64]  # (row,) rad/s


@dataclass(frozen=True, kw_only=True)
class UnbalanceStep(Effect):
    """The phasor "step" [kg m] that is added at "time" [s], on the clock that runs through all recordings: loads.py.

    The recordings tell the times worth a try: identify/causes/candidates.py.
    """

    name = "unbalance_step"
    title = "step of unbalance"
    linear = True
    plane: str
    runs: tuple[Stretch, ...] = field(default=(), compare=False, repr=False)

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the force of what was added, from then on."""
        pattern = phasor(theta, "step") * forward(model.plane(self.plane).rows, model.rotation)
        return (Load(pattern=pattern, law="unbalance", since=theta["time"]),)

    def at_other_moments(self, theta: Theta) -> tuple[Theta, ...]:
        """Return the step a little earlier and later; none of one that no recording saw."""
        _, t = recording_at(theta["time"])
        return tuple({**theta, "time": theta["time"] + apart} for apart in OTHER_MOMENTS if t > 0)

    def words(self, theta: Theta) -> str:
        """Say how much it is and since when."""
        size, angle = polar(theta, "step")
        return (
            f"the unbalance of {self.plane} changed by {1e6 * size:.1f} g mm at {angle:.0f} deg from the keyphasor "
            f"mark, {self._when(theta['time'])}"
        )

    def _when(self, time: float) -> str:
        number, t = recording_at(time)
        if t <= 0:
            return f"before recording {number + 1} began"
        begins = f"{t:.1f} s into recording {number + 1}"
        for run in self.runs:
            if run.t[0] <= time <= run.t[-1]:
                return f"{begins} (at {np.interp(time, run.t, run.omega) * RPM:.0f} rpm in run '{run.run}')"
        return begins


def effects(rig: RigConfig) -> tuple[UnbalanceStep, ...]:
    """Return one for every plane whose unbalance is sought."""
    sought = unbalance_sought(rig)
    time = Parameter(name="time", unit="s", low=-LONGEST, high=LONGEST, size=1.0, grid_searched=True)
    unknown = (*pair("step", "kg m", most=30e-6, size=5e-6, of_rig=True), time)
    return tuple(UnbalanceStep(where=place_label(name, sought), plane=name, parameters=unknown) for name in sought)
