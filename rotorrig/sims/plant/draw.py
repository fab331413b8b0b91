"""Draw a hidden rig from a seed: the nameplate within its tolerances, and the faults asked for."""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from rotorrig.rig import ConfigError, DataError
from rotorrig.rig.config import Bearing, Disk, RigConfig
from rotorrig.sims.plant.deviations import draw_geometry, draw_tailed, draw_unmodelled
from rotorrig.sims.plant.faults import apply_deviations, check_fault, check_faults, load_fault
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import BearingTruth, FaultSpec, Geometry, Noise, Truth, UnbalanceTruth, Unmodelled

# Uniform within +-, relative to the nameplate: what nobody knows of a bearing before a test.
STIFFNESS_TOLERANCE = 0.05
DAMPING_TOLERANCE = 0.20
UNBALANCE_TOLERANCE = 0.10

# The core's standard deviation, see `deviations.draw_tailed`: what a careful workshop reaches, mostly.
MODULUS_SIGMA = 0.01
DENSITY_SIGMA = 0.002
DISK_MASS_SIGMA = 0.005
GAIN_SIGMA = 0.01
PROBE_ANGLE_SIGMA = math.radians(1.0)
KEYPHASOR_SIGMA = math.radians(2.0)
CURVATURE_TOLERANCE = 0.002  # of the scale factor at 300 um, quadratic and cubic part each
BALANCE_QUALITY = 6.3e-3  # m/s: grade G 6.3 of ISO 21940-11, for a disk whose nameplate names no unbalance
COEFFICIENTS = ("kxx", "kyy", "kxy", "kyx", "cxx", "cyy", "cxy", "cyx")


def draw(
    rig: RigConfig,
    *,
    seed: int,
    faults: Iterable[FaultSpec] = (),
    trial: Mapping[str, tuple[float, float]] | None = None,
    run: int = 0,
    unmodelled: bool = True,
    geometry: bool = False,
) -> Truth:
    """Return the rig of that seed: the nameplate within its tolerances. Raises DataError on an unknown fault.

    `trial` masses, disk -> (kg m, rad), are put where the disk is marked: their angle is the shaft's, from angle zero
    in the sense of rotation, and not from the keyphasor's edge, which is off by its hidden offset. Another `run` is
    the same rig with another noise. `unmodelled` rigs also do what no nameplate speaks of, and with `geometry` parts
    stand and fit a little otherwise than it says (see `deviations`). Raises DataError too on a trial mass for no disk
    and on a negative run.
    Raises ConfigError on a rigid bearing, coefficients over speed, or shaft damping, which is the simulated rig's own.
    """
    _check_can_be_simulated(rig)
    probes = range(len(rig.probes))
    return Truth(
        config_hash=rig.hash,
        seed=seed,
        bearings=_draw_bearings(rig, seed),
        unbalances=tuple(_draw_unbalance(rig, disk, seed) for disk in rig.disks),
        modulus_factor=1.0 + draw_tailed(seed, "modulus", MODULUS_SIGMA),
        density_factor=1.0 + draw_tailed(seed, "density", DENSITY_SIGMA),
        disk_mass_factors=tuple(1.0 + draw_tailed(seed, f"mass {d.name}", DISK_MASS_SIGMA) for d in rig.disks),
        probe_gain_factors=tuple(1.0 + draw_tailed(seed, f"gain {i}", GAIN_SIGMA) for i in probes),
        probe_angle_errors=tuple(draw_tailed(seed, f"angle {i}", PROBE_ANGLE_SIGMA) for i in probes),
        probe_curvatures=tuple(
            (
                _draw_within(seed, f"quadratic {i}", CURVATURE_TOLERANCE),
                _draw_within(seed, f"cubic {i}", CURVATURE_TOLERANCE),
            )
            for i in probes
        ),
        keyphasor_offset=draw_tailed(seed, "keyphasor", KEYPHASOR_SIGMA),
        runout_seed=seed,
        noise=Noise(),
        unmodelled=draw_unmodelled(rig, seed) if unmodelled else Unmodelled(),
        geometry=draw_geometry(rig, seed) if geometry else Geometry(),
        faults=check_faults(faults),
        trial=_trial_masses(rig, trial or {}),
        run=_check_run(run),
    )


def draw_fault(rig: RigConfig, name: str, *, seed: int, runs: int = 1) -> FaultSpec:
    """Return fault `name` at the size a blind case of that seed has it. Raises DataError on an unknown fault.

    Each parameter with a range comes from it, by its own stream; the others keep their default. `runs` is how many
    recordings there will be: what would happen in a later one happens in the last.
    """
    check_fault(name, {})
    spans = load_fault(name).RANGE
    drawn = {p: s.draw(rig, stream(seed, f"{name} {p}")) for p, s in spans.items()}
    if "run" in drawn:
        drawn["run"] = min(drawn["run"], runs - 1.0)
    return FaultSpec(name=name, parameters=drawn)


def nameplate(rig: RigConfig, *, faults: Iterable[FaultSpec] = ()) -> Truth:
    """Return the rig exactly as its nameplate says: round, silent, linear. Raises as `draw`."""
    _check_can_be_simulated(rig)
    ones = (1.0,) * len(rig.probes)
    return Truth(
        config_hash=rig.hash,
        seed=0,
        bearings=tuple(_bearing(b, dict.fromkeys(COEFFICIENTS, 1.0)) for b in rig.bearings),
        unbalances=tuple(
            UnbalanceTruth(
                disk=d.name,
                amount=d.unbalance.amount if d.unbalance else 0.0,
                angle=d.unbalance.angle if d.unbalance else 0.0,
            )
            for d in rig.disks
        ),
        modulus_factor=1.0,
        density_factor=1.0,
        disk_mass_factors=(1.0,) * len(rig.disks),
        probe_gain_factors=ones,
        probe_angle_errors=(0.0,) * len(ones),
        probe_curvatures=((0.0, 0.0),) * len(ones),
        keyphasor_offset=0.0,
        runout_seed=None,
        noise=Noise.none(),
        faults=check_faults(faults),
    )


def expected_estimates(rig: RigConfig, truth: Truth) -> dict[str, float]:
    """Return the estimates of a perfect fit of the config's [identify] table, SI: "kxx".. "u", "phase" by name.

    A phase [rad, -pi to pi] is the unbalance's angle from the emitted keyphasor edge, in the sense of rotation; a
    plane that is no disk has no unbalance here, and a trial mass, which is known, is left out. Raises DataError if the
    config has no [identify] table.
    """
    if (sought := rig.identify) is None:
        raise DataError(f"config '{rig.name}': has no [identify] table, want one to know what is to be found")
    truth = apply_deviations(rig, truth)
    estimates = {}
    bearings = {bearing.name: bearing for bearing in truth.bearings}
    for group in sought.bearings:
        for name in sought.coefficient_names:
            estimates[sought.coefficient_of(group, name)] = float(getattr(bearings[group[0]], name))
    factors = {"youngs_modulus": ("E", truth.modulus_factor), "density": ("density", truth.density_factor)}
    for key in sought.also:
        name, factor = factors[key]
        estimates[name] = factor * getattr(rig.shaft, key)
    for unbalance in truth.unbalances:
        if unbalance.disk in sought.unbalance:
            phase = math.remainder(unbalance.angle + truth.keyphasor_offset, math.tau)
            estimates[sought.unbalance_of(unbalance.disk, "u")] = unbalance.amount
            estimates[sought.unbalance_of(unbalance.disk, "phase")] = phase
    return estimates


def _check_can_be_simulated(rig: RigConfig) -> None:
    for bearing in rig.bearings:
        if bearing.rigid or bearing.over_speed:
            kind = "rigid" if bearing.rigid else "given over speed"
            raise ConfigError(f"{rig.name}: bearing '{bearing.name}' is {kind}, want constants to simulate the rig")
    if rig.shaft.structural_damping or rig.shaft.rayleigh.mass or rig.shaft.rayleigh.stiffness:
        raise ConfigError(f"{rig.name}: the shaft has damping, want none to simulate the rig, which brings its own")


def _trial_masses(rig: RigConfig, masses: Mapping[str, tuple[float, float]]) -> tuple[UnbalanceTruth, ...]:
    disks = [disk.name for disk in rig.disks]
    for name in masses:
        if name not in disks:
            raise DataError(f"trial mass on '{name}': '{rig.name}' has no such disk, want one of {disks}")
    return tuple(UnbalanceTruth(disk=name, amount=amount, angle=angle) for name, (amount, angle) in masses.items())


def _check_run(run: int) -> int:
    if run < 0:
        raise DataError(f"run {run}: want a number from 0 on")
    return run


def _draw_bearings(rig: RigConfig, seed: int) -> tuple[BearingTruth, ...]:
    """Draw each bearing by itself, but those identified as one set with common factors: they are alike."""
    sets = rig.identify.bearings if rig.identify else ()
    owners = {name: f"identified {i}" if i else "identified" for i, group in enumerate(sets) for name in group}
    drawn = []
    for bearing in rig.bearings:
        owner = owners.get(bearing.name, bearing.name)
        factors = {
            c: 1.0 + _draw_within(seed, f"{owner} {c}", STIFFNESS_TOLERANCE if c.startswith("k") else DAMPING_TOLERANCE)
            for c in COEFFICIENTS
        }
        drawn.append(_bearing(bearing, factors))
    return tuple(drawn)


def _bearing(plate: Bearing, factors: dict[str, float]) -> BearingTruth:
    return BearingTruth(name=plate.name, **{c: plate.constant(c) * factors[c] for c in COEFFICIENTS})


def _draw_unbalance(rig: RigConfig, disk: Disk, seed: int) -> UnbalanceTruth:
    if disk.unbalance:
        expected = disk.unbalance.amount
    else:
        fastest = rig.motor.max_speed if rig.motor else max((p.fastest for p in rig.plans.values()), default=377.0)
        expected = disk.mass * BALANCE_QUALITY / fastest
    return UnbalanceTruth(
        disk=disk.name,
        amount=expected * (1.0 + _draw_within(seed, f"unbalance {disk.name}", UNBALANCE_TOLERANCE)),
        angle=float(stream(seed, f"heavy spot {disk.name}").uniform(-np.pi, np.pi)),
    )


def _draw_within(seed: int, name: str, tolerance: float) -> float:
    return float(stream(seed, name).uniform(-tolerance, tolerance))
