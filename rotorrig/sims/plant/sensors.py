"""From shaft motion to ADC counts: the probes' and the keyphasor's volts, noise, converter."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.chain import Chain
from rotorrig.sims.plant.latency import Latency
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Truth

FULL_SCALE_COUNTS = 32768  # 16 bit
VOLTS_PER_COUNT = 24.0 / FULL_SCALE_COUNTS  # +-24 V covers a proximity probe's supply

BENT_AT = 3e-4  # m from the gap voltage, where the scale factor's curvature is stated
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
        self._latency = Latency(chain.delay, sample_rate=sample_rate) if chain.delay.any() else None
        self._has_crosstalk = not np.array_equal(chain.mixing, np.eye(len(chain.mixing)))
        self._taken = 0  # samples so far: the tones' clock

    def counts(self, at_probes: NDArray[np.float64], theta: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return counts (sample, channel) for deflections (sample, probe, 2) [m] and shaft angles (sample,) [rad]."""
        volts = self._rng.standard_normal((len(theta), self.channels)) * self._rms
        near = _approach(at_probes, theta, self._per_sample * (self._taken + np.arange(len(theta))), self._chain)
        if self._has_crosstalk:
            near = _mix(near, self._chain.mixing)
        if self._latency:
            near = self._latency.delay(near)
        _add_probes(near, self._chain, volts)
        _add_keyphasor(theta, self._keyphasor, volts)
        self._taken += len(theta)
        return digitise(volts)


@njit(cache=True)
def apply_curvature(displacement: float, quadratic: float, cubic: float) -> float:
    """Return a probe's reading of a displacement [m]; the curvatures are relative, at 300 um from the gap voltage.

    >>> round(apply_curvature(3e-4, 0.002, -0.001) / 3e-4, 12)
    1.001
    """
    r = displacement / BENT_AT
    return displacement * (1.0 + r * (quadratic + r * cubic))


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
        tones = 0.0
        for k in range(len(chain.tones)):
            tones += chain.tones[k, 0] * math.cos(chain.tones[k, 1] * clock[i] + chain.tones[k, 2])
        for p in range(len(chain.channel)):
            towards = at_probes[i, p, 0] * chain.direction[p, 0] + at_probes[i, p, 1] * chain.direction[p, 1] + tones
            power = turn
            for n in range(chain.track.shape[1]):
                towards += (chain.track[p, n] * power).real
                power *= turn
            near[i, p] = towards
    return near


@njit(cache=True)
def _mix(near: NDArray, mixing: NDArray) -> NDArray:
    """Return each channel's share of all probes; in loops, as a library's product would depend on the block size."""
    shown = np.zeros_like(near)
    for i in range(len(near)):
        for p in range(near.shape[1]):
            for other in range(near.shape[1]):
                shown[i, p] += mixing[p, other] * near[i, other]
    return shown


@njit(cache=True)
def _add_probes(near: NDArray, chain: Chain, volts: NDArray) -> None:
    for i in range(len(near)):
        for p in range(len(chain.channel)):
            seen = apply_curvature(near[i, p], chain.curvature[p, 0], chain.curvature[p, 1])
            volts[i, chain.channel[p]] += chain.gap_voltage[p] + chain.volts_per_metre[p] * seen


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
