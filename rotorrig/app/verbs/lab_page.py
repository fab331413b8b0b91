"""Verb `rotor lab page`: the catalogue of a lab as pages for a browser."""

from pathlib import Path
from typing import Annotated

import typer

from rotorrig.app.terminal import err, progress_bars, tell
from rotorrig.app.verbs.arguments import AsJson, Units

SHOWN_FAULTS = 3  # sentences on responses that could not be read


def page(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="the folder that `rotor lab run` searched", show_default=False)
    ],
    out_folder: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="the folder to write the pages into", show_default="FOLDER/lab/page"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="write into a folder that has other files, too")] = False,
    units: Units = None,
    as_json: AsJson = False,
) -> None:
    """Write a lab's catalogue as pages: a table of all runs, trends, Bode plots of several runs in one.

    They open in a browser from the disk; pages of earlier are replaced.
    """
    from rotorrig.app.lab.page import write_lab_page
    from rotorrig.app.text import read_amplitude_unit

    shown = read_amplitude_unit(units, where="--units") if units else ""
    with progress_bars() as bars:
        task = bars.add_task("curves", total=1.0, note="")
        written = write_lab_page(
            folder,
            out_folder or folder / "lab" / "page",
            force=force,
            units=shown,
            progress=lambda done: bars.update(task, completed=done),
        )
    runs = f"{written.runs} run{'s' if written.runs != 1 else ''}"
    words = f"{written.index}: {runs}, {written.curves} with Bode plots; open in any browser"
    facts = {"file": str(written.index), "runs": written.runs, "bode_plots": written.curves, "unread": written.unread}
    tell(words, facts, as_json=as_json)
    for sentence in [] if as_json else written.unread[:SHOWN_FAULTS]:
        err.print(f"no Bode plot: {sentence}", highlight=False, markup=False, soft_wrap=True)
    if not as_json and len(written.unread) > SHOWN_FAULTS:
        err.print(f"no Bode plot of {len(written.unread) - SHOWN_FAULTS} more", highlight=False, markup=False)
