"""Verbs of a lab: run, query, page. Each is a command below `rotor lab`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from rotorrig.app.terminal import err, out, tell, working
from rotorrig.app.verbs.arguments import AsJson, Force, load_config
from rotorrig.app.verbs.lab_page import page
from rotorrig.app.verbs.output_guard import Output, guard
from rotorrig.rig import ConfigError

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Work through all recordings of a folder, and see what came of them.",
    context_settings={"help_option_names": ["-h", "--help"]},
)
Folder = Annotated[
    Path, typer.Argument(metavar="FOLDER", help="the folder that the recordings are in", show_default=False)
]


def run(
    folder: Folder,
    steps: Annotated[str, typer.Option(help="of track, identify, diagnose, report; track is always one")] = (
        "track,identify"
    ),
    workers: Annotated[
        int | None, typer.Option(min=1, help="processes on this machine", show_default="one a processor")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="address of a Dask scheduler to work on instead, such as tcp://10.0.0.5:8786"),
    ] = None,
    config: Annotated[
        Path | None, typer.Option(help="the rig's TOML file, instead of the ones in the recordings")
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="try those again that failed")] = False,
    as_json: AsJson = False,
) -> None:
    """Track, identify, diagnose and report every recording of a folder, on many processes, each once.

    Results are kept in FOLDER/lab by the hash of the recording, the config and the version of the program: the same
    command does what is not done yet. Status 0: all done; 1: some failed; 130: interrupted.
    """
    from rotorrig.app.lab import LabSettings, run_lab

    if scheduler and workers:
        raise ConfigError("--scheduler: has workers of its own, want no --workers")
    settings = LabSettings.read(steps, config=load_config(config) if config else None)
    summary = run_lab(folder, settings, workers=workers, scheduler=scheduler, retry=retry)
    tell("\n".join(summary.lines()), summary.facts(), as_json=as_json)
    if summary.interrupted:
        raise typer.Exit(130)
    if summary.failed:
        raise typer.Exit(1)


def query(
    folder: Folder,
    sql: Annotated[str, typer.Argument(metavar="SQL", help="one SELECT, on the tables of docs/lab.md")],
    csv: Annotated[Path | None, typer.Option(help="write a CSV file"), Output(kind="csv")] = None,
    parquet: Annotated[Path | None, typer.Option(help="write a Parquet file"), Output(kind="parquet")] = None,
    force: Force = False,
    as_json: Annotated[bool, typer.Option("--json", help="print the rows as JSON, one object a line")] = False,
) -> None:
    """Ask the catalogue of a lab in SQL: the tables runs, estimates, causes, peaks, events.

    They hold the newest computation of every recording; runs_all and so on hold all. SQL reads the catalogue and no
    other file, and writes none.
    """
    from rotorrig.app.lab import json_rows, query_table, write_csv, write_parquet
    from rotorrig.app.terminal import rows_table

    with working("reading the catalogue"):
        table = query_table(folder, sql)
    for path, write in ((csv, write_csv), (parquet, write_parquet)):
        if path:
            write(path, table, sql=sql)
            (err if as_json else out).print(f"{path}: {table.num_rows} rows", highlight=False)
    if as_json:
        for row in json_rows(table):
            print(json.dumps(row, ensure_ascii=False))
    elif not (csv or parquet):
        out.print(rows_table(table.column_names, table.to_pylist(), width=out.width), highlight=False)


app.command("run", short_help="Work through the recordings of a folder.")(guard(run))
app.command("query", short_help="Ask the catalogue in SQL.")(guard(query))
app.command("page", short_help="Write the catalogue as pages for a browser.")(guard(page))
