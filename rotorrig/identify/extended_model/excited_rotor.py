"""`Moving`: the rotor of one vector of unknowns, and everything that moves it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.sims.rotor.model import Load, RotorModel
from rotorrig.sims.rotor.nonlinear import ForceLaw


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


Complex = NDArray[np.complex128]


def halved_loads(loads: Sequence[Load]) -> tuple[Load, ...]:
    """Return each load, then the same times j: those of the real and of the imaginary part of its amount."""
    return tuple(half for load in loads for half in (load, replace(load, pattern=1j * load.pattern)))


def halved_amounts(amounts: Complex) -> Complex:
    """Return the parts (..., 2 load) of amounts (..., load) in that order, real but for their type.

    >>> halved_amounts(np.array([3 + 4j, 1 - 2j])).real
    array([ 3.,  4.,  1., -2.])
    """
    parts = np.stack([amounts.real, amounts.imag], axis=-1).astype(complex)
    return parts.reshape(*amounts.shape[:-1], 2 * amounts.shape[-1])
