"""Verbs for a rig: init, check, sweep, investigate, stop, simulate, demo."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from rotorrig.app.terminal import err, out, tell
from rotorrig.app.verbs.arguments import (
    OUT,
    AsJson,
    Config,
    Faults,
    Force,
    Hidden,
    Hold,
    LiveUnits,
    Plan,
    Rate,
    Seed,
    Trial,
    View,
    load_config,
    unit_of_view,
)
from rotorrig.app.verbs.output_guard import Arguments, Output
from rotorrig.rig import ConfigError, RigError
from rotorrig.rig.config import RigConfig, bundled_config, bundled_configs, copy_config, load, read_quantity


def _bundled_name(given: Arguments) -> Path | None:
    return Path(f"{given['name']}.toml") if given["name"] else None


def _certificate_file(given: Arguments) -> Path | None:
    from rotorrig.acquisition.proof_test import certificate_file

    return certificate_file(given["config"]) if given["proof_test"] and not given["simulate"] else None


def _demo_files(folder: Path) -> Mapping[Path, str]:
    from rotorrig.app.commands.demo import files_in

    return files_in(folder)


def init(
    name: Annotated[
        str | None, typer.Argument(metavar="[NAME]", help="of a bundled config; without it they are listed")
    ] = None,
    out_file: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="the file to write", show_default="NAME.toml"),
        Output(kind="config", default=_bundled_name),
    ] = None,
    force: Force = False,
) -> None:
    """Write a bundled config to start from; without NAME, list them."""
    if name:
        path = out_file or Path(f"{name}.toml")
        copy_config(name, path)
        out.print(
            f"{path}: a copy of the bundled config; rotor check {path} says what it describes",
            highlight=False,
            soft_wrap=True,
        )
        return
    if out_file:
        raise ConfigError("--out: wants the NAME of a bundled config; rotor init lists them")
    configs = bundled_configs()
    for known, file in configs.items():
        out.print(f"{known:<{max(map(len, configs))}}  {load(file).name}", highlight=False, markup=False)


def check(
    config: Config,
    connect: Annotated[
        bool, typer.Option("--connect", help="connect to motor and DAQ and print their replies")
    ] = False,
    clear: Annotated[bool, typer.Option("--clear-fault", help="clear the motor controller's fault")] = False,
    model: Annotated[bool, typer.Option("--model", help="draw the rotor; masses, static sag, critical speeds")] = False,
    proof_test: Annotated[
        bool, typer.Option("--proof-test", help="turn the rotor, provoke every protection and time its stop")
    ] = False,
    out_file: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="the proof test's certificate", show_default="CONFIG.proof.json"),
        Output(kind="proof", default=_certificate_file),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", help="proof test: turn the rotor without asking")] = False,
    simulate: Annotated[bool, typer.Option("--simulate", help="proof test: of a simulated rig")] = False,
    seed: Seed = 1,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Check a config and print its parts; with --connect, query its devices; with --proof-test, its protections."""
    from rotorrig.app.commands import check as checking

    rig = load_config(config)
    if proof_test:
        if connect or clear or model:
            raise ConfigError("--proof-test: goes without --connect, --clear-fault and --model")
        path = out_file or _certificate_file({"config": config, "proof_test": True, "simulate": simulate})
        _prove(rig, path, simulate=simulate, seed=seed, yes=yes, as_json=as_json)
        return
    if out_file or yes or simulate:
        raise ConfigError("--out, --yes and --simulate: go with --proof-test")
    if as_json:
        if model or clear:
            raise ConfigError("--json: goes with --connect alone, want it without --model and --clear-fault")
        tell("", {**checking.rig_facts(rig), **(checking.device_facts(rig) if connect else {})}, as_json=True)
        return
    checking.show_rig(rig)
    if model:
        checking.show_model(rig)
    if clear:
        checking.clear_fault(rig)
    if connect:
        checking.show_devices(rig)


def _prove(rig: RigConfig, path: Path | None, *, simulate: bool, seed: int, yes: bool, as_json: bool) -> None:
    """Run the proof test and print its certificate. Raises RigError if a protection failed."""
    from rotorrig.acquisition.proof_test import certificate_facts
    from rotorrig.app.commands import check as checking
    from rotorrig.app.commands.simulate import SimulatedRig
    from rotorrig.app.terminal import proof_table

    simulation = SimulatedRig(seed=seed, rate=1.0) if simulate else None
    try:
        certificate = checking.run_proof_test(rig, out_file=path, simulation=simulation, yes=yes)
    except KeyboardInterrupt as interrupt:  # a sweep's comes once the rotor is at rest; between them it is
        err.print("interrupted: the rotor is at rest; no certificate was written", highlight=False)
        raise typer.Exit(130) from interrupt
    if as_json:
        tell("", certificate_facts(certificate), as_json=True)
    else:
        out.print(proof_table(certificate))
    checking.refuse_failed(certificate, out_file=path)
    if not as_json:
        tell(checking.describe_certificate(certificate, out_file=path), {}, as_json=False)


def sweep(
    config: Config,
    out_file: Annotated[Path | None, OUT, Output(kind="run", unless="dry_run")] = None,
    plan: Plan = "default",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="preview the sweep; opens no device")] = False,
    simulate: Annotated[bool, typer.Option("--simulate", help="use a simulated rig instead of the devices")] = False,
    trial: Trial = None,
    hold: Hold = None,
    view: View = False,
    units: LiveUnits = None,
    yes: Annotated[bool, typer.Option("--yes", help="rehearsal: do not wait for trial masses to be mounted")] = False,
    rolling: Annotated[bool, typer.Option("--rolling", help="take over a rotor that turns already")] = False,
    seed: Seed = 1,
    hidden: Hidden = None,
    rate: Rate = 20.0,
    faults: Faults = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Run a sweep and record it; with --dry-run, show its steps, limits and objections."""
    if faults and not simulate:
        raise ConfigError("--faults: wants --simulate, faults are scripted on a simulated rig only")
    unit = unit_of_view(units, view=view)
    rig = load_config(config)
    speeds = [read_quantity(text, "speed", where="--hold", positive=True) for text in hold or ()]
    if dry_run:
        from rotorrig.app.commands import sweep_preview as previewing

        previewing.show(rig, plan, trial=trial or (), speeds=speeds, as_json=as_json)
        return
    if out_file is None:
        raise ConfigError("--out: missing, want the file to write, or --dry-run")
    from rotorrig.acquisition.sweep import SweepInterrupted
    from rotorrig.app.commands import simulate as simulating
    from rotorrig.app.commands import sweep
    from rotorrig.app.text import proof_test_remark

    simulation = simulating.SimulatedRig(seed=seed, hidden=hidden, rate=rate, faults=faults) if simulate else None
    remark = "" if simulate else proof_test_remark(rig, config)
    if remark:
        err.print(f"note: {remark}", highlight=False, soft_wrap=True)
    places = [out_file]  # the recording's; another if its folder vanishes
    try:
        result = sweep.sweep(
            rig,
            out=out_file,
            plan=plan,
            trial=trial or (),
            speeds=speeds,
            simulation=simulation,
            view=view,
            unit=unit,
            yes=yes,
            overwrite=force,
            rolling=rolling,
            on_move=places.append,
            remark=remark,
        )
    except SweepInterrupted as interrupt:  # Ctrl-C, SIGTERM, or the terminal was closed
        err.print(f"interrupted: the rotor is at rest; {places[-1]} holds the sweep so far", highlight=False)
        raise typer.Exit(130) from interrupt
    finally:
        if len(places) > 1:
            err.print(f"warning: {out_file}: vanished during the sweep; the recording is {places[-1]}", soft_wrap=True)
    out_file = places[-1]
    words = f"{out_file}: {result.seconds:.1f} s, {result.samples} scans, {result.gaps} gaps recorded"
    tell(words, {"file": str(out_file), **sweep.sweep_facts(result)}, as_json=as_json)
    if result.trip:
        raise RigError(f"{result.trip}; the rotor is at rest; {out_file} holds the sweep up to the trip")


def investigate(
    config: Config,
    folder: Annotated[Path, typer.Option("--out", "-o", help="the folder to work in", show_default=False)],
    plan: Plan = "default",
    budget: Annotated[str, typer.Option(help="runs and time at the rig, at most: '6 runs, 30 min'")] = "6 runs",
    unattended: Annotated[
        bool, typer.Option("--unattended", help="ask nobody, mount nothing; wants a valid proof test")
    ] = False,
    simulate: Annotated[bool, typer.Option("--simulate", help="use a simulated rig instead of the devices")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="rehearsal: do not wait for the operator")] = False,
    seed: Seed = 1,
    hidden: Hidden = None,
    rate: Rate = 20.0,
    as_json: AsJson = False,
) -> None:
    """Sweep, diagnose and choose the next run by what would tell most, until the rig is understood.

    What is known is in the folder at once: killed at any moment, the same command goes on from there. Ends with a
    report and, if a cause is named, the config extended by it.
    """
    from rotorrig.acquisition.sweep import SweepInterrupted
    from rotorrig.app.commands import diagnose
    from rotorrig.app.commands import investigate as investigating
    from rotorrig.app.commands.simulate import SimulatedRig
    from rotorrig.investigation import read_budget

    setup = investigating.prepare(
        load_config(config),
        config=config,
        folder=folder,
        plan=plan,
        budget=read_budget(budget, where="--budget"),
        simulation=SimulatedRig(seed=seed, hidden=hidden, rate=rate) if simulate else None,
        unattended=unattended,
        yes=yes,
        seed=seed,
    )
    try:
        journal, diagnosis = investigating.investigate(setup)
    except SweepInterrupted as interrupt:
        err.print(f"interrupted: the rotor is at rest; the same command goes on from {folder}", highlight=False)
        raise typer.Exit(130) from interrupt
    except KeyboardInterrupt as interrupt:
        err.print(f"interrupted between runs; the same command goes on from {folder}", highlight=False)
        raise typer.Exit(130) from interrupt
    if not as_json:
        out.rule("verdict")
        diagnose.show(diagnosis)
        out.print(journal.ending, highlight=False, markup=False)
    tell(
        f"{setup.file(investigating.REPORT)}: how it was found; {setup.file(investigating.JOURNAL)}: the same as data",
        investigating.journal_facts(journal),
        as_json=as_json,
    )


def stop(config: Config) -> None:
    """Stop the rotor, whoever started it, and watch it to rest; fails unless it is proven at rest.

    A sweep that runs is told to stop and reports by itself. What an ended sweep has left to stop the rotor hands over.
    """
    from rotorrig.app.commands import stop as stopping

    say = partial(out.print, highlight=False, soft_wrap=True)
    say(stopping.stop(load_config(config), say=say))


def simulate(
    config: Config,
    seed: Seed = 1,
    hidden: Hidden = None,
    rate: Rate = 1.0,
    faults: Faults = None,
) -> None:
    """Keep a simulated rig running on real ports until Ctrl-C, for another terminal to sweep."""
    from rotorrig.app.commands import simulate as simulating

    simulation = simulating.SimulatedRig(seed=seed, hidden=hidden, rate=rate, faults=faults)
    simulating.run_until_interrupted(load_config(config), simulation)


def demo(
    folder: Annotated[
        Path, typer.Option("--out", help="the folder to write into"), Output(kind="", files=_demo_files)
    ] = Path("demo"),
    config: Annotated[Path | None, typer.Option("--config", help="another rig", show_default="rk4")] = None,
    seed: Seed = 1,
    force: Force = False,
) -> None:
    """Sweep, track, identify, diagnose and report a simulated RK4: once healthy, once with a bent shaft."""
    from rotorrig.app.commands.demo import run_demo

    run_demo(load_config(config or bundled_config("rk4")), out=folder, seed=seed)
