"""Verbs that compare a response with the model, and show it: identify, diagnose, report, view."""

import json
from pathlib import Path
from typing import Annotated, Literal

import typer

from rotorrig.app.terminal import err, out, tell, working
from rotorrig.app.verbs.arguments import AsJson, Out, Response, Seed, load_config


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
    as_json: AsJson = False,
    seed: Seed = 0,
) -> None:
    """Fit bearing stiffness, damping and unbalance."""
    from rotorrig.app.commands import identify
    from rotorrig.app.terminal import tables
    from rotorrig.identify import identification_table, write_identification
    from rotorrig.processing.files import read_response

    measured = read_response(response)
    found = identify.identified(
        measured, objective=objective, profile=profile, draws=bootstrap, workers=workers, seed=seed
    )
    write_identification(out_file, found)
    if as_json:
        tell("", {"file": str(out_file), **identification_table(found)}, as_json=True)
        return
    out.print(tables.identified(found))
    for words in found.fits[0].words:
        out.print(words, highlight=False)
    if measured.rig.effects:
        labels = "; ".join(effect.label for effect in measured.rig.effects)
        out.print(f"The config's effects ({labels}) are not in this fit, only in rotor diagnose.", highlight=False)
    out.print(f"{out_file}: {len(found.fits)} fit{'s' * (len(found.fits) != 1)} in {found.wall_s:.1f} s")


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
    from rotorrig.app.commands import diagnose
    from rotorrig.identify import diagnosis_table, write_diagnosis

    paths = [*responses, holdout] if holdout else responses
    seen = diagnose.read_responses(paths, config=load_config(config) if config else None)
    used, unseen = seen[: len(responses)], seen[-1] if holdout else None
    try:
        found = diagnose.diagnosed(used, holdout=unseen, model=model, seed=seed)
    except KeyboardInterrupt as interrupt:
        err.print(f"interrupted: {out_file} was not written", highlight=False)
        raise typer.Exit(130) from interrupt
    write_diagnosis(out_file, found)
    if as_json:
        print(json.dumps(diagnosis_table(found)))
    else:
        diagnose.show(found)
    if rig_out:
        extended = diagnose.write_extended(rig_out, used[0].rig, found)
        labels = "; ".join(effect.label for effect in extended.effects)
        (err if as_json else out).print(f"{rig_out}: the config, its model extended by {labels}", highlight=False)


def report(
    response: Response,
    out_file: Out,
    fit: Annotated[Path | None, typer.Option(help="the fit.json to report")] = None,
    diagnosis: Annotated[Path | None, typer.Option(help="the diagnosis.json to report")] = None,
) -> None:
    """Write one self-contained HTML file: verdict, Bode plots, values, provenance."""
    from rotorrig.app.report import write_report
    from rotorrig.identify import read_diagnosis, read_identification
    from rotorrig.processing.files import read_response

    with working(f"writing {out_file.name}"):
        write_report(
            out_file,
            response=read_response(response),
            identification=read_identification(fit) if fit else None,
            diagnosis=read_diagnosis(diagnosis) if diagnosis else None,
        )
    out.print(f"{out_file}: open it in any browser")


def view(
    file: Annotated[Path, typer.Argument(help="run.mcap, response.mcap or an .rrd", show_default=False)],
    fit: Annotated[Path | None, typer.Option(help="the fit.json of a response.mcap", show_default=False)] = None,
    diagnosis: Annotated[Path | None, typer.Option(help="its diagnosis.json", show_default=False)] = None,
    run: Annotated[Path | None, typer.Option(help="the run.mcap it was made of", show_default=False)] = None,
    out_file: Annotated[
        Path | None, typer.Option("--out", "-o", help="write a response's .rrd, and do not open it", show_default=False)
    ] = None,
) -> None:
    """Open a file in the Rerun viewer; a response with its fit and diagnosis, and the run for what was recorded."""
    from rotorrig.app.viewer import Evidence, save_result, view_file

    evidence = Evidence(fit=fit, diagnosis=diagnosis, run=run)
    if out_file is None:
        view_file(file, evidence)
        return
    save_result(file, out_file, evidence)
    out.print(f"{out_file}: rotor view {out_file} opens it", highlight=False, markup=False, soft_wrap=True)
