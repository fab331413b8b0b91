"""Columns of the Jacobian under force laws: by all that moves the rotor, the force being found anew."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.excited_rotor import Moving, halved_amounts
from rotorrig.identify.extended_model.model import ExtendedModel
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.sims.effects import Effect
from rotorrig.sims.rotor.model import Direction, Load
from rotorrig.sims.rotor.nonlinear import ForceLaw, LawChange

Complex = NDArray[np.complex128]
Index = NDArray[np.intp]


class LawColumns:
    """Effect of a step along every unknown of `free` on the rotor, its loads and its laws; serves all recordings."""

    def __init__(self, model: ExtendedModel, p: Reals, moving: Moving, free: Index) -> None:
        """Work out the directions at `p` and what the steps lead to."""
        self._model, self._p, self._moving, self._free = model, p, moving, free
        names = model.parameters
        structural = [int(i) for i in free if i < names.base.structural.stop]
        matrices: list[int] = []  # unknowns of effects
        others: list[int] = []
        nonlinear: list[int] = []  # whose loads are no multiples of them
        for effect, part in zip(model.effects, names.theta, strict=True):
            own = [int(i) for i in free if part.start <= i < part.stop and under_laws(model, p, effect, int(i))]
            (matrices if "matrices" in effect.acts_on else others).extend(own)
            nonlinear.extend(own if "loads" in effect.acts_on and not effect.linear else [])
        which = [*structural, *matrices]
        directions = model.directions(p, moving.model, np.array(which, dtype=np.intp))
        self._directions: dict[int, Direction] = dict(zip(which, directions, strict=True))
        self._nonlinear = nonlinear
        self._after = {i: self._stepped(i) for i in [*which, *others]}
        loaded = (free >= names.base.unbalance.start) & (free < names.base.unbalance.stop) | (free == names.keyphasor)
        self._moves = bool(self._after) or bool(loaded.any())  # else nothing of the march changes

    def fill(self, recording: Recording, found: dict[int, Complex], *, orders: tuple[int, ...]) -> Complex:
        """Add the columns of 1X to `found`, order -> (row + 1, probe, column), and those of the laws' forces above.

        Return the motion of 1X along and across every probe, (row + 1, 2 probe). One march for every set of trial
        masses there is in the recording.
        """
        model, p = self._model, self._p
        if not self._moves:
            return model.motions(recording, p, self._moving)[1]
        loads, more = self._loads(recording)
        halved = self._moving.halved
        amounts = model.amounts(recording, p, halved=halved)
        sets, which = np.unique(amounts, axis=0, return_inverse=True)
        turned = 1j * np.stack(list(model.trials(recording, p).values()), axis=-1)
        turned = halved_amounts(turned) if halved else turned
        motion = np.zeros((len(amounts), len(self._moving.model.probes)), complex)
        for n, planes in enumerate(sets):
            rows = np.flatnonzero(which.ravel() == n)
            each = np.zeros(len(loads), complex)
            each[: len(planes)] = planes
            each[len(planes) : len(loads) - sum(map(len, more.values()))] = 1
            changes = self._changes(len(loads), more, turned[rows[0]])
            z, by = recording.law_derivatives(
                self._moving.model, loads, each, self._moving.laws, list(changes.values()), orders=orders
            )
            motion[rows] = z[rows]
            columns = np.searchsorted(self._free, list(changes))
            for order, change in by.items():
                for k, column in enumerate(columns):
                    found[order][rows, :, column] += model.probes.linear(p, change[..., k])[rows]
        return motion

    def fill_above(self, recording: Recording, found: Complex, *, order: int) -> None:
        """Add the columns by loads above 1X that are not linear in the unknowns to `found` (row + 1, probe, column)."""
        known = self._moving.loads(recording, order)
        for i in self._nonlinear:
            pairs = zip(known, self._after[i].loads(recording, order), strict=True)
            more = [replace(old, pattern=(new.pattern - old.pattern) / EXTENDED_MODEL.law_step) for old, new in pairs]
            z = recording.columns(self._moving.model, more, order=order).sum(axis=-1)
            found[..., np.searchsorted(self._free, i)] += self._model.probes.linear(self._p, z)

    def _stepped(self, i: int) -> Moving:
        moved = self._p.copy()
        moved[i] += EXTENDED_MODEL.law_step
        return self._model.moving(moved)

    def _loads(self, recording: Recording) -> tuple[list[Load], dict[int, list[Load]]]:
        """Return the loads of 1X and after them what a unit of unknowns adds to them; this also as unknown -> loads."""
        known = self._moving.loads(recording, 1)
        more: dict[int, list[Load]] = {}
        for i, after in self._after.items():
            for old, new in zip(known, after.loads(recording, 1), strict=True):
                change = (new.pattern - old.pattern) / EXTENDED_MODEL.law_step
                if change.any():
                    more.setdefault(i, []).append(replace(old, pattern=change))
        return [*self._moving.planes, *known, *(load for loads in more.values() for load in loads)], more

    def _changes(self, loads: int, more: dict[int, list[Load]], turned: Complex) -> dict[int, LawChange]:
        """Return what every unknown changes, `turned` (plane,) being how the keyphasor's angle turns trial masses."""
        names, planes = self._model.parameters, self._model.planes
        base, amounts = names.base, {}
        for i in self._free[(self._free >= base.unbalance.start) & (self._free < base.unbalance.stop)]:
            plane, imaginary = divmod(int(i) - base.unbalance.start, 2)
            k = planes.index(base.space.planes[plane])
            halved = self._moving.halved
            amounts[int(i)] = _unit(loads, 2 * k + imaginary) if halved else _unit(loads, k) * (1j if imaginary else 1)
        if names.keyphasor in self._free:
            amounts[names.keyphasor] = np.concatenate([turned, np.zeros(loads - len(turned))])
        first = loads - sum(map(len, more.values()))
        for i, own in more.items():
            amounts[i] = np.sum([_unit(loads, first + k) for k in range(len(own))], axis=0)
            first += len(own)
        return {
            i: LawChange(
                direction=self._directions.get(i),
                amounts=amounts.get(i),
                laws=self._laws(i),
                step=EXTENDED_MODEL.law_step,
            )
            for i in sorted({*amounts, *self._after})
        }

    def _laws(self, i: int) -> tuple[ForceLaw, ...] | None:
        """Return the laws after a step of unknown `i`, None where they are the same."""
        if i not in self._after:
            return None
        before, after = self._moving.laws, self._after[i].laws
        same = all(
            np.array_equal(a.constants, b.constants) and np.array_equal(a.static, b.static)
            for a, b in zip(before, after, strict=True)
        )
        return None if same else after


def under_laws(model: ExtendedModel, p: Reals, effect: Effect, i: int) -> bool:
    """Say whether unknown `i` of an effect has a column here: it moves the rotor, and does it smoothly."""
    if not effect.acts_on or "probes" in effect.acts_on:
        return False
    matrices = "matrices" not in effect.acts_on or not model.resized(p, i)
    return matrices and not _moves_a_law(model, p, effect, i)


def _moves_a_law(model: ExtendedModel, p: Reals, effect: Effect, i: int) -> bool:
    """Say whether unknown `i` is where a force law of its effect acts, and not only how."""
    k = model.effects.index(effect)
    q = effect.parameters[i - model.parameters.theta[k].start]
    theta, rotor = model.parameters.of_effect(p, k), model.rotor(p)
    there = effect.force_laws(rotor, theta | {q.name: theta[q.name] + EXTENDED_MODEL.law_step * q.size})
    return any(not np.array_equal(a.rows, b.rows) for a, b in zip(effect.force_laws(rotor, theta), there, strict=True))


def _unit(size: int, i: int) -> Complex:
    found = np.zeros(size, complex)
    found[i] = 1
    return found
