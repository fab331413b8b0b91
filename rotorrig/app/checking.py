"""`rotor check`: what a config describes, and what answers at its ports."""

import numpy as np

from rotorrig.app import tables
from rotorrig.app.console import out
from rotorrig.rig import connect
from rotorrig.rig.description import RigConfig
from rotorrig.rig.units import RPM


def show_rig(rig: RigConfig) -> None:
    """Print the parts, and the critical speeds of the nameplate model."""
    from rotorrig.sims.rotor.assembly import assemble
    from rotorrig.sims.rotor.modes import critical_speeds

    out.print(tables.rig_parts(rig))
    ceiling = rig.motor.max_speed if rig.motor else 1000.0
    speeds = np.asarray(critical_speeds(assemble(rig), up_to=ceiling)) * RPM
    listed = ", ".join(f"{s:.0f}" for s in speeds) or "none"
    out.print(f"critical speeds of the nameplate up to {ceiling * RPM:.0f} rpm: {listed}", highlight=False)


def show_devices(rig: RigConfig) -> None:
    """Open motor and DAQ in turn and print what they say of themselves. Raises LinkLost."""
    with connect.motor(rig) as motor:
        found = motor.open()
        state = motor.read()
        turning = f"{state.speed * RPM:.0f} rpm, " + ("running" if state.running else "at rest")
        out.print(f"motor: {found.model} on {found.link}: {turning}{', fault ' + state.fault if state.fault else ''}")
    with connect.daq(rig) as daq:
        info = daq.open()
        out.print(
            f"DAQ: {info.model}, serial {info.serial}: {info.channels} channels at {info.sample_rate:g} Hz",
            highlight=False,
        )
