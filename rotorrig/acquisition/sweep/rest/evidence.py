"""Whether the rotor is at rest, by evidence: never by silence alone, never by the drive's word alone.

At rest is a rotor whose pulses were seen to become slower until one more could not be expected, on a keyphasor channel
that still reads as it did; or one of which the drive says so while a probe that saw it turn sees nothing move. Turning
is one that gives pulses. All else is unknown.
"""

import math
from collections import deque
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.sweep.rest.probe_motion import ProbeMotion
from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, KeyphasorSpeed, channel_volts

AT_REST = math.pi  # rad/s, 30 rpm: slower than that counts as rest
QUIET = 2.5  # s without a pulse: a shaft at 30 rpm gives one in 2 s
SHORT_GAP = 0.5  # s of missing samples, in which a rotor that was still does not begin to turn and stop again
LOOK_EVERY = 1.0  # s of samples between looks at the probes
FEWEST_TURNS = 2  # without a gap, to measure their 1X over
SLOWING = 3  # spacings of pulses at least, the last ones, that have to become longer
ONE_MORE = 1.5  # spacings that a rotor may turn on by its deceleration without giving a pulse that would be missed
HARDEST = 100.0  # rad/s^2: what no drive of such a rig slows down faster than
STEP = 0.1  # of the pulses' height, by which the keyphasor's level may leave their range
FLAT = 0.2  # of the pulses' height, that the keyphasor may move by in its silence: pulses that fade move it


class RotorState(StrEnum):
    """Answer to the question whether the rotor is at rest."""

    AT_REST = "at rest"
    TURNING = "turning"
    UNKNOWN = "unknown"


class RestEvidence:
    """Evidence gathered from every block of a sweep, from the first."""

    def __init__(self, rig: RigConfig, keyphasor: KeyphasorSpeed) -> None:
        assert rig.keyphasor
        self._keyphasor, self._info = keyphasor, keyphasor.info
        self._channel = rig.keyphasor.channel
        self._probe_channels = [probe.channel for probe in rig.probes]
        self._levels: tuple[float, float] | None = None  # V, of the keyphasor while it pulsed
        self._levels_hold = True  # since the last pulse
        #: (sample time of its end [s], lowest, highest [V]) of each of the last blocks, over QUIET seconds
        self._extremes: deque[tuple[float, float, float]] = deque()
        self._alive_at = -math.inf  # sample time of the last block since the last pulse whose samples differ
        self._pulses = 0
        #: sample times [s] of the last pulses, across gaps: one lost in a gap makes the turns around it no series
        self._edges: deque[float] = deque(maxlen=(SLOWING + 1) * keyphasor.pulses_per_turn)
        self._motion = ProbeMotion(rig, keyphasor.info)
        self._next_sample = 0
        self._looked = 0.0  # sample time of the last look at the probes
        self._still = False  # a probe that saw the rotor turn saw nothing move, when last looked

    def take(self, block: Block) -> None:
        """Take the next block, which the keyphasor has seen already."""
        if not len(block.counts):
            return
        if np.ptp(block.counts[:, self._probe_channels], axis=0).any():
            self._alive_at = self._keyphasor.time
        if block.first_sample > self._next_sample + SHORT_GAP * self._info.sample_rate:
            self._motion.forget()
            self._still = False
            self._extremes.clear()
        self._next_sample = block.first_sample + len(block.counts)
        self._watch_keyphasor(channel_volts(block.counts, channel=self._channel, info=self._info))
        self._motion.take(block)
        if self._keyphasor.time - self._looked >= LOOK_EVERY:
            self._looked = self._keyphasor.time
            self._look_at_probes()

    def take_as_rest(self) -> None:
        """Take what the probes have seen so far for the noise of a rotor at rest."""
        self._motion.measure_floor()

    def judge(self, *, drive_off: bool, fastest: float, stopped_at: float) -> RotorState:
        """Say whether the rotor is at rest.

        `drive_off`: the drive has said, since it was stopped, that it is off; `fastest` [rad/s]: what it can have come
        to by the ramps asked for; `stopped_at`: sample time [s] of the stop.
        """
        keyphasor = self._keyphasor
        if keyphasor.silence < QUIET:
            return RotorState.TURNING if keyphasor.pulses else RotorState.UNKNOWN
        if keyphasor.time - self._alive_at > QUIET:
            return RotorState.UNKNOWN
        quiet = self._levels_hold and self._levels is not None and self._is_flat()
        if quiet and self._slowed_to_a_stop():
            return RotorState.AT_REST
        proven = (fastest <= AT_REST and not keyphasor.pulses) or self._still
        if drive_off and (proven or (quiet and self._stopped_within_a_turn(stopped_at))):
            return RotorState.AT_REST
        return RotorState.UNKNOWN

    def _watch_keyphasor(self, volts: NDArray[np.float64]) -> None:
        low, high = float(volts.min()), float(volts.max())
        self._extremes.append((self._keyphasor.time, low, high))
        while len(self._extremes) > 1 and self._extremes[1][0] <= self._keyphasor.time - QUIET:
            self._extremes.popleft()
        if self._keyphasor.pulses > self._pulses:
            self._edges.extend(self._keyphasor.last_edges[self._pulses - self._keyphasor.pulses :])
            self._pulses = self._keyphasor.pulses
            before = self._levels or (low, high)
            self._levels = min(low, before[0]), max(high, before[1])
            self._levels_hold, self._alive_at = True, -math.inf
            return
        if self._levels:
            room = STEP * (self._levels[1] - self._levels[0])
            if low < self._levels[0] - room or high > self._levels[1] + room:
                self._levels_hold = False

    def _look_at_probes(self) -> None:
        keyphasor = self._keyphasor
        turning = keyphasor.steady_speed >= AT_REST and keyphasor.silence < QUIET
        if turning and len(keyphasor.turns) > FEWEST_TURNS:
            self._motion.measure_1x(keyphasor.turns)
        self._still = not turning and self._motion.sees_nothing_move()

    def _is_flat(self) -> bool:
        """Whether the keyphasor's level was seen not to move in its silence."""
        assert self._levels
        if self._extremes[0][0] > self._keyphasor.time - QUIET:
            return False
        low, high = min(low for _, low, _ in self._extremes), max(high for _, _, high in self._extremes)
        return high - low <= FLAT * (self._levels[1] - self._levels[0])

    def _slowed_to_a_stop(self) -> bool:
        """Whether the last turns became slower, by so much that no further pulse was to be expected after the last."""
        edges, per_turn = np.array(self._edges), self._keyphasor.pulses_per_turn
        if len(edges) < SLOWING + per_turn:
            return False
        turns = (edges[per_turn:] - edges[:-per_turn])[-SLOWING:]
        if np.any(np.diff(turns) <= 0):
            return False
        middles = edges[-SLOWING:] - turns / 2
        speeds = math.tau / turns
        deceleration = (speeds[0] - speeds[-1]) / (middles[-1] - middles[0])
        at_last_edge = max(speeds[-1] - deceleration * turns[-1] / 2, 0.0)
        return bool(at_last_edge**2 / (2 * deceleration) <= ONE_MORE * math.tau / per_turn)

    def _stopped_within_a_turn(self, stopped_at: float) -> bool:
        """Whether pulses came until the stop, and so slowly that the rotor could stop before the next."""
        edges, turned = np.array(self._edges), math.tau / self._keyphasor.pulses_per_turn
        if not len(edges):
            return False
        spacing = edges[-1] - edges[-2] if len(edges) > 1 else QUIET
        slow = (turned / spacing) ** 2 <= 2 * HARDEST * turned
        return bool(slow and edges[-1] > stopped_at - ONE_MORE * spacing)
