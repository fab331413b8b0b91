"""Masses, bearing loads, static sag, modes and stability of the nameplate model: `rotor check --model`."""

import numpy as np
from rich import box
from rich.table import Table

from rotorrig.rig.config import RPM, RigConfig
from rotorrig.sims.rotor.model import RotorModel, assemble
from rotorrig.sims.rotor.modes import (
    bearing_loads,
    campbell,
    critical_modes,
    critical_speeds,
    shaft_mass,
    stability_onset,
    static_sag,
)

CIRCULAR = 0.1  # of a mode's whirl: below, neither forward nor backward
SPEEDS = 31  # of the Campbell diagram
MODES = 6


def masses(rig: RigConfig) -> Table:
    """Return the masses of shaft and disks and their sum."""
    table = _table("Masses", "part", "kg")
    shaft = shaft_mass(rig.shaft)
    table.add_row("shaft", f"{shaft:.3f}")
    for disk in rig.disks:
        table.add_row(_part_name("disk", disk.name), f"{disk.mass:.3f}")
    table.add_row("total", f"{shaft + sum(disk.mass for disk in rig.disks):.3f}", style="bold")
    return table


def at_rest(rig: RigConfig, model: RotorModel) -> Table:
    """Return bearing loads and the static sag at bearings, disks and probes.

    Raises ValueError if the bearings do not support the shaft.
    """
    axis = {"-x": 0, "-y": 1}[rig.gravity]
    across = 1 - axis
    sag = static_sag(model, rig.gravity)
    loads = bearing_loads(rig)
    table = _table(f"At rest, gravity along {rig.gravity}", "at", "mm", "load, N", "sag, um")

    def row(name: str, position: float, load: str = "") -> None:
        drop = -sag[axis, np.argmin(np.abs(model.z - position))]
        table.add_row(name, f"{position * 1e3:g}", load, f"{drop * 1e6:.1f}")

    for bearing, load in zip(rig.bearings, loads, strict=True):
        sideways = f" ({load[across]:+.2f} across)" if abs(load[across]) > 1e-3 * abs(load[axis]) else ""
        row(_part_name("bearing", bearing.name), bearing.position, f"{-load[axis]:.2f}{sideways}")
    for disk in rig.disks:
        row(_part_name("disk", disk.name), disk.position)
    for place in sorted({probe.position for probe in rig.probes}):
        row("probes " + ", ".join(p.name for p in rig.probes if p.position == place), place)
    return table


def criticals(model: RotorModel, *, up_to: float) -> Table:
    """Return the 1X critical speeds up to a speed [rad/s] with damping and whirl."""
    table = _table(f"Critical speeds up to {up_to * RPM:.0f} rpm", "rpm", "damping ratio, %", "whirl")
    for mode in critical_modes(model, up_to=up_to):
        table.add_row(f"{mode.omega * RPM:.1f}", f"{100 * mode.damping_ratio:.2f}", _whirl(mode.whirl, model.rotation))
    if not table.rows:
        table.add_row("none", "", "")
    return table


def natural_frequencies(model: RotorModel, *, up_to: float) -> Table:
    """Return the lowest modes at rest and at a speed [rad/s]: both ends of the Campbell diagram."""
    branches = campbell(model, np.linspace(0.0, up_to, SPEEDS), count=MODES)
    top = f"{up_to * RPM:.0f} rpm"
    table = _table("Natural frequencies", "Hz at rest", f"Hz at {top}", "damping ratio, %", "whirl")
    for at_rest, at_top, damping, sense in zip(
        branches.frequency[0], branches.frequency[-1], branches.damping_ratio[-1], branches.whirl[-1], strict=True
    ):
        if np.isnan(at_top):
            table.add_row(_hertz(at_rest), "overdamped", "", "")
        else:
            table.add_row(_hertz(at_rest), _hertz(at_top), f"{100 * damping:.2f}", _whirl(sense, model.rotation))
    return table


def stability(model: RotorModel, *, up_to: float) -> str:
    """Return one sentence on the stability between rest and a speed [rad/s]."""
    onset = stability_onset(model, up_to=up_to)
    if onset is None:
        return f"stable from rest to {up_to * RPM:.0f} rpm"
    motion = f"a {_whirl(onset.whirl, model.rotation)} whirl of {onset.frequency * RPM:.0f} cpm grows"
    if onset.frequency == 0:
        motion = "a deflection grows without oscillating"
    return f"UNSTABLE from {onset.omega * RPM:.0f} rpm on: {motion}"


def mesh(rig: RigConfig, model: RotorModel, *, up_to: float) -> str:
    """Return the mesh size, and the shift of the critical speeds with the chapter's lumped mass."""
    lumped = critical_speeds(assemble(rig, element="lumped"), up_to=up_to)
    consistent = critical_speeds(model, up_to=up_to)
    moved = ""
    if len(consistent) and len(lumped) == len(consistent):
        worst = 100 * np.abs(lumped / consistent - 1).max()
        moved = f"; the chapter's lumped mass shifts the critical speeds by at most {worst:.2g} %"
    longest = np.diff(model.z).max() * 1e3
    return f"{len(model.z) - 1} Timoshenko elements of at most {longest:.3g} mm{moved}"


def _whirl(sense: float, rotation: int) -> str:
    """Return "forward", "backward" or "straight", with respect to the sense of rotation."""
    sense *= rotation
    return "straight" if abs(sense) < CIRCULAR else "forward" if sense > 0 else "backward"


def _part_name(kind: str, name: str) -> str:
    return name if name.lower().startswith(kind) else f"{kind} {name}"


def _hertz(frequency: float) -> str:
    return f"{frequency / (2 * np.pi):.2f}"


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for column in columns:
        text = column in ("part", "at", "whirl")
        table.add_column(column, justify="left" if text else "right", no_wrap=True)
    return table
