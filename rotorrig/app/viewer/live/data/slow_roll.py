"""Slow roll of a running sweep: vector and waveform, averaged over the turns at a plan's slow-roll speed so far."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.viewer.live.data.tracker import Turns
from rotorrig.app.viewer.live.data.waveform import POINTS, Waveform
from rotorrig.rig.config import RPM, RigConfig, RunUpCoastDown, RunUpRampDown, Stepped

NEAR = 0.1  # relative: turns nearer than this to a plan's slow-roll speed are slow roll
FEWEST = 8  # turns; fewer make no vector


class SlowRollSoFar:
    """Averages turns at the slow-roll speed; nothing before FEWEST of them."""

    def __init__(self, rig: RigConfig) -> None:
        self.turns = 0
        self._speeds = slow_roll_speeds(rig)
        self._omega = 0.0  # sums, over the turns
        self._z: NDArray[np.complex128] = np.zeros(len(rig.probes), dtype=complex)
        self._shape = np.zeros((POINTS, len(rig.probes)))
        self._shapes = 0  # turns in _shape
        self._seen = 0.0  # s: turns before are in _shape already

    @property
    def known(self) -> bool:
        """True once there is a vector to subtract."""
        return self.turns >= FEWEST and self._shapes > 0

    @property
    def z(self) -> NDArray[np.complex128]:
        """The 1X vector (probe,) [m 0-peak]."""
        return self._z / max(self.turns, 1)

    @property
    def shape(self) -> NDArray[np.float64]:
        """The waveform about its mean over one turn, (POINTS, probe) [m]."""
        return self._shape / max(self._shapes, 1)

    @property
    def words(self) -> str:
        """Say what is subtracted, or why nothing is."""
        if self.known:
            return f"slow roll of {self.turns} turns at {self._omega / self.turns * RPM:.0f} rpm"
        if not self._speeds:
            return "no slow roll: no plan of the config has one"
        return f"no slow roll seen yet, at {' or '.join(f'{speed * RPM:.0f}' for speed in self._speeds)} rpm"

    def add(self, turns: Turns, waveform: Waveform | None) -> None:
        """Add turns that have ended, and the waveform of the last ones."""
        slow = self._is_slow(turns.omega)
        self.turns += int(slow.sum())
        self._omega += float(turns.omega[slow].sum())
        self._z = self._z + turns.z[slow].sum(axis=0)
        if waveform is not None and slow.any():
            fresh = waveform.edges[1:] > self._seen
            fresh &= self._is_slow(2 * np.pi / np.diff(waveform.edges))
            shapes = waveform.by_turn()[fresh]
            self._shape += (shapes - shapes.mean(axis=1, keepdims=True)).sum(axis=0)
            self._shapes += int(fresh.sum())
            self._seen = float(waveform.edges[-1])

    def _is_slow(self, omega: NDArray[np.float64]) -> NDArray[np.bool_]:
        near = [np.abs(omega - speed) < NEAR * speed for speed in self._speeds]
        return np.any(near, axis=0) if near else np.zeros(len(omega), dtype=bool)


def slow_roll_speeds(rig: RigConfig) -> tuple[float, ...]:
    """Return the speeds [rad/s] at which the config's plans roll slowly, lowest first."""
    rolls = (RunUpCoastDown, RunUpRampDown, Stepped)
    return tuple(sorted({plan.slow_roll for plan in rig.plans.values() if isinstance(plan, rolls)}))
