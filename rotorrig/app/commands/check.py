"""`rotor check`: parts and critical speeds of a config, replies of its devices."""

from contextlib import ExitStack
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.acquisition.proof_test import (
    PARTS,
    Certificate,
    RigDevices,
    Verdict,
    plan_proof_test,
    proof_speed,
    prove_protections,
    write_certificate,
)
from rotorrig.app.commands.config_model import check_effects
from rotorrig.app.commands.simulate import SimulatedRig, run_simulated_rig
from rotorrig.app.commands.sweep import SIMULATED_PATIENCE, guardian_patience
from rotorrig.app.terminal import HINT, confirm, operator_for, out, progress_bars, rig_table
from rotorrig.rig import DataError, LinkLost, NotAtRest, RigError, connect
from rotorrig.rig.config import RPM, RigConfig
from rotorrig.rig.control import PERSIST


def show_rig(rig: RigConfig) -> None:
    """Print the parts, and the critical speeds of the nameplate model. Raises ConfigError on an unknown effect."""
    check_effects(rig)
    out.print(rig_table(rig))
    listed = ", ".join(f"{s:.0f}" for s in _critical_rpm(rig)) or "none"
    out.print(f"critical speeds of the nameplate model up to {_ceiling(rig) * RPM:.0f} rpm: {listed}", highlight=False)


def rig_facts(rig: RigConfig) -> dict[str, Any]:
    """Return name, critical speeds and plans of a config as plain values. Raises ConfigError on an unknown effect."""
    check_effects(rig)
    return {
        "rig": rig.name,
        "config_hash": rig.hash,
        "critical_speeds_rpm": _critical_rpm(rig),
        "searched_up_to_rpm": _ceiling(rig) * RPM,
        "plans": list(rig.plans),
    }


def device_facts(rig: RigConfig) -> dict[str, Any]:
    """Open motor and DAQ in turn and return their identification and state, speeds in rpm. Raises LinkLost."""
    with connect.motor(rig) as motor:
        drive, state = motor.open(), motor.read()
    with connect.daq(rig) as daq:
        info = daq.open()
    now = {"speed_rpm": state.speed * RPM, "running": state.running, "fault": state.fault}
    return {"motor": {**asdict(drive), **now}, "daq": asdict(info)}


@threadpool_limits.wrap(limits=1, user_api="blas")
def show_model(rig: RigConfig) -> None:
    """Draw the rotor; print its masses, bearing loads and sag, critical speeds and stability. Raises DataError."""
    from rotorrig.app.terminal import draw_rotor, model_summary
    from rotorrig.sims.rotor.model import assemble

    out.print(draw_rotor(rig, width=out.width, plain=out.options.ascii_only))
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
    """Open motor and DAQ in turn and print their identification and state. Raises LinkLost after both were tried."""
    lost = []
    for show in (_show_motor, _show_daq):
        try:
            show(rig)
        except LinkLost as error:
            lost.append(str(error))
    if lost:
        raise LinkLost("; ".join(lost))


def clear_fault(rig: RigConfig) -> None:
    """Clear the motor controller's fault and print it. Raises LinkLost, LimitExceeded if it stays."""
    with connect.motor(rig) as motor:
        motor.open()
        fault = motor.read().fault
        if fault:
            motor.clear_fault()
    out.print(f"motor: {'fault cleared: ' + fault if fault else 'no fault to clear'}", highlight=False)


def run_proof_test(rig: RigConfig, *, out_file: Path | None, simulation: SimulatedRig | None, yes: bool) -> Certificate:
    """Provoke the rig's protections one by one and write the certificate. Raises ConfigError, LinkLost.

    A simulated rig turns without a confirmation. Its time is the real one, as that of a drive's watchdog is.
    """
    plan_proof_test(rig)
    if simulation is None:
        confirm(
            f"The rotor will be turned at {proof_speed(rig) * RPM:.0f} rpm, {PARTS} times, and its protections "
            "provoked. Is nobody near it, and its guard closed?",
            yes=yes,
        )
    with ExitStack() as stack:
        ports = stack.enter_context(run_simulated_rig(rig, simulation)) if simulation else None
        bars = stack.enter_context(progress_bars())
        say = partial(bars.console.print, markup=False, highlight=False, soft_wrap=True)
        if bars.console.is_terminal:
            say(HINT)
        task = bars.add_task("proof test", total=PARTS, note="")
        certificate = prove_protections(
            rig,
            RigDevices(
                rig,
                guardian=guardian_patience(rig, simulated=ports is not None),
                persist=SIMULATED_PATIENCE if ports else PERSIST,
                motor_at=ports.motor if ports else None,
                daq_at=ports.daq if ports else None,
            ),
            simulated=ports is not None,
            operator=operator_for((), say=say, yes=yes),
            report=lambda name, number: bars.update(task, completed=number, note=name),
        )
    if out_file:
        write_certificate(out_file, certificate)
    return certificate


def refuse_failed(certificate: Certificate, *, out_file: Path | None) -> None:
    """Raise RigError if a protection failed, NotAtRest if the rotor may turn."""
    failed = next((proof for proof in certificate.proofs if proof.verdict is Verdict.FAILED), None)
    if failed is None:
        return
    where = f"; {out_file} holds the certificate" if out_file else ""
    if not failed.at_rest:
        raise NotAtRest(f"proof test: {failed.name} FAILED, {failed.why}{where}")
    raise RigError(f"proof test: {failed.name} FAILED, {failed.why}; the rotor is at rest{where}")


def describe_certificate(certificate: Certificate, *, out_file: Path | None) -> str:
    """Return one sentence about a certificate without a failure."""
    proven = [proof.name for proof in certificate.proofs if proof.verdict is Verdict.PASSED]
    absent = [f"{proof.name}: {proof.why}" for proof in certificate.proofs if proof.verdict is Verdict.NOT_AVAILABLE]
    words = f"{len(proven)} protections stopped the rotor in time"
    return "; ".join([f"{out_file}: {words}" if out_file else words, *(f"NOT AVAILABLE {text}" for text in absent)])


def _show_motor(rig: RigConfig) -> None:
    with connect.motor(rig) as motor:
        drive = motor.open()
        state = motor.read()
    turning = f"{state.speed * RPM:.0f} rpm, {'running' if state.running else 'at rest'}"
    watchdog = "no watchdog" if drive.watchdog is None else f"watchdog {drive.watchdog:g} s"
    out.print(f"motor: {drive.model} on {drive.link}", highlight=False)
    out.print(f"  {turning}, {'fault: ' + state.fault if state.fault else 'no fault'}, {watchdog}", highlight=False)
    for remark in drive.remarks:
        out.print(f"  {remark}", highlight=False)


def _show_daq(rig: RigConfig) -> None:
    with connect.daq(rig) as daq:
        info = daq.open()
    ends = ", ".join(dict.fromkeys(f"{volts:.4g} V" for volts in info.full_scale_volts))
    out.print(
        f"DAQ: {info.model}, serial {info.serial}: {info.channels} channels at {info.sample_rate:g} Hz, "
        f"full scale {ends}",
        highlight=False,
    )
    for remark in info.remarks:
        out.print(f"  {remark}", highlight=False)


@threadpool_limits.wrap(limits=1, user_api="blas")  # many small eigenvalue problems: threads only slow them down
def _critical_rpm(rig: RigConfig) -> list[float]:
    from rotorrig.sims.rotor.model import assemble
    from rotorrig.sims.rotor.modes import critical_speeds

    try:
        return (np.asarray(critical_speeds(assemble(rig), up_to=_ceiling(rig))) * RPM).tolist()
    except np.linalg.LinAlgError as error:
        raise DataError(f"{rig.name}: the model has no solution ({error}), want dimensions of a rotor") from error


def _ceiling(rig: RigConfig) -> float:
    return rig.motor.max_speed if rig.motor else 1000.0
