"""`rotor check`: what a config describes, and what answers at its ports."""

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.app import tables
from rotorrig.app.console import out
from rotorrig.app.effect_check import check_effects
from rotorrig.rig import connect
from rotorrig.rig.description import RigConfig
from rotorrig.rig.errors import DataError
from rotorrig.rig.units import RPM


@threadpool_limits.wrap(limits=1, user_api="blas")  # many small eigenvalue problems: threads only slow them down
def show_rig(rig: RigConfig) -> None:
    """Print the parts, and the critical speeds of the nameplate model. Raises ConfigError on an unknown effect."""
    from rotorrig.sims.rotor.assembly import assemble
    from rotorrig.sims.rotor.modes import critical_speeds

    check_effects(rig)
    out.print(tables.rig_parts(rig))
    ceiling = _ceiling(rig)
    speeds = np.asarray(critical_speeds(assemble(rig), up_to=ceiling)) * RPM
    listed = ", ".join(f"{s:.0f}" for s in speeds) or "none"
    out.print(f"critical speeds of the nameplate up to {ceiling * RPM:.0f} rpm: {listed}", highlight=False)


@threadpool_limits.wrap(limits=1, user_api="blas")
def show_model(rig: RigConfig) -> None:
    """Draw the rotor; print its masses, bearing loads and sag, critical speeds and stability. Raises DataError."""
    from rotorrig.app import model_summary
    from rotorrig.app.model_drawing import drawing
    from rotorrig.sims.rotor.assembly import assemble

    out.print(drawing(rig, width=out.width, plain=out.options.ascii_only))
    out.print()
    model = assemble(rig)
    out.print(model_summary.masses(rig))
    if rig.gravity != "none":
        try:
            out.print(model_summary.at_rest(rig, model))
        except ValueError as error:
            raise DataError(f"{rig.name}: {error}") from error
    top = _ceiling(rig)
    out.print(model_summary.criticals(model, up_to=top))
    out.print(model_summary.natural_frequencies(model, up_to=top))
    out.print(model_summary.stability(model, up_to=top), highlight=False)
    out.print(model_summary.mesh(rig, model, up_to=top), highlight=False)


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


def _ceiling(rig: RigConfig) -> float:
    return rig.motor.max_speed if rig.motor else 1000.0
