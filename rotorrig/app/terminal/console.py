"""Consoles for results and errors; progress bars, silent when piped."""

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import timedelta
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
)
from rich.segment import Segment
from rich.text import Text


class PlainConsole(Console):
    """Console that shows text and obeys none: no markup, no emoji codes, no control characters in what it is given."""

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, markup=False, emoji=False)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Yield the segments of a renderable; what a terminal would obey in their text is left out."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else Segment(_show(segment.text), segment.style)


def _show(text: str) -> str:
    """Return text as a terminal shows it; names and messages come from files and devices."""
    return text if text.isprintable() else "".join(c for c in text if c.isprintable() or c in "\n\t")


out = PlainConsole()
err = PlainConsole(stderr=True)


def tell(words: str, facts: Mapping[str, Any], *, as_json: bool) -> None:
    """Print the result of a verb: `words` for a person or, `as_json`, the `facts` as one JSON object on one line."""
    if as_json:
        print(json.dumps(_plain(facts)))
    else:
        out.print(words, highlight=False, markup=False, soft_wrap=True)


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """Show progress bars on standard error while the block runs; nothing if that is not a terminal.

    A task's field `unit` is the unit its rate is shown in, `scale` the number of these per unit of its total.
    """
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=24),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        _TimeLeft(),
        _Rate(),
        TextColumn("{task.fields[note]}", markup=False),
    )
    with Progress(*columns, console=err, disable=not err.is_terminal) as bars:
        yield bars


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show elapsed time of a job of unknown length; nothing when piped."""
    with progress_bars() as bars:
        bars.add_task(what, total=None, note="")
        yield


class _TimeLeft(ProgressColumn):
    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        left = task.time_remaining
        if task.finished or task.total is None or left is None:
            return Text("")
        return Text(f"{timedelta(seconds=math.ceil(left))} left", style="progress.remaining")


class _Rate(ProgressColumn):
    max_refresh = 0.5

    def render(self, task: Task) -> Text:
        speed, unit = task.finished_speed or task.speed, task.fields.get("unit")
        if not speed or not unit:
            return Text("")
        return Text(f"{speed * task.fields.get('scale', 1.0):.3g} {unit}", style="progress.data.speed")


def _plain(value: object) -> object:
    """Return a value as JSON can hold it; NaN and infinity become null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, str) or value is None:
        return value
    if isinstance(value, Sequence):
        return [_plain(inner) for inner in value]
    return value if not isinstance(value, float) or math.isfinite(value) else None
