"""The forward model of one or more recordings of a rig: its rotor, extended by effects, and its measuring chain.

Vectors are predicted from a vector of ExtendedParameters.
"""

import copy
from collections.abc import Collection, Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals, StructuralModel
from rotorrig.identify.extended_model.excited_rotor import Moving, halved_amounts, halved_loads
from rotorrig.identify.extended_model.mains_hum import HumLine
from rotorrig.identify.extended_model.measuring_chain import ProbeSide
from rotorrig.identify.extended_model.parameters import ExtendedParameters
from rotorrig.identify.extended_model.settings import EXTENDED_MODEL, ORDERS
from rotorrig.identify.extended_model.tracked_recording import Recording
from rotorrig.identify.extended_model.unit_responses import UnitResponses
from rotorrig.sims.effects import Effect, Theta
from rotorrig.sims.rotor.model import Direction, Load, RotorModel, finite_difference, unbalance_pattern

Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

Models = dict[tuple[tuple[str, float], ...], StructuralModel]
Recent = dict[Hashable, RotorModel]

WITHIN = 0.99  # of how far a model can move a part: differences are taken there


class ExtendedModel:
    """Vectors of all recordings over the vector of ExtendedParameters."""

    def __init__(
        self,
        recordings: Sequence[Recording],
        effects: Sequence[Effect] = (),
        *,
        models: Models | None = None,
        recent: Recent | None = None,
        hum_lines: Sequence[HumLine] | None = None,
        exact: bool = False,
        widened: Collection[str] = (),
    ) -> None:
        """Set up; `models` keeps the reduced rotors that several models of one rig share, `recent` those of vectors.

        `hum_lines` are those of all recordings, if there are more than these; `exact` as of UnitResponses; `widened`
        as of ExtendedParameters.
        """
        first = recordings[0].response
        self.recordings = tuple(recordings)
        self.amplitudes_alone = first.amplitudes_alone
        self.effects = tuple(effects)
        orders = recordings[0].orders
        if hum_lines is None:
            hum_lines = [(r.number, frequency) for r in recordings for frequency in r.hum[1]]
        self.parameters = ExtendedParameters(
            recordings[0].rig,
            first.probes,
            orders=orders,
            hum_lines=hum_lines,
            effects=effects,
            widened=widened,
            amplitudes_alone=self.amplitudes_alone,
        )
        self.widened = frozenset(widened)
        self.probes = ProbeSide(self.parameters)
        self.units = UnitResponses(self.parameters, self.effects, exact=exact)
        self._marched: dict[tuple[Hashable, ...], dict[int, Complex]] = {}  # motions under force laws, the latest
        self._resizes: dict[tuple[int, bytes], bool] = {}
        self._directions: tuple[tuple[bytes, bytes], list[Direction]] = ((b"", b""), [])  # the latest
        base = self.parameters.base
        trial = dict.fromkeys(disk for r in recordings for disk in r.trial)
        self.planes = tuple(dict.fromkeys((*base.space.planes, *trial)))
        self.models = {} if models is None else models
        self._recent = {} if recent is None else recent
        self._structure = self._with_places({name: z for effect in effects for name, z in effect.places.items()})
        furthest = [self._structure.position_range(part) for part in self._structure.movable]
        base.position_ranges = WITHIN * np.array(furthest)

    def on(self, recordings: Sequence[Recording]) -> "ExtendedModel":
        """Return the same model of other recordings or rows."""
        return self._of(recordings, self.effects)

    def extended(self, effects: Sequence[Effect]) -> "ExtendedModel":
        """Return the model of the same recordings with these effects instead."""
        return self._of(self.recordings, effects)

    def with_wider_priors(self, nuisances: Collection[str]) -> "ExtendedModel":
        """Return the same model with wider priors of these nuisances too."""
        return self._of(self.recordings, self.effects, widened=nuisances)

    def _of(
        self, recordings: Sequence[Recording], effects: Sequence[Effect], *, widened: Collection[str] = ()
    ) -> "ExtendedModel":
        return ExtendedModel(
            recordings,
            effects,
            models=self.models,
            recent=self._recent,
            hum_lines=self.parameters.hum_lines,
            exact=self.units.exact,
            widened=self.widened.union(widened),
        )

    def seeing(self, places: Mapping[str, float]) -> "ExtendedModel":
        """Return the same model with a rotor that has these places [m] too."""
        other = copy.copy(self)
        own = {name: z for effect in self.effects for name, z in effect.places.items()}
        other._structure = self._with_places({**own, **places})
        return other

    def _with_places(self, places: Mapping[str, float]) -> StructuralModel:
        """Return the reduced rotor with those places, made at most once."""
        key = tuple(sorted(places.items()))
        if key not in self.models:
            first, base = self.recordings[0], self.parameters.base
            self.models[key] = StructuralModel(
                first.rig,
                first.response.probes,
                groups=base.space.groups,
                others=base.others,
                places=places,
                adjustable=True,
            )
        return self.models[key]

    def predict(self, p: Reals, *, orders: Sequence[int] = ORDERS) -> list[dict[int, Complex]]:
        """Return vectors as they should have been measured, per recording: order -> (row + 1, probe) [m]."""
        moving = self.moving(p)
        return [
            recording.as_stated(self.probes.seen(recording, p, self.motions(recording, p, moving, orders=orders)))
            for recording in self.recordings
        ]

    def linear(self) -> Index:
        """Return the parameters in which everything is linear; amplitudes are so in none."""
        names = self.parameters
        if self.amplitudes_alone:
            return np.empty(0, dtype=np.intp)
        found = [np.arange(part.start, part.stop) for part in (*names.runouts.values(), names.hums)]
        if not any("force laws" in effect.acts_on for effect in self.effects):
            found.append(np.arange(names.base.unbalance.start, names.base.unbalance.stop))
            found += [
                np.arange(part.start, part.stop)
                for effect, part in zip(self.effects, names.theta, strict=True)
                if effect.linear and "matrices" not in effect.acts_on
            ]
        return np.concatenate(found)

    def moving(self, p: Reals) -> Moving:
        """Return the rotor of `p` and what moves it."""
        thetas = [self.parameters.of_effect(p, i) for i in range(len(self.effects))]
        model = self._rotor_with(p, thetas)
        each = list(zip(self.effects, thetas, strict=True))
        planes = tuple(Load(pattern=unbalance_pattern(model, {name: 1.0}), law="unbalance") for name in self.planes)
        return Moving(
            model=model,
            planes=planes if model.added.T is None else halved_loads(planes),
            effects=tuple((effect.recording, load) for effect, theta in each for load in effect.loads(model, theta)),
            laws=tuple(law for effect, theta in each for law in effect.force_laws(model, theta)),
        )

    def rotor(self, p: Reals) -> RotorModel:
        """Return the rotor of `p`."""
        return self._rotor_with(p, [self.parameters.of_effect(p, i) for i in range(len(self.effects))])

    def _rotor_with(self, p: Reals, thetas: Sequence[Theta]) -> RotorModel:
        """Return the rotor of `p`, the same object as long as what it depends on is the same."""
        base = self.parameters.base
        changes = [
            (effect, theta) for effect, theta in zip(self.effects, thetas, strict=True) if "matrices" in effect.acts_on
        ]
        figures = tuple((effect.label, *theta.values()) for effect, theta in changes)
        key = (self._structure, p[base.structural].tobytes(), figures)
        if key not in self._recent:
            model = self._structure(base.structure(p[: len(base)]))
            for effect, theta in changes:
                model = effect.change_matrices(model, theta)
            self._recent[key] = model
            for old in list(self._recent)[: -EXTENDED_MODEL.recent_rotors]:
                del self._recent[old]
        return self._recent[key]

    def resized(self, p: Reals, i: int) -> bool:
        """Say whether a step of unknown `i` changes the number of coordinates, as at a pedestal of no lightness."""
        key = (i, (p[self.parameters.own] == 0).tobytes())
        if key not in self._resizes:
            moved = p.copy()
            moved[i] += EXTENDED_MODEL.matrix_step
            self._resizes[key] = self.rotor(moved).dof != self.rotor(p).dof
        return self._resizes[key]

    def directions(self, p: Reals, model: RotorModel, which: Index) -> list[Direction]:
        """Return the derivatives of the matrices of `model` by `which`: structure of the base, matrices of effects.

        Those by structure are differences too where an effect may scale what the structure is of.
        """
        key = (p.tobytes(), which.tobytes())
        if self._directions[0] != key:  # every recording asks, at every order
            self._directions = key, self._directed(p, model, which)
        return self._directions[1]

    def _directed(self, p: Reals, model: RotorModel, which: Index) -> list[Direction]:
        base = self.parameters.base
        values, by = base.structure(p[: len(base)]), base.structure_derivatives(p[: len(base)])
        scaling = [n for n, e in enumerate(self.effects) if "matrices" in e.acts_on and e.scales_base]
        plain = all(self.effects[n].is_nuisance for n in scaling)
        found = []
        for i in which:
            if i < base.structural.stop and plain:
                direction = self._structure.direction(model, values, by[i])
                for n in scaling if i in base.of_shaft else ():
                    theta = self.parameters.of_effect(p, n)
                    direction = self.effects[n].change_along_shaft(direction, model, theta)
                found.append(direction)
                continue
            moved, step = p.copy(), self._matrix_step(i)
            moved[i] += step
            found.append(finite_difference(model, self.rotor(moved), step))
        return found

    def _matrix_step(self, i: int) -> float:
        """Return the step of unknown `i` for a difference of matrices."""
        base = self.parameters.base
        if i >= base.structural.stop:
            return EXTENDED_MODEL.matrix_step
        is_tilt = base.tilts.start <= i < base.tilts.stop
        return EXTENDED_MODEL.tilt_step if is_tilt else EXTENDED_MODEL.structure_step

    def amounts(self, recording: Recording, p: Reals, *, halved: bool = False) -> Complex:
        """Return the unbalance on every plane, trial masses included, (row + 1, plane) kg m, or its real halves."""
        sought = self.parameters.base.amounts(p[: len(self.parameters.base)])
        whole = np.stack([sought.get(plane, 0) + trial for plane, trial in self.trials(recording, p).items()], axis=-1)
        return halved_amounts(whole) if halved else whole

    def trials(self, recording: Recording, p: Reals) -> dict[str, Complex]:
        """Return the trial masses of every plane, (row + 1,) kg m, turned by the error of the keyphasor's mark."""
        turned = np.exp(1j * p[self.parameters.keyphasor])
        nothing = np.zeros(len(recording.rows) + 1, complex)
        return {plane: turned * recording.trial.get(plane, nothing) for plane in self.planes}

    def motions(
        self, recording: Recording, p: Reals, moving: Moving, *, orders: Sequence[int] = ORDERS
    ) -> dict[int, Complex]:
        """Return the motion along and across every probe, order -> (row + 1, 2 probe)."""
        wanted = [order for order in recording.orders if order in orders]
        if not moving.laws:
            return {order: self.motion_of(recording, p, moving, order=order) for order in wanted}
        return self._lawful(recording, p, moving, wanted)

    def motion_of(self, recording: Recording, p: Reals, moving: Moving, *, order: int) -> Complex:
        """Return the motion along and across every probe, (row + 1, 2 probe), without force laws."""
        if order > 1 and self.linear_at(order):
            return self.units.of(recording, p, moving.model, order) @ p[self.parameters.own]
        mine = moving.loads(recording, order)
        if order != 1:
            return recording.columns(moving.model, mine, order=order).sum(axis=-1)
        units = recording.columns(moving.model, [*moving.planes, *mine], order=1)
        planes = len(moving.planes)
        amounts = self.amounts(recording, p, halved=moving.halved)
        z = np.einsum("rpl,rl->rp", units[..., :planes], amounts)
        return z + units[..., planes:].sum(axis=-1)

    def motion_at(self, recording: Recording, p: Reals, rows: Reals) -> Complex:
        """Return the motion at 1X that `rows` (n, dof) read, anywhere on the shaft, (row + 1, n) m."""
        moving = self.moving(p)
        there = replace(moving, model=replace(moving.model, probes=rows))
        if there.laws:
            return self._marched_anew(recording, p, there, [1])[1]
        return self.motion_of(recording, p, there, order=1)

    def linear_at(self, order: int) -> bool:
        """Say whether the effects that could push at that order are all linear."""
        return all(e.linear for e in self.effects if order in e.orders and "loads" in e.acts_on)

    def _lawful(self, recording: Recording, p: Reals, moving: Moving, wanted: Sequence[int]) -> dict[int, Complex]:
        """Return the motion under force laws; what these do is kept of the last few: most unknowns do not change it."""
        names = self.parameters
        moves = (*p[names.base.structural], *p[names.base.unbalance], p[names.keyphasor], *p[names.own])
        key = (recording.number, tuple(wanted), moves)
        if key not in self._marched:
            self._marched[key] = self._marched_anew(recording, p, moving, wanted)
            for old in list(self._marched)[: -EXTENDED_MODEL.recent * len(self.recordings)]:
                del self._marched[old]
        found = dict(self._marched[key])
        for order in wanted:
            if order > 1:
                found[order] = found[order] + self.motion_of(recording, p, moving, order=order)
        return found

    def _marched_anew(
        self, recording: Recording, p: Reals, moving: Moving, wanted: Sequence[int]
    ) -> dict[int, Complex]:
        """Return the motion of 1X, and of the laws' forces above; one march for every set of trial masses there is."""
        first = moving.loads(recording, 1)
        loads = [*moving.planes, *first]
        each = self.amounts(recording, p, halved=moving.halved)
        sets, which = np.unique(each, axis=0, return_inverse=True)
        marched = [order for order in wanted if order <= EXTENDED_MODEL.highest_law_order]
        found = {order: np.zeros((len(each), len(moving.model.probes)), complex) for order in wanted}
        for i, amounts in enumerate(sets):
            amounts = np.append(amounts, np.ones(len(first)))
            z = recording.with_laws(moving.model, loads, amounts, moving.laws, orders=marched)
            for order, part in z.items():
                found[order][which.ravel() == i] = part[which.ravel() == i]
        return found
