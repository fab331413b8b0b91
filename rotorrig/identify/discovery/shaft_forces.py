"""First order of forces along the shaft: what a force of every law, at every place, would change of the vectors at 1X.

A force is a phasor that turns with the shaft and one that turns against it. The vectors go with either through the
receptance from its place to the probes; the phasors go with the motion of the place, that of the fit so far, by the
law. In a sweep that takes the law's change over a row's window for nothing, which is near enough for a search.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.causes import responses_to
from rotorrig.identify.extended_model import ExtendedProblem, Recording
from rotorrig.sims.effects import Law, forward, position_rows, slope_rows
from rotorrig.sims.rotor.model import Load, RotorModel

Complex = NDArray[np.complex128]


class ShaftForces:
    """Forces at places [m] of the shaft, beside the effects of a problem at its fit `p`.

    Forces go with the motion of that fit, or with that of `moved`, another problem of the same recordings at its fit:
    with the motion as it is under a force, the change by that force is exact, however large it is.
    """

    def __init__(
        self, problem: ExtendedProblem, p: Reals, places: Reals, *, moved: tuple[ExtendedProblem, Reals] | None = None
    ) -> None:
        """Set up; takes a second or two for some fifty places."""
        self.places = places
        self._problem = problem
        self._units = [self._unit_responses(recording, p) for recording in problem.recordings]
        self._motion = self._motions(*(moved or (problem, p)))
        self._omega = [np.abs(recording.view(1).omega) for recording in problem.recordings]

    def columns(self, law: Law) -> Reals:
        """Return the change of the vectors at 1X per unit of each unknown, in sigmas, (value, place, unknown)."""
        kind = int(law.tilts)
        changes = []
        for units, motion, omega in zip(self._units, self._motion, self._omega, strict=True):
            forces = _unit_forces(law, motion[:, kind], omega)
            changes.append(np.einsum("rpzs,urzs->rpzu", units[:, :, kind], forces))
        return self._whiten(changes)

    def turning(self, weights: Sequence[Reals], *, tilts: bool = False) -> Reals:
        """Return the change by given forces at the one place, times functions of the row (row + 1, function).

        (value, function, 4): re and im of what turns with the shaft, then of what turns against it.
        """
        changes = []
        for units, weight in zip(self._units, weights, strict=True):
            both = np.einsum("rps,rf->rpfs", units[:, :, int(tilts), 0], weight)
            changes.append(np.stack([both, 1j * both], axis=-1).reshape(*both.shape[:3], 4))
        return self._whiten(changes)

    def forces(self, law: Law, amounts: Reals) -> list[Complex]:
        """Return the force of a law with these unknowns at the one place, per recording (row + 1, sense) N or N m."""
        pairs = zip(self._motion, self._omega, strict=True)
        return [
            np.einsum("urs,u->rs", _unit_forces(law, motion[:, int(law.tilts)], omega)[:, :, 0], amounts)
            for motion, omega in pairs
        ]

    @property
    def motions(self) -> list[Complex]:
        """The motion of the one place at 1X, per recording (row + 1, sense) m."""
        return [motion[:, 0, 0] for motion in self._motion]

    def _unit_responses(self, recording: Recording, p: Reals) -> Complex:
        """Return the vectors by a unit of force, (row + 1, probe, kind, place, sense) m per N or N m."""
        model = self._problem.model
        rotor = model.rotor(p)
        ahead = [forward(place, rotor.rotation) for kind in _rows(rotor, self.places) for place in kind]
        loads = [Load(pattern=turned, law="constant") for each in ahead for turned in (each, each.conj())]
        answers = responses_to(recording, rotor, loads, 1)
        units = np.stack([model.probes.linear(p, z) for z in np.moveaxis(answers, -1, 0)], axis=-1)
        return units.reshape(*units.shape[:2], 2, len(self.places), 2)

    def _motions(self, problem: ExtendedProblem, p: Reals) -> list[Complex]:
        """Return the motion of every place, per recording (row + 1, kind, place, sense) m or rad."""
        rotor = problem.model.rotor(p)
        rows = _rows(rotor, self.places).reshape(-1, rotor.dof)
        found = []
        for recording in problem.recordings:
            z = problem.model.motion_at(recording, p, rows)
            x, y = np.moveaxis(z.reshape(len(z), 2, len(self.places), 2), -1, 0)
            across = 1j * rotor.rotation * y
            found.append(np.stack([x + across, x - across], axis=-1) / 2)
        return found

    def _whiten(self, changes: Sequence[Complex]) -> Reals:
        """Return changes of the vectors at 1X, (row + 1, probe, ...) per recording, in sigmas, (value, ...)."""
        pairs = zip(self._problem.recordings, changes, strict=True)
        white = [
            (recording.measured[1].sigmas(change.reshape(*change.shape[:2], -1)), change.shape[2:])
            for recording, change in pairs
        ]
        return np.concatenate([each.reshape(-1, *shape) for each, shape in white])


def is_first_order(problem: ExtendedProblem) -> NDArray[np.bool_]:
    """Return which residuals of a problem are of vectors at 1X."""
    sizes = [(order, m.whiten[..., 0].size) for r in problem.recordings for order, m in r.measured.items()]
    priors = len(problem.parameters.priors)
    return np.concatenate([*(np.full(size, order == 1) for order, size in sizes), np.zeros(priors, bool)])


def _unit_forces(law: Law, motion: Complex, omega: Reals) -> Complex:
    """Return the force per unit of each unknown, (unknown, row + 1, place, sense); `motion` (row + 1, place, sense)."""
    f, b = np.moveaxis(motion, -1, 0)
    units = law.units(f, b, np.broadcast_to(omega[:, None], f.shape))
    return np.stack([np.stack(each, axis=-1) for each in units])


def _rows(rotor: RotorModel, places: Reals) -> Reals:
    """Return the rows that read the positions and the slopes of the shaft, (kind, place, 2, dof)."""
    return np.stack([[of(rotor, z) for z in places] for of in (position_rows, slope_rows)])
