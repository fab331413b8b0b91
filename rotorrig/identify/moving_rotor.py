"""`Moving`: the rotor of one vector of unknowns, and everything that moves it."""

from dataclasses import dataclass

from rotorrig.identify.recording import Recording
from rotorrig.sims.rotor.assembly import RotorModel
from rotorrig.sims.rotor.force_law import ForceLaw
from rotorrig.sims.rotor.loads import Load


@dataclass(frozen=True, slots=True, kw_only=True)
class Moving:
    """The rotor of one candidate and what moves it."""

    model: RotorModel
    planes: tuple[Load, ...]  # a unit of unbalance on every plane; in real halves where a stiffness turns
    effects: tuple[tuple[int | None, Load], ...]  # loads of effects, amounts in, and the recording they act in alone
    laws: tuple[ForceLaw, ...]

    @property
    def halved(self) -> bool:
        """Whether the response is linear in real amounts only."""
        return self.model.added.T is not None

    def loads(self, recording: Recording, order: int) -> list[Load]:
        """Return the loads of effects of that order in a recording."""
        return [load for where, load in self.effects if where in (None, recording.number) and load.order == order]
