"""Faults to the measure of a rig: their files in sims/plant/faults state sizes for the RK4.

A drawn rig is like the RK4 in another scale of stiffness, of motion and of time (the ratios of the stiffness of the
bearing sought, of the largest motion and of the period of the first critical speed), and a parameter is multiplied by
these to the powers that its unit asks for, as in any similar model (Buckingham). What belongs to the probes, as runout
or hum, and pure numbers and angles stay as drawn. Places move with the parts they lie between.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

from benchmarks.parts.blind.rigs.drawn import RK4, Character, character
from rotorrig.rig.config import RigConfig, load
from rotorrig.sims.plant import FaultSpec
from rotorrig.sims.plant.draw import draw_fault
from rotorrig.sims.plant.faults import load_fault

FORCE, STIFFNESS, COMPLIANCE, LENGTH, TIME, RATE = (1, 1, 0), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)
UNBALANCE, DRAG, CUBIC, DAMPING = (1, 1, 2), (1, -1, 2), (1, -2, 0), (1, 0, 1)
Power = tuple[int, int, int]  # of the scales of stiffness, motion and time

POWERS: Mapping[tuple[str, str], Power] = {
    ("bow", "amount"): LENGTH,
    ("clearance", "gap"): LENGTH,
    ("coupling", "bore_force"): FORCE,
    ("coupling", "stiffness_variation"): STIFFNESS,
    ("crack", "compliance"): COMPLIANCE,  # times a length along the shaft squared, which is left out
    ("cross_stiffness", "stiffness"): STIFFNESS,
    ("cubic_spring", "half_length"): LENGTH,
    ("cubic_spring", "k3"): CUBIC,
    ("damping_over_speed", "damping"): DAMPING,
    ("damping_over_speed", "reference"): RATE,
    ("drag", "coefficient"): DRAG,
    ("friction", "limit"): FORCE,
    ("friction", "stuck_stiffness"): STIFFNESS,
    ("hysteresis", "frequency"): RATE,
    ("internal_damping", "time"): TIME,
    ("loose_disk", "clearance"): LENGTH,
    ("loose_pedestal", "lift"): LENGTH,
    ("magnetic_pull", "gap"): LENGTH,
    ("magnetic_pull", "pull"): FORCE,
    ("pedestal", "compliance"): COMPLIANCE,
    ("pedestal", "frequency"): RATE,
    ("rub", "stiffness"): STIFFNESS,
    ("rub", "gap"): LENGTH,
    ("seal", "damping"): DAMPING,
    ("skew_stiffness", "reference"): RATE,
    ("skew_stiffness", "stiffness"): STIFFNESS,
    ("slipping_coupling", "bore_force"): FORCE,
    ("snubber", "gap"): LENGTH,
    ("snubber", "stiffness"): STIFFNESS,
    ("soft_left_bearing", "compliance"): COMPLIANCE,
    ("stiffness_over_speed", "reference"): RATE,
    ("twice_line_pull", "pull"): FORCE,
    ("unbalance_drift", "amount"): UNBALANCE,
    ("unbalance_plane", "amount"): UNBALANCE,
    ("unbalance_plane", "radius"): LENGTH,
    ("unbalance_step", "amount"): UNBALANCE,
    ("unbalance_step", "speed"): RATE,
}
BETWEEN_BEARINGS = {("crack", "position"), ("seal", "position"), ("snubber", "position")}
BESIDE_THE_DISK = {("rub", "position"), ("unbalance_plane", "position")}


def fault_of(rig: RigConfig, name: str, *, seed: int, runs: int) -> FaultSpec:
    """Return fault `name` at the size a blind case of that seed has it on `rig`. Raises DataError if there is none."""
    drawn = draw_fault(rig, name, seed=seed, runs=runs)
    plate, own = _rk4()
    if rig.shaft == plate.shaft:
        return drawn
    scales = _scales(character(rig), own)
    known = _defaults(name) | drawn.parameters
    return replace(drawn, parameters={p: _carried(rig, name, p, value, scales) for p, value in known.items()})


def _carried(rig: RigConfig, fault: str, parameter: str, value: float, scales: tuple[float, float, float]) -> float:
    """Return the value of a parameter on `rig` that it would have on the RK4."""
    key = (fault, parameter)
    if key in BETWEEN_BEARINGS or key in BESIDE_THE_DISK:
        return _place(rig, value, between_bearings=key in BETWEEN_BEARINGS)
    for scale, power in zip(scales, POWERS.get(key, (0, 0, 0)), strict=True):
        value *= scale**power
    return value


def _place(rig: RigConfig, position: float, *, between_bearings: bool) -> float:
    """Return the place on `rig` [m] that divides the stretch it lies in as on the RK4."""
    (start, end), (to, till) = (_stretch(r, between_bearings=between_bearings) for r in (_rk4()[0], rig))
    return to + (position - start) / (end - start) * (till - to)


def _stretch(rig: RigConfig, *, between_bearings: bool) -> tuple[float, float]:
    """Return the places [m] of the bearing or of the disk that is nearest to the bearing sought, and of that one."""
    assert rig.identify is not None
    sought = rig.bearing(rig.identify.bearings[0][0])
    parts = (
        [b.position for b in rig.bearings if b is not sought] if between_bearings else [d.position for d in rig.disks]
    )
    return min(parts, key=lambda z: abs(z - sought.position)), sought.position


def _scales(rig: Character, like: Character) -> tuple[float, float, float]:
    return rig.stiffness / like.stiffness, rig.peak / like.peak, like.critical / rig.critical


def _defaults(name: str) -> dict[str, float]:
    """Return the parameters of a fault that no blind case draws but that have a scale."""
    scaled = {p for fault, p in {*POWERS, *BETWEEN_BEARINGS, *BESIDE_THE_DISK} if fault == name}
    return {p: value for p, value in load_fault(name).PARAMETERS.items() if p in scaled}


@cache
def _rk4() -> tuple[RigConfig, Character]:
    rig = load(RK4)
    return rig, character(rig)
