"""Responses to a unit of every unknown in which an effect's loads are linear; above 1X of one rotor while it is held.

At 2X and 3X a rotor answers weight and force laws by little, and its structure changes that by less: a fit begins with
the responses of the rotor it starts from. Where the change matters, they are from then on `exact`.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.parameters import ExtendedParameters
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.model import Load, RotorModel

Complex = NDArray[np.complex128]


class UnitResponses:
    """Of the effects of one problem."""

    def __init__(self, parameters: ExtendedParameters, effects: Sequence[Effect], *, exact: bool = False) -> None:
        """Set up; `exact` if the rotor is to be that of every vector above 1X too."""
        self.exact = exact
        self._parameters = parameters
        self._effects = effects
        self._held: dict[tuple[int, int], tuple[RotorModel, Complex]] = {}  # of a recording and order

    def release(self) -> None:
        """Take the next rotor asked for as the one that is held."""
        self._held = {}

    @property
    def seen(self) -> bool:
        """Whether anything answered above 1X so far."""
        return any(units.any() for _, units in self._held.values())

    def of(self, recording: Recording, p: Reals, model: RotorModel, order: int) -> Complex:
        """Return d motion / d unknowns of linear effects by their loads, (row + 1, 2 probe, unknown)."""
        if order == 1:
            return self._anew(recording, p, model, 1)
        key = recording.number, order
        if key not in self._held or (self.exact and self._held[key][0] is not model):
            self._held[key] = model, self._anew(recording, p, model, order)
        return self._held[key][1]

    def _anew(self, recording: Recording, p: Reals, model: RotorModel, order: int) -> Complex:
        own = self._parameters.own
        found = np.zeros((len(recording.rows) + 1, len(model.probes), own.stop - own.start), complex)
        loads: list[Load] = []
        column: list[int] = []
        c = 0
        for i, effect in enumerate(self._effects):
            there = self._parameters.of_effect(p, i)
            rest = {q.name: there[q.name] if q.grid_searched else 0.0 for q in effect.parameters}
            acts = effect.recording in (None, recording.number) and "loads" in effect.acts_on
            for q in effect.parameters:
                if acts and effect.linear and not q.grid_searched:
                    unit = [u for u in effect.loads(model, rest | {q.name: q.size}) if u.order == order]
                    loads, column = loads + unit, column + [c] * len(unit)
                c += 1
        by_load = recording.columns(model, loads, order=order)
        for k, c in enumerate(column):
            found[..., c] += by_load[..., k]
        return found
