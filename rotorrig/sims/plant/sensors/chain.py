"""Sensor chain of a rig, from the surface under the probes to the converter's input.

A probe sees the shaft come nearer, x cos a + y sin a, plus the track of the surface under it. Tracks belong to a plane:
two probes at one place see the same one, shifted by their angle, plus a little electrical run-out of their own. The
mains are never quite at their frequency: they stray by 20 mHz within a minute (Weissbach and Welfonder, High frequency
deviations within the European power system, IEEE Power Systems Conference 2009).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import RigConfig
from rotorrig.sims.plant.places import same_plane, sense
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Truth

HARMONICS = 5  # of the run-out track
FIRST_RUNOUT = (2e-6, 5e-6)  # m, 0-peak at 1X, ground steel; harmonic n has 1/n of it, give or take a half
ELECTRICAL_RUNOUT = 2e-7  # m, 0-peak per harmonic and probe: magnetic spots seen by one probe alone
MAINS = 50.0  # Hz
STRAY = 4e-4  # of that, to either side
STRAY_PERIOD = 60.0  # s


class Chain(NamedTuple):
    """Constants of the probes, one row each, in the config's order, and the tones they all pick up."""

    channel: NDArray[np.intp]  # (probe,)
    direction: NDArray[np.float64]  # (probe, 2) cosine and sine of the true angle
    track: NDArray[np.complex128]  # (probe, harmonic) m, run-out Re(track e^{j n theta})
    curvature: NDArray[np.float64]  # (probe, 2) see `channels.apply_curvature`
    volts_per_metre: NDArray[np.float64]  # (probe,)
    gap_voltage: NDArray[np.float64]  # (probe,)
    mixing: NDArray[np.float64]  # (probe, probe) share of every probe in each channel; the identity if all is well
    brackets: NDArray[np.float64]  # (probe, 3) see `bracket.Brackets`; of a share of zero a bracket stands still
    delay: NDArray[np.float64]  # (probe,) s, of a low-pass filter that the keyphasor's channel has not
    tones: NDArray[np.float64]  # (tone, probe, 3) m, Hz and rad, whatever the shaft does
    drift: NDArray[np.float64]  # (probe, 2) once warm: of the gain, relative, and of the gap [m]
    ripple: tuple[float, float]  # V and rad, of the supply, on every probe's output
    stray: float  # rad, where the straying of all tones' frequency begins


def make_chain(rig: RigConfig, truth: Truth) -> Chain:
    """Return the sensor chain of `rig` with the deviations of `truth`."""
    angles = np.array([p.angle for p in rig.probes]) + truth.probe_angle_errors
    mains = stream(truth.seed, "mains", run=truth.run)
    phase, stray, ripple = (float(mains.uniform(0.0, math.tau)) for _ in range(3))
    healthy, none = truth.unmodelled, (0.0,) * len(angles)
    return Chain(
        channel=np.array([p.channel for p in rig.probes]),
        direction=np.stack([np.cos(angles), np.sin(angles)], axis=1),
        track=_tracks(rig, truth, angles),
        curvature=np.array(truth.probe_curvatures),
        volts_per_metre=np.array([p.sensitivity for p in rig.probes]) * truth.probe_gain_factors,
        gap_voltage=np.array([p.gap_voltage for p in rig.probes]),
        mixing=np.eye(len(angles)),
        brackets=np.zeros((len(angles), 3)),
        delay=np.zeros(len(angles)),
        tones=np.full((1, len(angles), 3), (truth.noise.hum, MAINS, phase)),
        drift=np.stack([healthy.gain_drift or none, healthy.gap_drift or none], axis=1),
        ripple=(healthy.supply_ripple, ripple),
        stray=stray,
    )


def phasors_at(pattern: NDArray[np.complex128], angle: float, rig: RigConfig) -> NDArray[np.complex128]:
    """Return the phasors (harmonic,) a probe at `angle` [rad] sees of a `pattern` fixed to the surface.

    The pattern reaches it that much later, in the sense of rotation: harmonic n turns by -n angle.
    """
    n = np.arange(1, len(pattern) + 1)
    return pattern * np.exp(-1j * sense(rig) * n * angle)


def _tracks(rig: RigConfig, truth: Truth, angles: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return each probe's run-out phasors (probe, harmonic) [m]."""
    if truth.runout_seed is None:
        return np.zeros((len(angles), HARMONICS), complex)
    n = np.arange(1, HARMONICS + 1)
    rows = []
    for i, angle in enumerate(angles):
        surface = stream(truth.runout_seed, f"track {same_plane(rig, i)[0]}")
        first = surface.uniform(*FIRST_RUNOUT)
        size = first / n * np.where(n == 1, 1.0, surface.uniform(0.5, 1.5, HARMONICS))
        pattern = size * np.exp(1j * surface.uniform(0.0, math.tau, HARMONICS))
        spots = stream(truth.runout_seed, f"electrical {i}").uniform(0.0, math.tau, HARMONICS)
        rows.append(phasors_at(pattern, angle, rig) + ELECTRICAL_RUNOUT * np.exp(1j * spots))
    return np.array(rows)
