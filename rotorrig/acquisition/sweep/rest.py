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

from rotorrig.rig.config import RigConfig
from rotorrig.rig.probes import Block, KeyphasorSpeed, ProbeScale, channel_volts

AT_REST = math.pi  # rad/s, 30 rpm: slower than that counts as rest
QUIET = 2.5  # s without a pulse: a shaft at 30 rpm gives one in 2 s
STILL_SECONDS = 8.0  # of samples, four turns at 30 rpm, in which a probe has to see nothing move
LOOK_EVERY = 1.0  # s of samples between measurements of the vibration at speed
SLOWING = 3  # spacings of pulses at least, the last ones, that have to become longer
ONE_MORE = 1.5  # spacings that a rotor may turn on by its deceleration without giving a pulse that would be missed
HARDEST = 100.0  # rad/s^2: what no drive of such a rig slows down faster than
STEP = 0.1  # of the pulses' height, by which the keyphasor's level may leave their range
GONE = 0.5  # of the least vibration seen at speed, which the vibration at rest has to stay below
SHORT_GAP = 0.5  # s of missing samples, in which a rotor that was still does not begin to turn and stop again
DETAIL = 2000.0  # Hz, rate to which the probes' samples are thinned out


class RotorState(StrEnum):
    """Answer to the question whether the rotor is at rest."""

    AT_REST = "at rest"
    TURNING = "turning"
    UNKNOWN = "unknown"


class RestEvidence:
    """Evidence gathered from every block of a sweep, from the first."""

    def __init__(self, rig: RigConfig, keyphasor: KeyphasorSpeed) -> None:
        assert rig.keyphasor
        self._keyphasor, self._info, self._rate = keyphasor, keyphasor.info, keyphasor.info.sample_rate
        self._channel = rig.keyphasor.channel
        self._scale = ProbeScale.of(rig, keyphasor.info)
        self._levels: tuple[float, float] | None = None  # V, of the keyphasor while it pulsed
        self._levels_hold = True  # since the last pulse
        self._alive_at = -math.inf  # sample time of the last block since the last pulse whose samples differ
        self._pulses = 0
        #: sample times [s] of the last pulses, across gaps: one lost in a gap makes the turns around it no series
        self._edges: deque[float] = deque(maxlen=(SLOWING + 1) * keyphasor.pulses_per_turn)
        self._probes: deque[NDArray[np.float64]] = deque()  # of the last seconds, (sample, probe), m, thinned out
        self._thinned_rate = math.nan  # Hz
        self._length = 0  # samples in it
        self._next_sample = 0
        self._looked = 0.0  # sample time of the last measurement
        self._turning_since = math.inf  # sample time since when the rotor turns; infinite: it does not
        self._still = False  # a probe that saw the rotor turn saw nothing move, when last looked
        self._least = np.full(len(rig.probes), np.inf)  # (probe,) least vibration [m] seen at speed, sqrt(2) rms

    def take(self, block: Block) -> None:
        """Take the next block, which the keyphasor has seen already."""
        if not len(block.counts):
            return
        if np.ptp(block.counts[:, self._scale.channels], axis=0).any():
            self._alive_at = self._keyphasor.time
        self._watch_keyphasor(channel_volts(block.counts, channel=self._channel, info=self._info))
        if block.first_sample > self._next_sample + SHORT_GAP * self._rate:
            self._probes.clear()
            self._length = 0
            self._still = False
        self._next_sample = block.first_sample + len(block.counts)
        self._keep(block)
        if self._keyphasor.time - self._looked >= LOOK_EVERY:
            self._looked = self._keyphasor.time
            self._measure_vibration()
            self._still = self._probes_see_nothing_move()

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
        if self._levels_hold and self._slowed_to_a_stop():
            return RotorState.AT_REST
        proven = (fastest <= AT_REST and not keyphasor.pulses) or self._still
        if drive_off and (proven or (self._levels_hold and self._stopped_within_a_turn(stopped_at))):
            return RotorState.AT_REST
        return RotorState.UNKNOWN

    def _watch_keyphasor(self, volts: NDArray[np.float64]) -> None:
        low, high = float(volts.min()), float(volts.max())
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

    def _keep(self, block: Block) -> None:
        """Keep the probes' samples of the last seconds, thinned out by means of neighbours."""
        group = max(1, round(self._rate / DETAIL))
        rows = len(block.counts) // group
        if not rows:
            return
        self._thinned_rate = self._rate / group
        counts = block.counts[: rows * group, self._scale.channels].reshape(rows, group, -1)
        self._probes.append(counts.mean(axis=1) * self._scale.gain)
        self._length += rows
        while self._length - len(self._probes[0]) >= STILL_SECONDS * self._thinned_rate:
            self._length -= len(self._probes.popleft())

    def _measure_vibration(self) -> None:
        """Note the least vibration of each probe while the rotor turns, over the last second or two turns."""
        keyphasor = self._keyphasor
        if keyphasor.steady_speed < AT_REST or keyphasor.silence > QUIET:
            self._turning_since = math.inf
            return
        self._turning_since = min(self._turning_since, keyphasor.time)
        seconds = max(LOOK_EVERY, 2 * math.tau / keyphasor.steady_speed)
        samples = round(seconds * self._thinned_rate)
        if keyphasor.time - self._turning_since < seconds or samples > self._length:
            return
        signal = np.concatenate(self._probes)[-samples:]
        self._least = np.minimum(self._least, np.sqrt(2) * signal.std(axis=0))

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

    def _probes_see_nothing_move(self) -> bool:
        """Whether a probe that saw the rotor turn has seen nothing of it for long enough."""
        if self._length < STILL_SECONDS * self._thinned_rate - 1:
            return False
        signal = np.concatenate(self._probes)
        time = np.linspace(-1.0, 1.0, len(signal))
        signal = signal - signal.mean(axis=0) - np.outer(time, time @ signal / (time @ time))
        pieces = np.array_split(signal, int(STILL_SECONDS))
        moving = np.max([np.sqrt(2) * piece.std(axis=0) for piece in pieces], axis=0)
        seen = np.isfinite(self._least)
        return bool(np.any(seen & (moving > 0) & (moving < GONE * self._least)))
