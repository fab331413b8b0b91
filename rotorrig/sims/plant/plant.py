"""The blind rig behind three verbs: command the drive, advance the clock, take the counts.

Everything random comes from streams of the truth's seed that are drawn in the order of the samples, so the counts
depend on the seed and on when commands came, never on the size of the steps `advance` is called with.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.rig import DataError
from rotorrig.rig.config import Bearing, RigConfig
from rotorrig.sims.plant.deviations import REFERENCE, as_built
from rotorrig.sims.plant.faults import apply_deviations, apply_sensors, apply_structure, collect_forces
from rotorrig.sims.plant.integrate import ShaftMotion
from rotorrig.sims.plant.motor import Motor
from rotorrig.sims.plant.places import sense, sought_bearings, true_bearing
from rotorrig.sims.plant.sensors import FULL_SCALE_COUNTS, VOLTS_PER_COUNT, Mounting, Sensors, make_chain
from rotorrig.sims.plant.shaft import Rotor, build
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Truth

GRAVITY = 9.80665  # m/s^2
DEFAULT_RATE = 10_000.0  # Hz, for a config without a DAQ
STEP_ANGLE = 0.03  # rad of the first mode per step at most: its period is then 7.5e-5 too long
RATTLE_CORNER = 60.0  # Hz, of the part of the balls' rattling that grows with speed
CHUNK = 8192  # samples integrated at a time, for memory alone


class Plant:
    """The rig of one truth, at rest at first. Sample k is taken at (k + 1) / sample_rate."""

    def __init__(self, rig: RigConfig, truth: Truth, *, sample_rate: float | None = None) -> None:
        """Build the rig; `sample_rate` [Hz] defaults to the config's.

        Raises DataError if `truth` was drawn for other bearings, disks or probes, or holds an unknown fault.
        """
        _check_fits(rig, truth)
        rig = as_built(rig, truth)
        self.sample_rate = sample_rate or (rig.daq.sample_rate if rig.daq else DEFAULT_RATE)
        truth = apply_deviations(rig, truth)
        acting = collect_forces(rig, truth)
        plain = build(rig, truth, extra=(coordinate for force in acting for coordinate, _ in force.on))
        rotor = apply_structure(rig, truth, plain)
        self._substeps = _substeps(rotor, self.sample_rate)
        step = 1.0 / (self.sample_rate * self._substeps)
        self._sense = sense(rig)
        shaken = tuple(bearing.position for bearing in sought_bearings(rig))  # those whose balls rattle
        hunting = stream(truth.seed, "hunting", run=truth.run)
        self._motor = Motor(step=step, hunting=truth.noise.hunting, rng=hunting)
        self._mounting = Mounting(rig, truth, sample_rate=self.sample_rate)
        self._shaft = ShaftMotion(
            rotor,
            step=step,
            gravity=_gravity(rig),
            unbalances=tuple(
                (rig.disk(u.disk).position, u.amount, self._sense * u.angle) for u in (*truth.unbalances, *truth.trial)
            ),
            random_at=shaken,
            damping=tuple((b.position, *_damping_growth(truth, b)) for b in sought_bearings(rig)),
            forces=acting,
            watched=self._mounting.watched,
        )
        chain = apply_sensors(rig, truth, make_chain(rig, truth))
        self._sensors = Sensors(rig, truth, chain, sample_rate=self.sample_rate)
        self._rattle = stream(truth.seed, "bearing force", run=truth.run)
        # white noise held for a step h has the one-sided density 2 h sigma^2
        self._rattle_rms = truth.noise.bearing_force / math.sqrt(2.0 * step)
        self._growth = truth.unmodelled.noise_growth / REFERENCE
        self._memory = math.exp(-math.tau * RATTLE_CORNER * step)
        self._coloured = np.zeros((len(shaken), 2))  # of the last step
        self._shaken = len(shaken)
        self._samples = 0
        self._take(0)  # compiles what no cache holds here, not while a driver waits for samples

    @property
    def channels(self) -> int:
        """Channels of the DAQ, numbered as in the config; one no probe uses carries a shorting plug's noise."""
        return self._sensors.channels

    @property
    def volts_per_count(self) -> tuple[float, ...]:
        """Volts per count, one per channel."""
        return (VOLTS_PER_COUNT,) * self.channels

    @property
    def full_scale_counts(self) -> int:
        """Counts run from minus this to this less one."""
        return FULL_SCALE_COUNTS

    @property
    def t(self) -> float:
        """Time of the last sample taken [s]."""
        return self._samples / self.sample_rate

    @property
    def speed(self) -> float:
        """Shaft speed now [rad/s], never negative."""
        return self._motor.speed

    def command(self, setpoint: float, ramp: float, powered: bool) -> None:
        """Go to `setpoint` [rad/s] at `ramp` [rad/s^2], or coast if not `powered`; from the next sample on.

        Raises ValueError on a negative or infinite setpoint or ramp.
        """
        self._motor.command(setpoint, ramp, powered)

    def advance(self, t: float) -> NDArray[np.int32]:
        """Return all counts (sample, channel) after the last call's up to time `t` [s]; none if `t` is no later."""
        wanted = math.floor(t * self.sample_rate + 1e-6)
        blocks = [np.empty((0, self.channels), np.int32)]
        while self._samples < wanted:
            blocks.append(self._take(min(CHUNK, wanted - self._samples)))
        return np.concatenate(blocks)

    def _take(self, samples: int) -> NDArray[np.int32]:
        steps = samples * self._substeps
        angle, speed, alpha = self._motor.run(steps)
        rattle = self._rattle_rms * self._rattle.standard_normal((steps, self._shaken, 2))
        if self._growth:  # of an empty stretch too: see below
            rattle += self._growth * speed[:, None, None] * self._colour(rattle)
        s = self._sense
        deflections = self._shaft.run(s * angle, s * speed, s * alpha, rattle)
        self._samples += samples
        last = slice(self._substeps - 1, None, self._substeps)
        # in one piece, as an empty stretch is: else the first samples would be kept waiting for another compilation
        deflections, angle = np.ascontiguousarray(deflections[last]), np.ascontiguousarray(angle[last])
        seen = self._mounting.at_probes(deflections), angle, self._mounting.at_keyphasor(deflections, angle)
        return self._sensors.counts(*seen)

    def _colour(self, white: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return noise that is as `white` at low frequency and falls off beyond the corner: first order."""
        coloured, self._coloured = _low_pass(white, self._coloured, self._memory)
        return coloured


@njit(cache=True)
def _low_pass(
    white: NDArray[np.float64], last: NDArray[np.float64], memory: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (step, ...) what remembers a share of its last value, and the last; scipy.signal is slow to import."""
    passed = np.empty_like(white)
    for i in range(len(white)):
        last = memory * last + (1.0 - memory) * white[i]
        passed[i] = last
    return passed, last


def _damping_growth(truth: Truth, bearing: Bearing) -> tuple[float, float]:
    """Return by how much the damping in x and y grows per rad/s; at the reference speed it is the truth's."""
    b = true_bearing(truth, bearing)
    growth = truth.unmodelled.damping_growth / REFERENCE
    return growth * b.cxx, growth * b.cyy


def _check_fits(rig: RigConfig, truth: Truth) -> None:
    probes = {len(truth.probe_gain_factors), len(truth.probe_angle_errors), len(truth.probe_curvatures)}
    disks = [u.disk for u in truth.unbalances]
    if stray := {u.disk for u in truth.trial}.difference(d.name for d in rig.disks):
        raise DataError(f"truth of seed {truth.seed}: has a trial mass on '{min(stray)}', which '{rig.name}' has not")
    got = ([b.name for b in truth.bearings], disks, len(truth.disk_mass_factors), probes)
    want = ([b.name for b in rig.bearings], [d.name for d in rig.disks], len(rig.disks), {len(rig.probes)})
    if got != want:
        raise DataError(
            f"truth of seed {truth.seed}: has bearings {got[0]}, disks {disks} and {max(probes)} probes, "
            f"want those of '{rig.name}': {want[0]}, {want[1]} and {len(rig.probes)}"
        )


def _substeps(rotor: Rotor, sample_rate: float) -> int:
    return math.ceil(float(rotor.critical_speeds(1)[0]) / (STEP_ANGLE * sample_rate))


def _gravity(rig: RigConfig) -> tuple[float, float]:
    return {"-x": (-GRAVITY, 0.0), "-y": (0.0, -GRAVITY), "none": (0.0, 0.0)}[rig.gravity]
