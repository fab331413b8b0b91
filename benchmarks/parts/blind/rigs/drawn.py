"""Rigs that the diagnosis was not written for: small rotor rigs drawn from a seed, as their nameplates tell them.

One disk or two between the bearings, or one overhung. Where the ranges come from:

- Shafts of 8 to 20 mm, ground steel: rotor kits have 10 mm (Bently Nevada RK4), laboratory rigs up to 20 mm
  (SpectraQuest's Machinery Fault Simulator: 5/8 and 3/4 inch). Modulus and density are those of carbon steels.
- Spans of 30 to 50 diameters and disks 5 to 9 diameters across, 1 to 2.5 thick: the RK4 has 40, 7.5 and 2.5. They put
  the first critical speed between 900 and 3000 rpm, where such rigs are run through it.
- One bearing is stiff, as rolling bearings in a rigid housing are (2 MN/m and more; the RK4's are 2 MN/m), and is taken
  from the nameplate. The other one is sought: from a third of the shaft's own stiffness (the RK4's spring bearing has
  0.45 of it) to five times it, up to 15 % unlike in x and y, and in half of the rigs with the cross-coupled stiffness
  of a fluid film: antisymmetric as in short or long journal bearings at small eccentricity (Friswell et al.,
  Dynamics of Rotating Machines, 2010, sec. 5.5), but no more than half of what its damping holds at the critical
  speed, for a rig that whips is not swept.
- Its damping gives the first mode 1 to 8 % of critical.
- Unbalance from G0.4 to G6.3 of ISO 21940-11 at the sweep's highest speed: eccentricity times speed, in mm/s.
- Proximity probes in pairs at right angles, at 0 and 90 degrees or, as API 670 has them, 45 degrees to either side of
  the vertical.

Drawn again is a rig whose first critical speed does not lie alone within the sweep, which is not stable, or which the
nameplate model sends beyond half of the vibration limit: an engineer would not build it or not run it.
"""

import json
import math
import zlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.rig.config.description import from_si
from rotorrig.sims.rotor.model import assemble
from rotorrig.sims.rotor.modes import critical_modes
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

RK4 = Path(__file__).parents[4] / "configs/rk4.toml"
LAYOUTS = ("one disk", "two disks", "overhung")
STEEL = 7850.0  # kg/m^3, of the disks
GRADES = (0.4e-3, 6.3e-3)  # m/s, ISO 21940-11
CRITICAL = (900 / RPM, 3000 / RPM)  # rad/s
DAMPING = (0.01, 0.08)  # damping ratio of the first mode
LIMIT = 900e-6  # m, 0-peak; a probe of 8 mm has 1 mm on either side of its gap
PEAK = (5e-6, LIMIT / 2)  # m, 0-peak at the probes, of the nameplate's unbalance
RUN_UP = 104.0  # s: the RK4's
COARSE = 0.05  # m, elements: the first critical speed is the same within 1e-4
MOST_DRAWS = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Character:
    """Behaviour of a rig by its nameplate model."""

    critical: float  # rad/s, of the first mode: the highest of its one or two crossings
    damping_ratio: float  # the least of them
    peak: float  # m, 0-peak, the largest at any probe
    stiffness: float  # N/m, mean of kxx and kyy of the bearing sought


@cache
def draw_rig(seed: int, *, planes: int = 2, cross_coupled: bool | None = None) -> RigConfig:
    """Return the rig of that seed with one or two planes of probes; `cross_coupled` bearings as drawn if None."""
    rng = np.random.default_rng([seed, zlib.crc32(b"rig")])
    form = LAYOUTS[rng.integers(len(LAYOUTS))]
    for _ in range(MOST_DRAWS):
        rig = _draw_once(rng, form, seed, cross_coupled)
        if rig is not None:
            return rig if planes == 2 else _with_one_plane(rig)
    raise AssertionError(f"seed {seed}: none of {MOST_DRAWS} rigs can be run")


def layout(rig: RigConfig) -> str:
    """Return which of `LAYOUTS` a rig has."""
    if len(rig.disks) > 1:
        return "two disks"
    return "overhung" if rig.disks[0].position > max(b.position for b in rig.bearings) else "one disk"


def character(rig: RigConfig) -> Character:
    """Return the first critical speed within the default plan's speeds, its damping and the largest motion."""
    return _character(rig.model_dump_json())


@cache
def _character(table: str) -> Character:
    rig = from_si(json.loads(table))
    plan = rig.plans["default"]
    model = assemble(rig, max_element=COARSE)
    with threadpool_limits(1, user_api="blas"):
        crossed = critical_modes(model, up_to=plan.fastest)
        unbalance = {d.name: d.unbalance.amount * np.exp(1j * d.unbalance.angle) for d in rig.disks if d.unbalance}
        near = np.linspace(0.9 * crossed[0].omega, 1.1 * crossed[-1].omega, 150)
        z = probe_response(model, near, unbalance=unbalance)
    assert rig.identify is not None
    bearing = rig.bearing(rig.identify.bearings[0][0])
    return Character(
        critical=crossed[-1].omega,
        damping_ratio=min(mode.damping_ratio for mode in crossed),
        peak=float(np.abs(z).max()),
        stiffness=(bearing.constant("kxx") + bearing.constant("kyy")) / 2,
    )


def _draw_once(rng: np.random.Generator, form: str, seed: int, cross_coupled: bool | None) -> RigConfig | None:
    """Return a rig whose sweep passes the first critical speed alone and stays within its limit, or None."""
    table = _rotor(rng, form)
    table |= _bearings(rng, table, cross_coupled)
    table |= _probes(rng, table)
    table = _as_kept(table, seed)
    with threadpool_limits(1, user_api="blas"):
        crossed = critical_modes(assemble(from_si(table), max_element=COARSE), up_to=CRITICAL[1] * 2)
    first = [mode for mode in crossed if mode.omega < 1.25 * crossed[0].omega]
    if not (first and CRITICAL[0] <= first[0].omega and first[-1].omega <= CRITICAL[1] and len(first) <= 2):
        return None
    top = _round(first[-1].omega * rng.uniform(1.4, 1.8) * RPM, 10) / RPM
    if any(mode.omega < 1.15 * top for mode in crossed[len(first) :]):
        return None
    rig = from_si(_with_sweep(rng, table, first[-1].omega, top))
    seen = character(rig)
    stable = all(mode.damping_ratio > 0 for mode in crossed)
    fits = DAMPING[0] <= seen.damping_ratio <= DAMPING[1] and PEAK[0] <= seen.peak <= PEAK[1]
    return rig if stable and fits else None


def _rotor(rng: np.random.Generator, form: str) -> dict[str, Any]:
    """Return shaft, disks and the places of the bearings, the stiff one first."""
    d = _round(rng.uniform(8e-3, 20e-3), 0.5e-3)
    start, span = _round(rng.uniform(4, 8) * d, 5e-4), _round(rng.uniform(30, 50) * d, 5e-4)
    end = start + span
    if form == "overhung":
        span *= 0.8
        end = _round(start + span, 5e-4)
        places = [end + _round(rng.uniform(4, 9) * d, 5e-4)]
    elif form == "one disk":
        places = [start + _round(rng.uniform(0.3, 0.7) * span, 5e-4)]
    else:
        places = [start + _round(rng.uniform(*part) * span, 5e-4) for part in ((0.22, 0.42), (0.58, 0.78))]
    names = ["disk"] if len(places) == 1 else ["disk 1", "disk 2"]
    disks = [_disk(rng, name, place, d) for name, place in zip(names, places, strict=True)]
    last = max(end, *places)
    return {
        "shaft": {
            "length": last + _round(rng.uniform(2, 6) * d, 5e-4),
            "diameter": d,
            "density": _round(rng.uniform(7800, 7870), 1),
            "youngs_modulus": _round(rng.uniform(200e9, 212e9), 1e8),
            "poisson_ratio": 0.3,
        },
        "disks": disks,
        "bearings": [{"position": start}, {"position": end}],
    }


def _disk(rng: np.random.Generator, name: str, place: float, d: float) -> dict[str, Any]:
    """Return a flat steel disk."""
    across, width = _round(rng.uniform(5, 9) * d, 1e-3), _round(rng.uniform(1, 2.5) * d, 1e-3)
    mass = STEEL * math.pi / 4 * across**2 * width
    polar = mass * across**2 / 8
    return {
        "name": name,
        "position": place,
        "mass": _round(mass, 1e-3),
        "polar_inertia": _round(polar, 1e-8),
        "transverse_inertia": _round(polar / 2 + mass * width**2 / 12, 1e-8),
        "width": width,
        "diameter": across,
    }


def _bearings(rng: np.random.Generator, table: dict[str, Any], cross_coupled: bool | None) -> dict[str, Any]:
    """Return the stiff bearing, the one that is sought, and what is sought of it."""
    shaft, (stiff, sought) = table["shaft"], table["bearings"]
    inertia = math.pi / 64 * shaft["diameter"] ** 4
    own = 48 * shaft["youngs_modulus"] * inertia / (sought["position"] - stiff["position"]) ** 3
    held = _round(max(2e6, 20 * own) * _log_uniform(rng, 1, 4), 1e5)
    k, aspect = own * _log_uniform(rng, 1 / 3, 5), rng.uniform(0.85, 1 / 0.85)
    reference = math.sqrt(own * k / (own + k) / sum(disk["mass"] for disk in table["disks"]))
    c = _round(2 * k / reference * _log_uniform(rng, 0.02, 0.3), 0.1)
    coupled = bool(rng.integers(2)) if cross_coupled is None else cross_coupled
    whirl = c * reference * rng.uniform(0.1, 0.5) * coupled  # N/m, forward
    kxx, kyy = _round(k, 100), _round(k * aspect, 100)
    found = {"kxx": kxx, "kyy": kyy, "kxy": _round(whirl, 10), "kyx": -_round(whirl * rng.uniform(0.8, 1.0), 10)}
    return {
        "bearings": [
            {"name": "stiff", **stiff, "kxx": held, "kyy": held},
            {"name": "sought", **sought, **found, "cxx": c, "cyy": c},
        ],
        "identify": {
            "bearings": [["sought"]],
            "coefficients": "all" if coupled else "direct",
            "unbalance": [disk["name"] for disk in table["disks"]],
            "k_bounds": [k / 100, k * 30],
            "c_bounds": [c / 15, c * 70],
            "kxy_bounds": [-k, k],
            "cxy_bounds": [-10 * c, 10 * c],
        },
    }


def _probes(rng: np.random.Generator, table: dict[str, Any]) -> dict[str, Any]:
    """Return two pairs of probes, the first beside the disk that is nearest to the coupling."""
    disk, places = table["disks"][0], [b["position"] for b in table["bearings"]]
    beside = disk["position"] - disk["width"] / 2 - rng.uniform(10e-3, 25e-3)
    other = places[0] + rng.uniform(0.3, 0.7) * (places[1] - places[0])
    if disk["position"] < places[1]:  # between disk and far bearing, clear of both and of another disk
        last = table["disks"][-1]
        other = last["position"] + rng.uniform(0.35, 0.75) * (places[1] - last["position"])
    turned = math.pi / 4 * int(rng.integers(2))
    planes = sorted([_round(beside, 5e-4), _round(other, 5e-4)])
    return {
        "probes": [
            {
                "name": f"{i}{axis}",
                "position": place,
                "angle": turned + quarter * math.pi / 2,
                "channel": 2 * i - 2 + quarter,
            }
            for i, place in enumerate(planes, start=1)
            for quarter, axis in enumerate("xy")
        ]
    }


def _as_kept(table: dict[str, Any], seed: int) -> dict[str, Any]:
    """Return the whole config; drive, DAQ and priors are the RK4's."""
    rk4 = load(RK4).model_dump(mode="json")
    same = {key: rk4[key] for key in ("keyphasor", "motor", "daq", "prior", "rotation", "gravity")}
    return {"name": f"drawn rig {seed}", **same, **table}


def _with_sweep(rng: np.random.Generator, table: dict[str, Any], critical: float, top: float) -> dict[str, Any]:
    """Return the config with a plan through the critical speed, limits, and unbalances by a balance grade."""
    disks = []
    for disk in table["disks"]:
        amount = disk["mass"] * _log_uniform(rng, *GRADES) / top
        disks.append(disk | {"unbalance": {"amount": _round(amount, 1e-8), "angle": float(rng.uniform(-np.pi, np.pi))}})
    amounts = [disk["unbalance"]["amount"] for disk in disks]
    start = _round(min(480.0, 0.4 * critical * RPM), 10) / RPM
    plan = {
        "kind": "run-up-coast-down",
        "slow_roll": 240 / RPM,
        "slow_roll_time": 10.0,
        "start": start,
        "end": top,
        "ramp": (top - start) / RUN_UP,
    }
    return table | {
        "disks": disks,
        "motor": table["motor"] | {"max_speed": 1.2 * top},
        "limits": {"overspeed": 1.1 * top, "vibration": LIMIT},
        "plans": {"default": plan},
        "identify": table["identify"] | {"u_bounds": [min(amounts) / 150, max(amounts) * 67]},
    }


def _with_one_plane(rig: RigConfig) -> RigConfig:
    table = rig.model_dump(mode="json")
    first = min(probe["position"] for probe in table["probes"])
    return from_si(table | {"probes": [p for p in table["probes"] if p["position"] == first]})


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _round(value: float, step: float) -> float:
    """Return the multiple of `step` that a drawing would state, at least one."""
    return round(max(round(value / step), 1) * step, 12) if value else 0.0
