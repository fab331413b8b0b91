"""Run docs/tutorial.md for real: `make tutorial`, or `python -m docs.make_tutorial`. About two minutes.

Every `rotor` command of the page runs in an empty folder, in a process of its own, with nothing compiled before, as on
a fresh clone. What it printed goes into the block below it, how long it took into the table at the end. Its pictures
are drawn from the files that the commands wrote.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from docs.browser import screenshot
from docs.origin import origin, save_png
from docs.svg_plot import COLOURS, INK, Figure
from rotorrig.identify import Diagnosis, read_diagnosis
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_response
from rotorrig.rig import RigError
from rotorrig.rig.config import RPM, UM

DOCS = Path(__file__).parent
DOCUMENT = DOCS / "tutorial.md"
COMMAND = "python -m docs.make_tutorial"
QUOTED = re.compile(r"(```sh\n(?P<command>rotor [^\n]*)\n```\n(?:(?!```).)*?```text\n).*?(```)", re.DOTALL)
BEGIN, END = "<!-- times: begin -->\n", "<!-- times: end -->"
COLUMNS = 92  # of the terminal
PAGE = (1100, 1000)  # CSS pixels of a page that are shown


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """A command of the page, what it printed and how long it took."""

    command: str
    printed: str
    seconds: float


def main() -> None:
    """Run the page, fill it in and draw its pictures; a command that fails ends it."""
    text = DOCUMENT.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory(prefix="rotor-tutorial-") as name:
        folder = Path(name)
        shutil.copytree(DOCS / "tutorial", folder / "docs" / "tutorial")
        try:
            every = [run(found["command"], folder) for found in QUOTED.finditer(text)]
            DOCUMENT.write_text(filled(text, every), encoding="utf-8")
            draw(folder)
        except RigError as error:
            sys.exit(f"error: {error}")


def run(command: str, folder: Path) -> Done:
    """Run a `rotor` command in a folder. Raises RigError if it fails."""
    words = shlex.split(command)
    cache = {"NUMBA_CACHE_DIR": str(folder / "compiled"), "COLUMNS": str(COLUMNS)}
    program = Path(sys.executable).with_name(words[0])
    began = time.perf_counter()
    done = subprocess.run(
        [str(program), *words[1:]], cwd=folder, env=os.environ | cache, capture_output=True, text=True
    )
    seconds = time.perf_counter() - began
    if done.returncode:
        raise RigError(f"{command}: ended with status {done.returncode}: {done.stderr.strip()}")
    print(f"{seconds:6.1f} s  {command}")
    return Done(command=command, printed=_tidy(done.stdout), seconds=seconds)


def filled(text: str, every: list[Done]) -> str:
    """Return the page with what the commands printed and how long they took."""
    left = iter(every)
    text = QUOTED.sub(lambda found: found[1] + next(left).printed + found[3], text)
    before, _, rest = text.partition(BEGIN)
    table = ["| command | s |", "|---|---:|"]
    table += [f"| `{_brief(done.command)}` | {done.seconds:.0f} |" for done in every]
    table.append(f"| together | {sum(done.seconds for done in every):.0f} |")
    return before + BEGIN + "\n".join(table) + "\n" + END + rest.partition(END)[2]


def draw(folder: Path) -> None:
    """Draw what the extended model leaves, the head of the report and the balance sheet. Raises RigError."""
    response, found = read_response(folder / "response.mcap"), read_diagnosis(folder / "diagnosis.json")
    said = origin(COMMAND, response.rig.hash)
    gain(response, found).save(DOCS / "img" / "tutorial-gain.svg", origin=said)
    for page, picture in (("report.html", "tutorial-report.png"), ("balance.html", "tutorial-balance.png")):
        save_png(screenshot(folder / page, PAGE), DOCS / "img" / picture, origin=said)


def gain(response: OrderTrackedResponse, found: Diagnosis) -> Figure:
    """Draw 1X of the first probe in the run-up, above; below what either model leaves of it."""
    if found.extended_residual is None:
        raise RigError("the diagnosis of the tutorial named no cause, want one to draw what it explains")
    first = next(i for i, run in enumerate(response.runs) if run.direction > 0)
    rows = np.flatnonzero((response.run == first) & response.usable[:, 0])
    rpm, z = response.omega[rows] * RPM, response.order(1.0)[rows, 0]
    at = response.orders.index(1.0)
    left = [residual[rows, 0, at] for residual in (found.residual, found.extended_residual)]
    figure = Figure(width=720, height=540)
    ends = (float(rpm.min()), float(rpm.max()))
    above = figure.panel((70, 30, 620, 240), x=ends, y=(0, 1.15 * UM * np.abs(z).max()), ylabel="1X at 1x [um 0-peak]")
    above.points(np.column_stack([rpm, UM * np.abs(z)]), colour=INK)
    for part, colour in zip(left, COLOURS[1::-1], strict=False):
        above.line(rpm, UM * np.abs(z - part), colour=colour)
    below = figure.panel(
        (70, 300, 620, 190), x=ends, y=(0.01, 1000), xlabel="speed [rpm]", ylabel="|measured - model| [um]", log=True
    )
    for part, colour in zip(left, COLOURS[1::-1], strict=False):
        below.line(rpm, UM * np.maximum(np.abs(part), 1e-8), colour=colour)
    base, extended = COLOURS[1], COLOURS[0]
    cause = "; ".join(effect.label for effect in found.causes if effect.chosen)
    figure.key(90, 52, [(INK, "measured, run-up"), (base, "model of the config"), (extended, f"with {cause}")])
    return figure


def _brief(command: str) -> str:
    """Return a command without its files."""
    program, verb, *rest = shlex.split(command)
    return " ".join([program, verb, *(word for word in rest if word.startswith("-"))])


def _tidy(printed: str) -> str:
    """Return what was printed without blanks at the ends of its lines."""
    return "\n".join(line.rstrip() for line in printed.strip().splitlines()) + "\n"


if __name__ == "__main__":
    main()
