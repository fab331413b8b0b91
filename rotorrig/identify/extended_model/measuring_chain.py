"""Measuring chain, from motion to readings, in the order of a signal's path.

Where a probe looks and what it makes of the gap, with the effects on that; the hum that its cable picks up, which knows
nothing of either; then the effects on what was recorded.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model.parameters import ExtendedParameters
from rotorrig.identify.extended_model.tracked_recording import Recording

Complex = NDArray[np.complex128]


class ProbeSide:
    """Vectors of an order, (row + 1, probe) [m], of a motion along and across every probe, (row + 1, 2 probe)."""

    def __init__(self, parameters: ExtendedParameters) -> None:
        """Serve the vectors `p` of these parameters."""
        self._parameters = parameters

    def seen(self, recording: Recording, p: Reals, motion: Mapping[int, Complex]) -> dict[int, Complex]:
        """Return vectors as they should have been measured, of motions at 1X and other orders."""
        found = {}
        first = self.of_motion(p, motion[1], order=1)
        for order, moved in motion.items():
            z = self.of_motion(p, moved, order=order) + self.bent(p, first, order)
            found[order] = self.through_effects(recording, p, z, order=order)
        return found

    def of_motion(self, p: Reals, motion: Complex, *, order: int) -> Complex:
        """Return vectors of a motion: gain and angle errors and runout applied."""
        runout = p[self._parameters.runouts[order]]
        return self.linear(p, motion) + runout[0::2] + 1j * runout[1::2]

    def linear(self, p: Reals, change: Complex) -> Complex:
        """Return changes of vectors by a change of the motion."""
        gain, cos, sin = self.figures(p)
        n = len(gain)
        return gain * (cos * change[:, :n] + sin * change[:, n:])

    def bent(self, p: Reals, first: Complex, order: int) -> Complex:
        """Return what the curvature of the probes' readings adds to an order, of 1X vectors `first`."""
        return self._parameters.probe_curves.bend(p[self._parameters.curves], first, order)

    def bent_changes(self, p: Reals, first: Complex, changes: Complex, order: int) -> Complex:
        """Return how `bent` goes with small changes of the 1X vectors, (row + 1, probe, column)."""
        return self._parameters.probe_curves.changes(p[self._parameters.curves], first, changes, order)

    def hum(self, recording: Recording, p: Reals, order: int) -> Complex:
        """Return what the mains leave in the vectors of every probe, (row + 1, probe)."""
        names, leaks = self._parameters, recording.hum[order]
        found = np.zeros((len(recording.rows) + 1, len(recording.response.probes)), complex)
        amounts = p[names.hums].reshape(-1, 2)
        for (number, frequency), (real, imaginary) in zip(names.hum_lines, amounts, strict=True):
            if number == recording.number and frequency in leaks:
                found += leaks[frequency] * complex(real, imaginary)
        return found

    def through_effects(self, recording: Recording, p: Reals, z: Complex, *, order: int) -> Complex:
        """Return vectors as they are recorded, of what the base's probes read: hum and all effects on this side."""
        return self.record(recording, p, self.read(recording, p, z, order=order), order=order)

    def read(self, recording: Recording, p: Reals, z: Complex, *, order: int) -> Complex:
        """Return vectors as the effects on the probes leave them, before hum."""
        return self._apply_effects(recording, p, z, order=order, after_hum=False)

    def record(self, recording: Recording, p: Reals, z: Complex, *, order: int) -> Complex:
        """Return vectors with hum, as the effects on what is recorded leave them."""
        return self.change_recorded(recording, p, z + self.hum(recording, p, order), order=order)

    def change_recorded(self, recording: Recording, p: Reals, z: Complex, *, order: int) -> Complex:
        """Return vectors, hum included, as the effects on what is recorded leave them."""
        return self._apply_effects(recording, p, z, order=order, after_hum=True)

    def _apply_effects(self, recording: Recording, p: Reals, z: Complex, *, order: int, after_hum: bool) -> Complex:
        for i, effect in enumerate(self._parameters.effects):
            if effect.after_hum == after_hum and effect.recording in (None, recording.number):
                z = effect.change_readings(z, recording.view(order), self._parameters.of_effect(p, i))
        return z

    def figures(self, p: Reals) -> tuple[Reals, Reals, Reals]:
        """Return gain, and cosine and sine of the angle error, per probe."""
        base = self._parameters.base
        angle = p[base.angle]
        return 1 + p[base.gain], np.cos(angle), np.sin(angle)
