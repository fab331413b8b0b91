"""HTML elements of the page: sections, tables, plots, collapsible details. All text is escaped here."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go

from rotorrig.app.text import AMPLITUDE_UNITS

AMPLITUDE = AMPLITUDE_UNITS[0]  # what says so is told in the unit the reader chooses: units.js
STACKED = 4  # columns: a table of as many is wider than a telephone


@dataclass(frozen=True, slots=True)
class Section:
    """A section of the page, linked from its contents."""

    name: str  # anchor
    heading: str
    html: str


def section(name: str, heading: str, *parts: str) -> Section:
    """Return a section with its heading; empty parts are left out."""
    inside = "\n".join(part for part in parts if part)
    head = f'<h2 id="h-{name}">{escape(heading)}</h2>'
    return Section(name, heading, f'<section id="{name}" aria-labelledby="h-{name}">{head}\n{inside}</section>')


def paragraph(*sentences: str, kind: str = "") -> str:
    """Return sentences as a paragraph of a class of report.css; nothing if all are empty."""
    words = " ".join(sentence for sentence in sentences if sentence)
    return f"<p{f' class={kind}' if kind else ''}>{escape(words)}</p>" if words else ""


def items(words: Iterable[str]) -> str:
    """Return a list with an item per text; nothing if there is none."""
    inside = "".join(f"<li>{escape(word)}</li>" for word in words)
    return f"<ul>{inside}</ul>" if inside else ""


def details(summary: str, *parts: str, on_paper: bool = True) -> str:
    """Return collapsible parts; in print they are expanded, or left out unless the reader expanded them."""
    kind = "" if on_paper else ' class="screen"'
    return f"<details{kind}><summary>{escape(summary)}</summary>{''.join(parts)}</details>"


def table(
    caption: str,
    header: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    marked: Iterable[int] = (),
    mark: str = "marked",
    amplitudes: Iterable[int] = (),
) -> str:
    """Return a table; the first cell of a row heads it. On a narrow screen, rows of many cells are stacked.

    Rows whose index is in `marked` stand out in the way of the class `mark` of report.css. A column whose heading has
    the unit of amplitudes holds nothing but them and cells with a unit of their own, and so do those numbered in
    `amplitudes`.
    """
    marks, told = set(marked), {i for i, name in enumerate(header) if AMPLITUDE in name}.union(amplitudes)
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in header)
    stacked = len(header) >= STACKED
    body = ""
    for i, (first, *rest) in enumerate(rows):
        cells = ""
        for column, (name, cell) in enumerate(zip(header[1:], rest, strict=True), start=1):
            named = f' data-name="{escape(name)}"' if stacked else ""
            kind = " class=amplitude" if column in told and "µm" not in cell else ""
            cells += f"<td{named}{kind}>{escape(cell)}</td>"
        body += f'<tr{f" class={mark}" if i in marks else ""}><th scope="row">{escape(first)}</th>{cells}</tr>'
    inside = f"{_caption(caption)}<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return scrolling(caption, f"<table{' class=stacked' if stacked else ''}>{inside}</table>")


def pairs(caption: str, values: Mapping[str, Any]) -> str:
    """Return a table of names and values."""
    rows = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(str(value))}</td></tr>' for name, value in values.items()
    )
    inside = f"{_caption(caption)}<tbody>{rows}</tbody>"
    return scrolling(caption, f'<table class="pairs">{inside}</table>')


def plot(name: str, figure: go.Figure, *, caption: str, label: str, share: float = 1.0) -> str:
    """Return a plot's place on the page and its data; report.js draws it.

    `label` is for screen readers and for pages without JavaScript. `share` is its share of the paper width in print.
    """
    data = _lighten(figure).to_json().replace("<", "\\u003c")  # so that no text in the data can end the script element
    switched = " data-amplitude" if figure.layout.meta else ""
    return (
        f'<figure class="plot"{switched} aria-labelledby="{name}-caption">'
        f'<figcaption id="{name}-caption">{escape(caption)}</figcaption><p class="heard">{escape(label)}</p>'
        f'<div id="{name}" class="canvas" data-share="{share:g}" style="min-height:{figure.layout.height}px"></div>'
        f'<script type="application/json" data-figure="{name}">{data}</script></figure>'
    )


def _lighten(figure: go.Figure) -> go.Figure:
    """Halve the size of a figure's numbers: seven digits are more than a plot shows."""
    for trace in figure.data:
        for name, values in trace.to_plotly_json().items():
            if isinstance(values, np.ndarray) and values.dtype == np.float64:
                trace[name] = values.astype(np.float32)
    return figure


def _caption(words: str) -> str:
    return f"<caption><span>{escape(words)}</span></caption>"  # the span keeps it in view where the table scrolls


def scrolling(name: str, inside: str) -> str:
    """Return a table or drawing in a box that scrolls sideways where the page is narrow, with the arrow keys too."""
    return f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(name)}">{inside}</div>'


def name_of_order(order: float) -> str:
    """Return an order as part of an element's name.

    >>> name_of_order(0.5), name_of_order(-1.0)
    ('0_5', 'm1')
    """
    return f"{order:g}".replace(".", "_").replace("-", "m")
