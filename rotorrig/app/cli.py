"""The command `rotor`: each verb parses, calls one public function, writes one file and prints one line.

Heavy libraries are imported inside the verb that needs them, so that `rotor --help` is quick.
"""

import json
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer
from rich.text import Text

from rotorrig.app.console import err, out, progress_bars
from rotorrig.rig.description import RigConfig, load
from rotorrig.rig.errors import ConfigError, RigError

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Acquisition and identification for a rotor test rig: from the wire to a fitted bearing.",
)

Config = Annotated[Path, typer.Argument(metavar="CONFIG", help="the rig's TOML file", show_default=False)]
Out = Annotated[Path, typer.Option("--out", "-o", help="the file to write", show_default=False)]
Response = Annotated[Path, typer.Argument(metavar="RESPONSE", help="a response.mcap", show_default=False)]
Recording = Annotated[Path, typer.Argument(metavar="RUN", help="a run.mcap", show_default=False)]
Seed = Annotated[int, typer.Option(help="of the search; of the simulated rig's hidden deviations")]
Hidden = Annotated[Path | None, typer.Option(help="a sealed file with what the simulated rig hides, instead of a seed")]
Rate = Annotated[float, typer.Option(help="simulated seconds per second, at the most")]
Faults = Annotated[Path | None, typer.Option(help="a script of what goes wrong on the simulated rig, in JSON")]
Trial = Annotated[
    list[str] | None,
    typer.Option(help="a trial mass on the rotor, 'disk: 12 g mm at 90 deg' from the keyphasor mark; repeatable"),
]
View = Annotated[bool, typer.Option("--view", help="show orbits, Bode plot, speed and time base while it runs")]


def main() -> None:
    """Run the command; a person's mistake ends in one sentence and a non-zero exit, never in a traceback."""
    try:
        app()
    except RigError as error:
        err.print("[red]error:[/]", Text(str(error)), highlight=False, soft_wrap=True)
        sys.exit(1)


@app.command()
def check(
    config: Config,
    connect: Annotated[bool, typer.Option("--connect", help="talk to motor and DAQ and say what answered")] = False,
    clear: Annotated[
        bool, typer.Option("--clear-fault", help="clear what the motor controller has tripped with")
    ] = False,
    model: Annotated[bool, typer.Option("--model", help="draw the rotor; masses, sag, critical speeds")] = False,
) -> None:
    """Check a config, say what it describes; with --connect, talk to its devices."""
    from rotorrig.app import checking

    rig = load(config)
    checking.show_rig(rig)
    if model:
        checking.show_model(rig)
    if clear:
        checking.clear_fault(rig)
    if connect:
        checking.show_devices(rig)


@app.command()
def sweep(
    config: Config,
    out_file: Annotated[Path | None, typer.Option("--out", "-o", help="the file to write", show_default=False)] = None,
    plan: Annotated[str, typer.Option(help="a plan of the config")] = "default",
    dry_run: Annotated[bool, typer.Option("--dry-run", help="say what it would do, and open nothing")] = False,
    simulate: Annotated[bool, typer.Option("--simulate", help="on a simulated rig instead of the devices")] = False,
    trial: Trial = None,
    view: View = False,
    yes: Annotated[bool, typer.Option("--yes", help="do not wait for masses to be mounted: a rehearsal")] = False,
    seed: Seed = 1,
    hidden: Hidden = None,
    rate: Rate = 20.0,
    faults: Faults = None,
) -> None:
    """Run a sweep and record it; with --dry-run, show its steps, its limits and what speaks against it."""
    if faults and not simulate:
        raise ConfigError("--faults: wants --simulate, only a simulated rig has faults to order")
    rig = load(config)
    if dry_run:
        from rotorrig.app import dry_run as previewing

        previewing.show(rig, plan, trial=trial or ())
        return
    if out_file is None:
        raise ConfigError("--out: is missing, want the file to write, or --dry-run")
    from rotorrig.app import simulating, sweeping

    stand_in = simulating.StandIn(seed=seed, hidden=hidden, rate=rate, faults=faults) if simulate else None
    try:
        result = sweeping.sweep(rig, out=out_file, plan=plan, trial=trial or (), stand_in=stand_in, view=view, yes=yes)
    except KeyboardInterrupt as interrupt:  # or SIGTERM, or the terminal was closed
        err.print(f"interrupted: the rotor was stopped and {out_file} holds the sweep up to there", highlight=False)
        raise typer.Exit(130) from interrupt
    out.print(f"{out_file}: {result.seconds:.1f} s, {result.samples} scans, {result.gaps} gaps recorded")
    if not result.at_rest:
        err.print(f"warning: {result.events[-1].text}", highlight=False, markup=False, soft_wrap=True)
    if result.trip:
        raise RigError(f"{result.trip}; the rotor was stopped and {out_file} holds the sweep up to there")


@app.command()
def replay(
    run: Recording,
    rate: Annotated[str, typer.Option(help="'max', or recorded seconds per second")] = "max",
    track: Annotated[Path | None, typer.Option(help="the response.mcap to write, of what was played")] = None,
    begin: Annotated[float, typer.Option("--from", help="seconds on the recording's clock to begin at")] = 0.0,
    view: View = False,
) -> None:
    """Play a recording as if it were live; with --track, track its orders: as `rotor track` does, at any rate."""
    from rotorrig.app import replaying

    seconds = replaying.play(run, rate=rate, view=view, track=track, begin=begin)
    out.print(f"{track or run}: {seconds:.1f} s replayed" + (" and tracked" if track else ""))


@app.command()
def track(run: Recording, out_file: Out, trial: Trial = None) -> None:
    """Track the orders of a recording into a response file, the slow-roll vector beside them.

    Trial masses are those the sweep noted; --trial stands instead of them.
    """
    from rotorrig.acquisition.mcap_file import read_recording
    from rotorrig.processing import pipeline
    from rotorrig.processing.response_file import write_response
    from rotorrig.rig.trial_mass import read_trial_mass

    recording = read_recording(run)
    masses = [read_trial_mass(text, rig=recording.rig) for text in trial] if trial else None
    with progress_bars() as bars:
        task = bars.add_task("tracking", total=1.0, note="")
        response = pipeline.track(recording, trial=masses, progress=lambda done: bars.update(task, completed=done))
        write_response(out_file, response)
    masked = int((~response.usable).any(axis=1).sum())
    loaded = ", ".join(dict.fromkeys(disk for run in response.runs for disk in run.trial_unbalance))
    out.print(
        f"{out_file}: {len(response.omega)} rows in {len(response.runs)} runs, {masked} with masked probes"
        + (f", with a trial mass on {loaded}" if loaded else "")
    )


@app.command()
def identify(
    response: Response,
    out_file: Out,
    objective: Annotated[
        Literal["residual", "f1", "f2", "f3"],
        typer.Option(help="of the search: the complex residual, or the chapter's on amplitudes, eq. 14-16"),
    ] = "residual",
    profile: Annotated[
        bool, typer.Option("--profile", help="95 % intervals by profile likelihood, all of them")
    ] = False,
    bootstrap: Annotated[int, typer.Option(min=0, help="95 % intervals by that many simulated measurements")] = 0,
    workers: Annotated[int, typer.Option(min=1, help="processes for the bootstrap")] = 1,
    seed: Seed = 0,
) -> None:
    """Fit bearing stiffness, damping and unbalance."""
    from rotorrig.app import identifying, tables
    from rotorrig.identify.result_files import write_identification
    from rotorrig.processing.response_file import read_response

    measured = read_response(response)
    found = identifying.identified(
        measured, objective=objective, profile=profile, draws=bootstrap, workers=workers, seed=seed
    )
    write_identification(out_file, found)
    out.print(tables.identified(found))
    for words in found.fits[0].words:
        out.print(words, highlight=False)
    if measured.rig.effects:
        labels = "; ".join(effect.label for effect in measured.rig.effects)
        out.print(f"The config's effects ({labels}) are not in this fit, only in rotor diagnose.", highlight=False)
    out.print(f"{out_file}: {len(found.fits)} fits in {found.wall_s:.1f} s")


@app.command()
def diagnose(
    responses: Annotated[list[Path], typer.Argument(metavar="RESPONSE...", help="of one rig", show_default=False)],
    out_file: Out,
    holdout: Annotated[Path | None, typer.Option(help="a response that no fit may see, to measure the gain on")] = None,
    config: Annotated[
        Path | None, typer.Option(help="the rig's TOML file as extended since, instead of the one in the responses")
    ] = None,
    rig_out: Annotated[Path | None, typer.Option(help="the config to write, extended by what was named")] = None,
    model: Annotated[
        Literal["swept", "quasi-static"], typer.Option(help="the passing speed in the model, or every row as steady")
    ] = "swept",
    as_json: Annotated[bool, typer.Option("--json", help="print the result as JSON, its arrays left out")] = False,
    seed: Seed = 0,
) -> None:
    """Say whether the model is adequate; if not, where it is wrong, name the cause and measure what it explains."""
    from rotorrig.app import diagnosing
    from rotorrig.identify.result_files import diagnosis_table, write_diagnosis

    paths = [*responses, holdout] if holdout else responses
    seen = diagnosing.read_responses(paths, config=load(config) if config else None)
    used, unseen = seen[: len(responses)], seen[-1] if holdout else None
    try:
        found = diagnosing.diagnosed(used, holdout=unseen, model=model, seed=seed)
    except KeyboardInterrupt as interrupt:
        err.print(f"interrupted: {out_file} was not written", highlight=False)
        raise typer.Exit(130) from interrupt
    write_diagnosis(out_file, found)
    if as_json:
        print(json.dumps(diagnosis_table(found)))
    else:
        diagnosing.show(found)
    if rig_out:
        extended = diagnosing.write_extended(rig_out, used[0].rig, found)
        labels = "; ".join(effect.label for effect in extended.effects)
        (err if as_json else out).print(f"{rig_out}: the config, its model extended by {labels}", highlight=False)


@app.command()
def report(
    response: Response,
    out_file: Out,
    fit: Annotated[Path | None, typer.Option(help="the fit.json to report")] = None,
    diagnosis: Annotated[Path | None, typer.Option(help="the diagnosis.json to report")] = None,
) -> None:
    """Write one self-contained HTML file: verdict, Bode plots, values, provenance."""
    from rotorrig.app.report import write_report
    from rotorrig.identify.result_files import read_diagnosis, read_identification
    from rotorrig.processing.response_file import read_response

    write_report(
        out_file,
        response=read_response(response),
        identification=read_identification(fit) if fit else None,
        diagnosis=read_diagnosis(diagnosis) if diagnosis else None,
    )
    out.print(f"{out_file}: open it in any browser")


@app.command()
def view(file: Annotated[Path, typer.Argument(help="run.mcap, response.mcap or an .rrd", show_default=False)]) -> None:
    """Open a file in the Rerun viewer."""
    from rotorrig.app.viewer import view_file

    view_file(file)


@app.command("import")
def import_(
    file: Annotated[Path, typer.Argument(help="CSV, UFF, TDMS, WAV; with --ross a rotor of ROSS", show_default=False)],
    out_file: Out,
    config: Annotated[Path | None, typer.Option("--config", help="the rig's TOML file", show_default=False)] = None,
    mapping: Annotated[
        Path | None,
        typer.Option("--mapping", "--vectors", help="a TOML file that says what channels or columns mean"),
    ] = None,
    ross: Annotated[bool, typer.Option("--ross", help="FILE is a rotor saved by ROSS: make a config of it")] = False,
    keep_nodes: Annotated[bool, typer.Option("--keep-nodes", help="with --ross: every element a section")] = False,
) -> None:
    """Bring in waveforms (to a run.mcap), by its mapping a Bode table (to a response.mcap), with --ross a rotor."""
    from rotorrig.app import importing, ross_exchange

    if ross and (config or mapping):
        raise ConfigError("--ross: wants neither --config nor --mapping, it makes a config")
    if ross:
        for line in ross_exchange.bring_in(file, out=out_file, keep_nodes=keep_nodes):
            out.print(line, highlight=False, markup=False, soft_wrap=True)
    elif config is None:
        raise ConfigError("--config: is missing, want the rig's TOML file, as it says what the columns are")
    else:
        said = importing.bring_in(file, rig=load(config), mapping=mapping, out=out_file)
        out.print(said, highlight=False, markup=False, soft_wrap=True)


@app.command()
def export(
    file: Annotated[Path, typer.Argument(help="a run.mcap or response.mcap; with --ross a config", show_default=False)],
    out_file: Out,
    ross: Annotated[bool, typer.Option("--ross", help="write the rotor of a config, for ROSS")] = False,
    max_element: Annotated[str, typer.Option(help="with --ross: the longest shaft element")] = "20 mm",
) -> None:
    """Write waveforms of a run or order vectors of a response as .csv or .uff; with --ross, a rotor for ROSS."""
    from rotorrig.app import exporting

    if ross:
        from rotorrig.app import ross_exchange

        for line in ross_exchange.write_out(file, out=out_file, max_element=max_element):
            out.print(line, highlight=False, markup=False, soft_wrap=True)
        return
    out.print(exporting.write_out(file, out_file), highlight=False, markup=False, soft_wrap=True)


@app.command()
def simulate(
    config: Config,
    seed: Seed = 1,
    hidden: Hidden = None,
    rate: Rate = 1.0,
    faults: Faults = None,
) -> None:
    """Keep a simulated rig running on real ports until Ctrl-C, for another terminal to sweep."""
    from rotorrig.app import simulating

    simulation = simulating.StandIn(seed=seed, hidden=hidden, rate=rate, faults=faults)
    simulating.stand_in(load(config), simulation)


@app.command()
def salvage(run: Recording, out_file: Out) -> None:
    """Make a valid recording of one that was cut off."""
    from rotorrig.acquisition.mcap_file import salvage as save

    saved = save(run, out_file)
    lost = "nothing was lost" if saved.whole else f"{saved.lost_bytes} bytes could not be read"
    out.print(f"{out_file}: {saved.seconds:.2f} s saved, {lost}")


@app.command()
def demo(
    folder: Annotated[Path, typer.Option("--out", help="the folder to write into")] = Path("demo"),
    config: Annotated[
        Path | None, typer.Option("--config", help="another rig", show_default="configs/rk4.toml")
    ] = None,
    seed: Seed = 1,
) -> None:
    """Show the whole path on a simulated RK4, from sweep to report: a healthy rig and one with a bent shaft."""
    from rotorrig.app.demo import run_demo

    run_demo(load(config) if config else bundled("rk4"), out=folder, seed=seed)


def bundled(name: str) -> RigConfig:
    """Return a config that comes with the program: from the checkout, or from the installed package."""
    places = [Path(__file__).parents[2] / "configs", Path(__file__).parents[1] / "configs"]
    return load(next((p for d in places if (p := d / f"{name}.toml").exists()), places[0] / f"{name}.toml"))


if __name__ == "__main__":
    main()
