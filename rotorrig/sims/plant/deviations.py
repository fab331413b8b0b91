"""Healthy deviations of a rig: what is not quite as the nameplate says, and what the nameplate does not speak of.

Deviations are drawn from Student's t with four degrees of freedom, scaled so that 68.3 % lie within one sigma as they
do of a normal distribution: beyond three sigma it has 2.7 % instead of 0.27 %. Workshops are like that (Huber, Robust
Statistics (1981), ch. 1: data sets of high quality have tails like t with a few degrees of freedom).

Where sizes come from:

- coupling: catalogues of flexible couplings for 10 mm shafts, 1 kN/m of a rubber spider's softest to 100 of a beam's;
  here about the softest, as kits are driven through a rubber sleeve, with the loss factor of soft rubber;
- supply: makers' data sheets of eddy-current drivers state 2 mV per volt of supply; half a volt of ripple is usual;
- temperature: API 670 allows the scale factor 5 % more over some 40 K; a cabinet warms by 2 K. The gap likewise: 20
  um/m K of a plastic bracket 50 mm long;
- noise: balls over rough races push in proportion to speed, through a ring that is a mass on a spring; estimates;
- base plate: of aluminium, on feet, some 7 MN/m under a bearing of 34 kN/m: half a per cent of what the bearing does,
  and more the nearer its natural frequency, three times a kit's highest speed; estimates;
- keyphasor: a wheel of 15 mm radius on the motor's shaft, which follows a twentieth of what the driven end does; an
  estimate;
- damping: grease of which a tenth of the viscosity is lost as it warms; an estimate;
- geometry: 1 mm read off a tape, ISO 286 h9 of a 10 mm bar: 0.36 %, here 0.2 %; the rest estimates: a hub pressed on
  stiffens the shaft like 5 % of diameter (Nelson and Crandall, ch. 2.3 of Ehrich, Handbook of Rotordynamics (1992)), a
  deep groove bearing of 10 mm resists tilt by some 20 N m/rad.
"""

import itertools
import math
from typing import TypeVar

import numpy as np

from rotorrig.rig.config import Bearing, Disk, Probe, RigConfig, Section
from rotorrig.sims.plant.places import same_plane
from rotorrig.sims.plant.streams import stream
from rotorrig.sims.plant.truth import Geometry, Truth, Unmodelled

Placed = TypeVar("Placed", Disk, Bearing, Probe)

FREEDOM = 4.0  # degrees
CORE = 1.1416  # t of four degrees of freedom that 84.13 % stay below, as 1 of a normal distribution
FURTHEST = 10.0  # sigmas: one in 3000 is further off; what is, is drawn in

COUPLING_STIFFNESS = 1000.0  # N/m
COUPLING_SPREAD = 0.7  # of its logarithm
COUPLING_LOSS, LOSS_SPREAD = 0.1, 0.4  # and of its logarithm
SUPPLY_RIPPLE = 5e-4  # V: 2 mV/V of 0.25 V
GAIN_DRIFT = 2e-3
GAP_DRIFT = 2e-6  # m
NOISE_GROWTH = 1.0
DAMPING_GROWTH = 0.1
BASE_SHARE = 5e-3
BASE_FREQUENCY, BASE_SPREAD = 150.0, 0.2  # Hz, and of its logarithm
MARK_LEAD = 0.05 / 0.015  # rad/m
REFERENCE = 230.0  # rad/s, of growth with speed
WARMING = 600.0  # s, of first order, from when the plant is switched on

POSITION = 1e-3  # m
FURTHEST_POSITION = 5e-3  # m: nobody overlooks more
DIAMETER = 2e-3
HUB_LENGTH = 0.025  # m
HUB = 0.05
TILT = 20.0  # N m/rad


def draw_tailed(seed: int, name: str, sigma: float) -> float:
    """Draw a deviation about zero whose core is that of a normal distribution of `sigma`."""
    t = float(stream(seed, name).standard_t(FREEDOM)) / CORE
    return sigma * min(max(t, -FURTHEST), FURTHEST)


def draw_unmodelled(rig: RigConfig, seed: int) -> Unmodelled:
    """Draw what no nameplate speaks of."""
    probes = range(len(rig.probes))
    return Unmodelled(
        coupling_stiffness=COUPLING_STIFFNESS * math.exp(draw_tailed(seed, "coupling stiffness", COUPLING_SPREAD)),
        coupling_loss=COUPLING_LOSS * math.exp(draw_tailed(seed, "coupling loss", LOSS_SPREAD)),
        supply_ripple=abs(draw_tailed(seed, "supply ripple", SUPPLY_RIPPLE)),
        gain_drift=tuple(draw_tailed(seed, f"gain drift {i}", GAIN_DRIFT) for i in probes),
        gap_drift=tuple(draw_tailed(seed, f"gap drift {i}", GAP_DRIFT) for i in probes),
        noise_growth=abs(draw_tailed(seed, "noise growth", NOISE_GROWTH)),
        damping_growth=draw_tailed(seed, "damping growth", DAMPING_GROWTH),
        base_share=abs(draw_tailed(seed, "base plate", BASE_SHARE)),
        base_frequency=BASE_FREQUENCY * math.exp(draw_tailed(seed, "base frequency", BASE_SPREAD)),
        mark_lead=abs(draw_tailed(seed, "mark lead", MARK_LEAD)),
        keyphasor_direction=float(stream(seed, "keyphasor direction").uniform(0.0, math.tau)),
    )


def draw_geometry(rig: RigConfig, seed: int) -> Geometry:
    """Draw how the rig was put together; the probes of a plane sit in one bracket."""

    def shift(name: str, position: float) -> float:
        off = draw_tailed(seed, name, POSITION)
        off = min(max(off, -FURTHEST_POSITION), FURTHEST_POSITION)
        return min(max(off, -position), rig.shaft.length - position)

    return Geometry(
        disk_shifts=tuple(shift(f"position {d.name}", d.position) for d in rig.disks),
        bearing_shifts=tuple(shift(f"position {b.name}", b.position) for b in rig.bearings),
        probe_shifts=tuple(
            shift(f"position of plane {same_plane(rig, i)[0]}", p.position) for i, p in enumerate(rig.probes)
        ),
        diameter_factor=1.0 + draw_tailed(seed, "diameter", DIAMETER),
        hub_factors=tuple(1.0 + abs(draw_tailed(seed, f"hub {d.name}", HUB)) for d in rig.disks),
        tilt_stiffnesses=tuple(abs(draw_tailed(seed, f"tilt {b.name}", TILT)) for b in rig.bearings),
    )


def as_built(rig: RigConfig, truth: Truth) -> RigConfig:
    """Return the rig as it was put together: parts where they are, the shaft as thick as it is."""
    built = truth.geometry
    if built == Geometry(tilt_stiffnesses=built.tilt_stiffnesses):
        return rig
    moved = rig.model_copy(
        update={
            "disks": _shift(rig.disks, built.disk_shifts),
            "bearings": _shift(rig.bearings, built.bearing_shifts),
            "probes": _shift(rig.probes, built.probe_shifts),
        }
    )
    return moved.model_copy(update={"shaft": rig.shaft.model_copy(update={"sections": _sections(moved, built)})})


def _shift(parts: tuple[Placed, ...], shifts: tuple[float, ...]) -> tuple[Placed, ...]:
    """Return `parts`, each further from the coupling by its shift."""
    if not shifts:
        return parts
    return tuple(
        part.model_copy(update={"position": part.position + off}) for part, off in zip(parts, shifts, strict=True)
    )


def _sections(rig: RigConfig, built: Geometry) -> tuple[Section, ...]:
    """Return the shaft cut where its section changes and where hubs begin and end."""
    hubs = [
        (disk.position - HUB_LENGTH / 2, disk.position + HUB_LENGTH / 2, factor)
        for disk, factor in zip(rig.disks, built.hub_factors, strict=False)
        if factor > 1.0
    ]
    cuts = {tube.start for tube in rig.shaft.tubes} | {z for a, b, _ in hubs for z in (a, b)}
    ends = np.unique([0.0, *(z for z in cuts if 0.0 < z < rig.shaft.length), rig.shaft.length])
    sections = []
    for start, end in itertools.pairwise(ends):
        middle = (start + end) / 2
        tube = next(t for t in reversed(rig.shaft.tubes) if t.start < middle)
        thicker = max((factor for a, b, factor in hubs if a < middle < b), default=1.0)
        sections.append(
            Section.model_construct(  # figures are in SI, where a config's have units
                length=float(end - start),
                diameter=tube.diameter * built.diameter_factor * thicker,
                inner_diameter=tube.inner_diameter,
                density=tube.density,
                youngs_modulus=tube.youngs_modulus,
                poisson_ratio=tube.poisson_ratio,
            )
        )
    return tuple(sections)
