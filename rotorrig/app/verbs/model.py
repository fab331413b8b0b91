"""Verbs that fit a model to a response and show the result: identify, diagnose, report, view."""

import json
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Literal

import typer

from rotorrig.app.terminal import err, out, tell, working
from rotorrig.app.verbs.arguments import OUT, AsJson, Force, Response, Seed, Units, load_config
from rotorrig.app.verbs.output_guard import Output

Responses = Annotated[
    list[Path], typer.Argument(metavar="RESPONSE...", help="response.mcap files of one rig", show_default=False)
]


def identify(
    responses: Responses,
    out_file: Annotated[Path, OUT, Output(kind="fit")],
    objective: Annotated[
        Literal["residual", "f1", "f2", "f3"],
        typer.Option(help="cost function: complex residual, or the chapter's amplitude errors, eq. 14-16"),
    ] = "residual",
    search: Annotated[
        Literal["vector", "modern", "seed"] | None,
        typer.Option(
            help="global search: by residuals and derivatives, or by the cost alone, seed as the chapter did",
            show_default="the config's",
        ),
    ] = None,
    profile: Annotated[
        bool, typer.Option("--profile", help="95 % intervals of all parameters by profile likelihood")
    ] = False,
    bootstrap: Annotated[int, typer.Option(min=0, help="95 % intervals by parametric bootstrap, this many draws")] = 0,
    workers: Annotated[int, typer.Option(min=1, help="bootstrap processes")] = 1,
    force: Force = False,
    as_json: AsJson = False,
    seed: Seed = 0,
) -> None:
    """Fit bearing stiffness, damping and unbalance to one or more responses of a rig."""
    from rotorrig.app.commands import diagnose, identify
    from rotorrig.app.terminal import tables
    from rotorrig.app.text import misfit_sentence, search_line, stages_text
    from rotorrig.identify import identification_table, write_identification

    measured = diagnose.read_responses(responses)
    identification = identify.identify_responses(
        measured, objective=objective, method=search, profile=profile, draws=bootstrap, workers=workers, seed=seed
    )
    write_identification(out_file, identification)
    if as_json:
        tell("", {"file": str(out_file), **identification_table(identification)}, as_json=True)
        return
    out.print(tables.identification_table(identification))
    for part in (search_line(identification.fits[0]), tables.search_table(identification.fits[0])):
        out.print(part, highlight=False)
    out.print(stages_text(identification.fits[0]), highlight=False)
    out.print(misfit_sentence(identification.fits[0]), highlight=False)
    out.print(tables.critical_speeds_table(measured[0], identification), highlight=False)
    diagnose.show_nameplate(identification.fits[0].nameplate)
    for words in identification.fits[0].words:
        out.print(words, highlight=False)
    number = len(identification.fits)
    out.print(f"{out_file}: {number} fit{'s' * (number != 1)} in {identification.wall_s:.1f} s")


def diagnose(
    responses: Responses,
    out_file: Annotated[Path, OUT, Output(kind="diagnosis")],
    holdout: Annotated[Path | None, typer.Option(help="response to validate on; no fit uses it")] = None,
    config: Annotated[
        Path | None,
        typer.Option(help="the rig's TOML file with an extended model, instead of the one in the responses"),
    ] = None,
    rig_out: Annotated[
        Path | None, typer.Option(help="config to write, with the named cause in its model"), Output(kind="config")
    ] = None,
    model: Annotated[
        Literal["swept", "quasi-static"], typer.Option(help="model the speed ramp, or take every row as steady state")
    ] = "swept",
    time_limit: Annotated[
        str | None, typer.Option(help="end after that time, such as '5 min', with the best so far, as on Ctrl-C")
    ] = None,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="print the result as JSON, without arrays")] = False,
    seed: Seed = 0,
) -> None:
    """Test whether the model is adequate; if not, locate the misfit, name the cause and cross-validate it."""
    from rotorrig.app.commands import diagnose
    from rotorrig.identify import diagnosis_table, write_diagnosis

    paths = [*responses, holdout] if holdout else responses
    seen = diagnose.read_responses(paths, config=load_config(config) if config else None)
    used, unseen = seen[: len(responses)], seen[-1] if holdout else None
    try:
        diagnosis = diagnose.diagnose_responses(used, holdout=unseen, model=model, seed=seed, time_limit=time_limit)
    except KeyboardInterrupt as interrupt:
        err.print(f"interrupted: {out_file} was not written", highlight=False)
        raise typer.Exit(130) from interrupt
    write_diagnosis(out_file, diagnosis)
    if as_json:
        print(json.dumps(diagnosis_table(diagnosis)))
    else:
        diagnose.show(diagnosis)
    if rig_out:
        extended = diagnose.write_extended(rig_out, used[0].rig, diagnosis)
        labels = "; ".join(effect.label for effect in extended.effects)
        (err if as_json else out).print(f"{rig_out}: the config with {labels} in its model", highlight=False)


def report(
    response: Response,
    out_file: Annotated[Path, OUT, Output(kind="report")],
    fit: Annotated[Path | None, typer.Option(help="fit.json to include")] = None,
    diagnosis: Annotated[Path | None, typer.Option(help="diagnosis.json to include")] = None,
    balance: Annotated[Path | None, typer.Option(help="balance.json to include")] = None,
    operating_speed: Annotated[
        str | None,
        typer.Option(help="'3000 rpm' or '2800 to 3200 rpm': tells the separation margins", show_default=False),
    ] = None,
    run: Annotated[
        Path | None, typer.Option(help="run.mcap the response was tracked from: adds its cascade and time bases")
    ] = None,
    units: Units = None,
    force: Force = False,
) -> None:
    """Write one self-contained HTML file: verdict, Bode plots, values, provenance."""
    from rotorrig.acquisition.files import open_recording
    from rotorrig.app.report import write_report
    from rotorrig.app.text import read_amplitude_unit
    from rotorrig.balancing import read_balance
    from rotorrig.identify import read_diagnosis, read_identification
    from rotorrig.processing import SpeedWindow
    from rotorrig.processing.files import read_response

    operating = SpeedWindow.read_one_or_two(operating_speed, where="--operating-speed") if operating_speed else None
    shown = read_amplitude_unit(units, where="--units") if units else ""
    with working(f"writing {out_file.name}"), open_recording(run) if run else nullcontext() as recording:
        write_report(
            out_file,
            response=read_response(response),
            identification=read_identification(fit) if fit else None,
            diagnosis=read_diagnosis(diagnosis) if diagnosis else None,
            balance=read_balance(balance) if balance else None,
            operating=operating,
            recording=recording,
            units=shown,
        )
    out.print(f"{out_file}: open in any browser")


def view(
    file: Annotated[Path, typer.Argument(help="run.mcap, response.mcap or an .rrd", show_default=False)],
    fit: Annotated[Path | None, typer.Option(help="fit.json of the response", show_default=False)] = None,
    diagnosis: Annotated[Path | None, typer.Option(help="diagnosis.json of the response", show_default=False)] = None,
    balance: Annotated[Path | None, typer.Option(help="balance.json of the response", show_default=False)] = None,
    run: Annotated[Path | None, typer.Option(help="run.mcap the response was tracked from", show_default=False)] = None,
    out_file: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="write an .rrd file instead of opening the viewer", show_default=False),
        Output(kind="rrd"),
    ] = None,
    force: Force = False,
    units: Units = None,
) -> None:
    """Open a file in the Rerun viewer; a response together with what was made of it."""
    from rotorrig.app.text import AS_STATED, AmplitudeUnit, read_amplitude_unit
    from rotorrig.app.viewer import Evidence, save_view, view_file

    unit = AmplitudeUnit(read_amplitude_unit(units, where="--units")) if units else AS_STATED
    evidence = Evidence(fit=fit, diagnosis=diagnosis, balance=balance, run=run, unit=unit)
    if out_file is None:
        view_file(file, evidence)
        return
    save_view(file, out_file, evidence)
    out.print(f"{out_file}: open with rotor view {out_file}", highlight=False, markup=False, soft_wrap=True)
