"""Unbalance that changes while the rotor runs: a screw works loose, something breaks off or sticks.

From a moment on the response is that of another unbalance, so run-up and coast-down, or two runs, disagree by a vector
that grows as unbalance does. Source: Muszynska, Rotordynamics (2005), ch. 6.
"""

from dataclasses import dataclass

from rotorrig.rig.description import RigConfig
from rotorrig.sims.effects.base import Effect, Parameter, Theta, pair, phasor, polar
from rotorrig.sims.effects.places import called, unbalance_sought
from rotorrig.sims.effects.shaft_motion import forward
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.loads import Load

LONGEST = 1e6  # s of a recording


@dataclass(frozen=True, kw_only=True)
class UnbalanceStep(Effect):
    """The phasor "step" [kg m] that is added at "time" [s] on the recording's clock.

    The recordings tell the times worth a try: identify.candidates.
    """

    name = "unbalance_step"
    title = "step of unbalance"
    plane: str

    def loads(self, model: RotorModel, theta: Theta) -> tuple[Load, ...]:
        """Return the force of what was added, from then on."""
        pattern = phasor(theta, "step") * forward(model.plane(self.plane).rows, model.rotation)
        return (Load(pattern=pattern, law="unbalance", since=theta["time"]),)

    def words(self, theta: Theta) -> str:
        """Say how much it is and since when."""
        size, angle = polar(theta, "step")
        when = f"{theta['time']:.1f} s into the recording" if theta["time"] > 0 else "before the recording began"
        return (
            f"the unbalance of {self.plane} changed by {1e6 * size:.1f} g mm at {angle:.0f} deg from the keyphasor "
            f"mark, {when}"
        )


def effects(rig: RigConfig) -> tuple[UnbalanceStep, ...]:
    """Return one for every plane whose unbalance is sought."""
    sought = unbalance_sought(rig)
    time = Parameter(name="time", unit="s", low=-LONGEST, high=LONGEST, size=1.0)
    unknown = (*pair("step", "kg m", most=30e-6, size=5e-6), time)
    return tuple(UnbalanceStep(where=called(name, sought), plane=name, parameters=unknown) for name in sought)
