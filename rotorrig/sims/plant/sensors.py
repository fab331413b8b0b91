"""From shaft motion to ADC counts: run-out, gap, the probes' and the keyphasor's volts, noise, hum, converter.

A probe sees the shaft come nearer, x cos a + y sin a, plus the track of the surface under it. Tracks belong to a plane:
two probes at one place see the same one, shifted by their angle, plus a little electrical run-out of their own.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig.description import RigConfig
from rotorrig.sims.plant.shaft import SAME_PLACE
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Truth

FULL_SCALE_COUNTS = 32768  # 16 bit
VOLTS_PER_COUNT = 24.0 / FULL_SCALE_COUNTS  # +-24 V covers a proximity probe's supply

HARMONICS = 5  # of the run-out track
FIRST_RUNOUT = (2e-6, 5e-6)  # m, 0-peak at 1X, ground steel; harmonic n has 1/n of it, give or take a half
ELECTRICAL_RUNOUT = 2e-7  # m, 0-peak per harmonic and probe: magnetic spots seen by one probe alone
BENT_AT = 3e-4  # m from the gap voltage, where the scale factor's curvature is stated
MAINS = 50.0  # Hz
IDLE_NOISE = 5e-4  # V rms of a channel with a shorting plug

NOTCH = math.radians(20.0)  # angle of the keyphasor notch
NOTCH_EDGE = math.radians(2.0)  # the probe tip's width against the notch's edge
SURFACE_VOLTS, NOTCH_VOLTS = -10.0, -16.0  # over the shaft, over the bottom of the notch


class _Probes(NamedTuple):
    """What the probes are, one row each, in the config's order."""

    channel: NDArray[np.intp]  # (probe,)
    direction: NDArray[np.float64]  # (probe, 2) cosine and sine of the true angle
    track: NDArray[np.complex128]  # (probe, harmonic) m, run-out Re(track e^{j n theta})
    curvature: NDArray[np.float64]  # (probe, 2) see `bent`
    volts_per_metre: NDArray[np.float64]  # (probe,)
    gap_voltage: NDArray[np.float64]  # (probe,)


class Sensors:
    """All channels of the DAQ: fed the motion at the probes' places, it gives counts."""

    def __init__(self, rig: RigConfig, truth: Truth, *, sample_rate: float) -> None:
        self._probes = _make_probes(rig, truth)
        self._keyphasor = _make_keyphasor(rig, truth)
        taken = [p.channel for p in rig.probes] + ([rig.keyphasor.channel] if rig.keyphasor else [])
        self.channels = max(taken) + 1
        self._rms = np.full(self.channels, IDLE_NOISE if truth.noise.probe else 0.0)
        self._rms[self._probes.channel] = truth.noise.probe
        if rig.keyphasor:
            self._rms[rig.keyphasor.channel] = truth.noise.keyphasor
        self._rng = stream(truth.seed, "sensor noise")
        phase = float(stream(truth.seed, "mains").uniform(0.0, math.tau))
        self._hum = (truth.noise.hum, math.tau * MAINS / sample_rate, phase)
        self._taken = 0  # samples so far: the mains' clock

    def counts(self, at_probes: NDArray[np.float64], theta: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return counts (sample, channel) for deflections (sample, probe, 2) [m] and shaft angles (sample,) [rad]."""
        volts = self._rng.standard_normal((len(theta), self.channels)) * self._rms
        _add_probes(at_probes, theta, self._taken, self._hum, self._probes, volts)
        _add_keyphasor(theta, self._keyphasor, volts)
        self._taken += len(theta)
        return digitised(volts)


@njit(cache=True)
def bent(displacement: float, quadratic: float, cubic: float) -> float:
    """Return what a probe makes of a displacement [m]; the curvatures are relative, at 300 um from the gap voltage.

    >>> round(bent(3e-4, 0.002, -0.001) / 3e-4, 12)
    1.001
    """
    r = displacement / BENT_AT
    return displacement * (1.0 + r * (quadratic + r * cubic))


@njit(cache=True)
def notch(angle: float) -> float:
    """Return the keyphasor's volts at shaft `angle` [rad] past the middle of the notch's leading (falling) edge.

    >>> [round(notch(math.radians(degrees)), 9) for degrees in (-180.0, 0.0, 10.0, 20.0)]
    [-10.0, -13.0, -16.0, -13.0]
    """
    from_centre = abs((angle - NOTCH / 2 + math.pi) % math.tau - math.pi)
    depth = min(max(0.5 + (NOTCH / 2 - from_centre) / NOTCH_EDGE, 0.0), 1.0)
    return SURFACE_VOLTS + (NOTCH_VOLTS - SURFACE_VOLTS) * depth


@njit(cache=True)
def digitised(volts: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return ADC counts (sample, channel), clipped at the converter's ends.

    >>> digitised(np.array([[0.0, -12.0], [30.0, -30.0]])).tolist()
    [[0, -16384], [32767, -32768]]
    """
    counts = np.empty(volts.shape, np.int32)
    for i in range(volts.shape[0]):
        for k in range(volts.shape[1]):
            ideal = np.rint(volts[i, k] / VOLTS_PER_COUNT)
            counts[i, k] = int(min(max(ideal, -FULL_SCALE_COUNTS), FULL_SCALE_COUNTS - 1))
    return counts


@njit(cache=True)
def _add_probes(
    at_probes: NDArray, theta: NDArray, taken: int, hum: tuple[float, float, float], probes: _Probes, volts: NDArray
) -> None:
    amplitude, turn_per_sample, phase = hum
    for i in range(len(theta)):
        turn = complex(math.cos(theta[i]), math.sin(theta[i]))
        mains = amplitude * math.cos(turn_per_sample * (taken + i) + phase)
        for p in range(len(probes.channel)):
            near = at_probes[i, p, 0] * probes.direction[p, 0] + at_probes[i, p, 1] * probes.direction[p, 1] + mains
            power = turn
            for n in range(probes.track.shape[1]):
                near += (probes.track[p, n] * power).real
                power *= turn
            seen = bent(near, probes.curvature[p, 0], probes.curvature[p, 1])
            volts[i, probes.channel[p]] += probes.gap_voltage[p] + probes.volts_per_metre[p] * seen


@njit(cache=True)
def _add_keyphasor(theta: NDArray, keyphasor: tuple[int, float], volts: NDArray) -> None:
    channel, edge = keyphasor
    if channel >= 0:
        for i in range(len(theta)):
            volts[i, channel] += notch(theta[i] - edge)


def _make_probes(rig: RigConfig, truth: Truth) -> _Probes:
    angles = np.array([p.angle for p in rig.probes]) + truth.probe_angle_errors
    return _Probes(
        channel=np.array([p.channel for p in rig.probes]),
        direction=np.stack([np.cos(angles), np.sin(angles)], axis=1),
        track=_tracks(rig, truth, angles),
        curvature=np.array(truth.probe_curvatures),
        volts_per_metre=np.array([p.sensitivity for p in rig.probes]) * truth.probe_gain_factors,
        gap_voltage=np.array([p.gap_voltage for p in rig.probes]),
    )


def _make_keyphasor(rig: RigConfig, truth: Truth) -> tuple[int, float]:
    """Return channel (-1: none) and the shaft angle [rad] of the notch's falling edge."""
    if rig.keyphasor is None:
        return -1, 0.0
    # the rising edge follows the falling one by the notch's width
    late = 0.0 if rig.keyphasor.edge == "falling" else NOTCH
    return rig.keyphasor.channel, truth.keyphasor_offset - late


def _tracks(rig: RigConfig, truth: Truth, angles: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return each probe's run-out phasors (probe, harmonic) [m].

    A pattern fixed to the surface reaches a probe at angle a, in the sense of rotation, that much later:
    harmonic n turns by -n a.
    """
    if truth.runout_seed is None:
        return np.zeros((len(angles), HARMONICS), complex)
    n = np.arange(1, HARMONICS + 1)
    sense = 1.0 if rig.rotation == "x-to-y" else -1.0
    rows = []
    for i, probe in enumerate(rig.probes):
        plane = next(k for k, p in enumerate(rig.probes) if abs(p.position - probe.position) < SAME_PLACE)
        surface = stream(truth.runout_seed, f"track {plane}")
        first = surface.uniform(*FIRST_RUNOUT)
        size = first / n * np.where(n == 1, 1.0, surface.uniform(0.5, 1.5, HARMONICS))
        pattern = size * np.exp(1j * surface.uniform(0.0, math.tau, HARMONICS))
        spots = stream(truth.runout_seed, f"electrical {i}").uniform(0.0, math.tau, HARMONICS)
        rows.append(pattern * np.exp(-1j * sense * n * angles[i]) + ELECTRICAL_RUNOUT * np.exp(1j * spots))
    return np.array(rows)
