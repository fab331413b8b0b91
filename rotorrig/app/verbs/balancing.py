"""Verbs that mount masses on paper: balance, predict."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from rotorrig.app.terminal import out, tell
from rotorrig.app.verbs.arguments import OUT, AsJson, Force, Units
from rotorrig.app.verbs.output_guard import Output
from rotorrig.rig import DataError

Responses = Annotated[
    list[Path], typer.Argument(metavar="RESPONSE...", help="response.mcap files of one rig", show_default=False)
]

PREDICTED = {".csv": "csv", ".json": "prediction", ".html": "report"}  # ending -> kind of file


def _predicted_kind(given: Mapping[str, Any]) -> str:
    return PREDICTED.get(given["out_file"].suffix.lower(), "csv")  # another ending is refused before the work


def balance(
    responses: Responses,
    out_file: Annotated[Path, OUT, Output(kind="balance")],
    fit: Annotated[Path | None, typer.Option(help="fit.json of these responses: no trial mass is needed")] = None,
    after: Annotated[Path | None, typer.Option(help="response of the run with the masses on, to compare")] = None,
    planes: Annotated[str | None, typer.Option(help="planes to correct, 'disk 1, disk 2'")] = None,
    speeds: Annotated[str | None, typer.Option(help="speeds that count, '1500 rpm, 1800 to 2400 rpm'")] = None,
    radius: Annotated[str | None, typer.Option(help="radius of the masses, '30 mm' or 'disk 1: 30 mm, ...'")] = None,
    holes: Annotated[int | None, typer.Option(help="holes per plane, evenly spaced")] = None,
    masses: Annotated[str | None, typer.Option(help="masses that fit a hole, '1 g, 2 g, 5 g'")] = None,
    first_hole: Annotated[str, typer.Option(help="angle of hole 1 from the mark; counted with the rotation")] = "0 deg",
    most_holes: Annotated[int, typer.Option(min=1, help="holes filled per plane, at most")] = 2,
    min_max: Annotated[
        bool, typer.Option("--min-max", help="make the largest amplitude least, not the sum of squares")
    ] = False,
    page: Annotated[
        Path | None, typer.Option(help="also write one sheet to print, .html"), Output(kind="report")
    ] = None,
    units: Units = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Say which mass to put where, by runs with trial masses, by the fitted model, or by both."""
    from rotorrig.app.commands.balancing import HoleOptions, balance_responses, show_balance
    from rotorrig.app.text import AMPLITUDE_UNITS, read_amplitude_unit
    from rotorrig.balancing import balance_table, write_balance

    shown = read_amplitude_unit(units, where="--units") if units else ""
    at_hand = HoleOptions(holes=holes, masses=masses, radius=radius, first=first_hole, most=most_holes)
    found, rig = balance_responses(
        responses, fit=fit, after=after, planes=planes, speeds=speeds, holes=at_hand, min_max=min_max
    )
    write_balance(out_file, found)
    if page:
        from rotorrig.app.report import write_balance_sheet

        write_balance_sheet(page, found, rig, units=shown)
    if as_json:
        tell("", {"file": str(out_file), **balance_table(found)}, as_json=True)
        return
    show_balance(found, shown or AMPLITUDE_UNITS[0])
    out.print(f"{out_file}: the correction, and the vibration predicted with it", highlight=False, soft_wrap=True)


def predict(
    responses: Responses,
    fit: Annotated[Path, typer.Option(help="fit.json of these responses", show_default=False)],
    out_file: Annotated[
        Path,
        typer.Option("--out", "-o", help="the file to write: .csv, .json, or a picture, .html", show_default=False),
        Output(kind=_predicted_kind),
    ],
    mass: Annotated[
        list[str] | None,
        typer.Option(help="mass to put on, 'disk: 24 g mm at 135 deg' from the keyphasor mark; repeatable"),
    ] = None,
    units: Units = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Predict the vibration of the first response with masses on, by the fitted model, with 95 % bands."""
    from rotorrig.app.commands.balancing import predict_with_masses, show_prediction, write_predicted
    from rotorrig.app.text import AMPLITUDE_UNITS, read_amplitude_unit

    shown = read_amplitude_unit(units, where="--units") if units else ""
    if out_file.suffix.lower() not in PREDICTED:
        raise DataError(f"{out_file}: has the ending '{out_file.suffix}', want one of {list(PREDICTED)}")
    prediction, masses, measured = predict_with_masses(responses, fit=fit, masses=mass or [])
    write_predicted(out_file, prediction, masses, measured, units=shown)
    if not as_json:
        show_prediction(prediction, masses, shown or AMPLITUDE_UNITS[0])
    words = f"{out_file}: {len(prediction.omega)} vectors"
    tell(words, {"file": str(out_file), "vectors": len(prediction.omega)}, as_json=as_json)
