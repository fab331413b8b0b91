"""From shaft motion to ADC counts: the probes' and the keyphasor's volts, noise, converter."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.deviations import WARMING
from rotorrig.sims.plant.sensors.bracket import Brackets
from rotorrig.sims.plant.sensors.chain import MAINS, STRAY, STRAY_PERIOD, Chain
from rotorrig.sims.plant.sensors.low_pass import LowPass
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Truth

FULL_SCALE_COUNTS = 32768  # 16 bit
VOLTS_PER_COUNT = 24.0 / FULL_SCALE_COUNTS  # +-24 V covers a proximity probe's supply

BENT_AT = 3e-4  # m from the gap voltage, where the scale factor's curvature is stated
#: how far the scale factor is off over displacement, as parts of what it is at `BENT_AT`: of a probe that is moved
#: off the middle of its range, and of one whose field spreads beyond its target. Both level off towards the ends of the
#: range, as calibration sheets of drivers of 8 mm probes show, checked every 10 mils (API 670, 5th ed., annex on
#: calibration; the figures are an estimate after such sheets)
OFF_AT = 1e-4 * np.array([0.0, 1.0, 2.0, 3.0, 4.5, 6.0, 9.0, 12.0])
OFF_MIDDLE = np.array([0.0, 0.42, 0.76, 1.0, 1.22, 1.35, 1.5, 1.55])
OFF_TARGET = np.array([0.0, 0.14, 0.51, 1.0, 1.7, 2.2, 2.8, 3.0])
FIELD = 2e-3  # m of gap by which two probes' fields grow into each other by e: some 2/3 of the coil's mean radius
IDLE_NOISE = 5e-4  # V rms of a channel with a shorting plug

NOTCH = math.radians(20.0)  # angle of the keyphasor notch
NOTCH_SHARE = 0.4  # of the spacing of several notches, at most
DISPLACED = 0.25  # of their spacing: how much too early the last of several is, so that the first can be told
NOTCH_EDGE = math.radians(2.0)  # the probe tip's width against the notch's edge
SURFACE_VOLTS, NOTCH_VOLTS = -10.0, -16.0  # over the shaft, over the bottom of the notch


class Sensors:
    """All channels of the DAQ: from the motion at the probes' places to counts."""

    def __init__(self, rig: RigConfig, truth: Truth, chain: Chain, *, sample_rate: float) -> None:
        self._chain = chain
        self._keyphasor = _make_keyphasor(rig, truth)
        taken = [p.channel for p in rig.probes] + ([rig.keyphasor.channel] if rig.keyphasor else [])
        self.channels = max(taken) + 1
        self._rms = np.full(self.channels, IDLE_NOISE if truth.noise.probe else 0.0)
        self._rms[chain.channel] = truth.noise.probe
        if rig.keyphasor:
            self._rms[rig.keyphasor.channel] = truth.noise.keyphasor
        self._rng = stream(truth.seed, "sensor noise", run=truth.run)
        self._per_sample = math.tau / sample_rate
        self._brackets = Brackets(chain.brackets, sample_rate=sample_rate) if chain.brackets[:, 0].any() else None
        self._low_pass = LowPass(chain.delay, sample_rate=sample_rate) if chain.delay.any() else None
        self._has_crosstalk = not np.array_equal(chain.mixing, np.eye(len(chain.mixing)))
        self._taken = 0  # samples so far: the tones' clock

    def counts(
        self,
        at_probes: NDArray[np.float64],
        theta: NDArray[np.float64],
        at_keyphasor: NDArray[np.float64] | None = None,
    ) -> NDArray[np.int32]:
        """Return counts (sample, channel) for deflections (sample, probe, 2) [m] and shaft angles (sample,) [rad].

        `at_keyphasor` are the angles that the keyphasor sees, unless it sees `theta`.
        """
        volts = self._rng.standard_normal((len(theta), self.channels)) * self._rms
        clock = self._per_sample * (self._taken + np.arange(len(theta)))
        near = _approach(at_probes, theta, clock, self._chain)
        if self._brackets:
            near -= self._brackets.move(np.sum(at_probes * self._chain.direction, axis=2))
        if self._has_crosstalk:
            near = _mix(near, self._chain.mixing)
        if self._low_pass:
            near = self._low_pass.filter(near)
        _add_probes(near, clock, self._chain, volts)
        _add_keyphasor(theta if at_keyphasor is None else at_keyphasor, self._keyphasor, volts)
        self._taken += len(theta)
        return digitise(volts)


@njit(cache=True)
def apply_curvature(displacement: float, off_middle: float, off_target: float) -> float:
    """Return a probe's reading of a displacement [m] by its calibration table, straight between its points.

    The scale factor is off by `off_middle` 300 um nearer than the gap voltage and by as little 300 um further away, and
    by `off_target` on either side. Dodd and Deeds, J. Appl. Phys. 39 (1968) 2829: the field of a coil over a conductor
    falls off as a sum of exponentials, which no driver straightens at both ends of its range.

    >>> round(apply_curvature(3e-4, 0.002, -0.001) / 3e-4, 12)
    1.001
    """
    size = abs(displacement)
    i = 1
    while i < len(OFF_AT) - 1 and size > OFF_AT[i]:
        i += 1
    share = min((size - OFF_AT[i - 1]) / (OFF_AT[i] - OFF_AT[i - 1]), 1.0)
    odd = OFF_MIDDLE[i - 1] + share * (OFF_MIDDLE[i] - OFF_MIDDLE[i - 1])
    even = OFF_TARGET[i - 1] + share * (OFF_TARGET[i] - OFF_TARGET[i - 1])
    return displacement * (1.0 + off_middle * math.copysign(odd, displacement) + off_target * even)


@njit(cache=True)
def notch(angle: float, notches: int) -> float:
    """Return the keyphasor's volts at shaft `angle` [rad] past the middle of the first notch's leading (falling) edge.

    Several notches are evenly spaced, but for the last, which comes a quarter of a spacing early: the widest spacing
    is that before the first.

    >>> [round(notch(math.radians(degrees), 1), 9) for degrees in (-180.0, 0.0, 10.0, 20.0)]
    [-10.0, -13.0, -16.0, -13.0]
    >>> [round(notch(math.radians(degrees), 4), 9) for degrees in (0.0, 90.0, 180.0, 247.5, 270.0)]
    [-13.0, -13.0, -13.0, -13.0, -10.0]
    """
    spacing = math.tau / notches
    width = notch_width(notches)
    depth = 0.0
    nearest = round((angle - width / 2) / spacing)
    for k in range(nearest - 1, nearest + 2):
        start = spacing * (k - (DISPLACED if notches > 1 and k % notches == notches - 1 else 0.0))
        depth = max(depth, 0.5 + (width / 2 - abs(angle - start - width / 2)) / NOTCH_EDGE)
    return SURFACE_VOLTS + (NOTCH_VOLTS - SURFACE_VOLTS) * min(depth, 1.0)


@njit(cache=True)
def notch_width(notches: int) -> float:
    """Return the angle [rad] that each of so many notches takes."""
    return min(NOTCH, NOTCH_SHARE * math.tau / notches)


@njit(cache=True)
def digitise(volts: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return ADC counts (sample, channel), clipped at the converter's ends.

    >>> digitise(np.array([[0.0, -12.0], [30.0, -30.0]])).tolist()
    [[0, -16384], [32767, -32768]]
    """
    counts = np.empty(volts.shape, np.int32)
    for i in range(volts.shape[0]):
        for k in range(volts.shape[1]):
            ideal = np.rint(volts[i, k] / VOLTS_PER_COUNT)
            counts[i, k] = int(min(max(ideal, -FULL_SCALE_COUNTS), FULL_SCALE_COUNTS - 1))
    return counts


@njit(cache=True)
def _approach(at_probes: NDArray, theta: NDArray, clock: NDArray, chain: Chain) -> NDArray:
    """Return how far the surface is towards each probe (sample, probe) [m]; `clock` in rad per hertz of a tone."""
    near = np.empty((len(theta), len(chain.channel)))
    for i in range(len(theta)):
        turn = complex(math.cos(theta[i]), math.sin(theta[i]))
        # the mains' own clock, which runs fast and slow by turns
        beat = STRAY_PERIOD / math.tau
        mains = clock[i] + STRAY * math.tau * beat * math.sin(clock[i] / (math.tau * beat) + chain.stray)
        for p in range(len(chain.channel)):
            towards = at_probes[i, p, 0] * chain.direction[p, 0] + at_probes[i, p, 1] * chain.direction[p, 1]
            for k in range(len(chain.tones)):
                towards += chain.tones[k, p, 0] * math.cos(chain.tones[k, p, 1] * mains + chain.tones[k, p, 2])
            power = turn
            for n in range(chain.track.shape[1]):
                towards += (chain.track[p, n] * power).real
                power *= turn
            near[i, p] = towards
    return near


@njit(cache=True)
def _mix(near: NDArray, mixing: NDArray) -> NDArray:
    """Return each channel's share of all probes; in loops, as a library's product would depend on the block size.

    What a probe takes of another's field is less the nearer the surface is to either tip, which keeps the field in.
    """
    shown = np.zeros_like(near)
    for i in range(len(near)):
        for p in range(near.shape[1]):
            for other in range(near.shape[1]):
                share = mixing[p, other]
                if p != other and share != 0.0:
                    share *= math.exp(-(near[i, p] + near[i, other]) / FIELD)
                shown[i, p] += share * near[i, other]
    return shown


@njit(cache=True)
def _add_probes(near: NDArray, clock: NDArray, chain: Chain, volts: NDArray) -> None:
    """Add what the probes' drivers put out; they warm up from the plant's first sample on."""
    ripple, phase = chain.ripple
    drifts = np.any(chain.drift != 0.0)
    warm, common = 0.0, 0.0
    for i in range(len(near)):
        if drifts:
            warm = 1.0 - math.exp(-clock[i] / (math.tau * WARMING))
        if ripple != 0.0:
            common = ripple * math.cos(2.0 * MAINS * clock[i] + phase)
        for p in range(len(chain.channel)):
            place = near[i, p] + warm * chain.drift[p, 1]
            seen = apply_curvature(place, chain.curvature[p, 0], chain.curvature[p, 1])
            scale = chain.volts_per_metre[p] * (1.0 + warm * chain.drift[p, 0])
            volts[i, chain.channel[p]] += chain.gap_voltage[p] + scale * seen + common


@njit(cache=True)
def _add_keyphasor(theta: NDArray, keyphasor: tuple[int, float, int], volts: NDArray) -> None:
    channel, edge, notches = keyphasor
    if channel >= 0:
        for i in range(len(theta)):
            volts[i, channel] += notch(theta[i] - edge, notches)


def _make_keyphasor(rig: RigConfig, truth: Truth) -> tuple[int, float, int]:
    """Return channel (-1: none), the shaft angle [rad] of the first notch's falling edge, and how many there are."""
    if rig.keyphasor is None:
        return -1, 0.0, 1
    notches = rig.keyphasor.pulses_per_revolution
    # the rising edge follows the falling one by the notch's width
    late = 0.0 if rig.keyphasor.edge == "falling" else notch_width(notches)
    return rig.keyphasor.channel, truth.keyphasor_offset - late, notches
