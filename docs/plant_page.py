"""The table of docs/plant.md: what each fault of the simulated rig is made of, beside the effect of that name."""

import json

from docs.make_plant_differences import FIGURES
from docs.plant_mechanisms import MECHANISMS

BEGIN, END = "<!-- table of faults: written by `make docs` -->", "<!-- end of the table -->"


def shown(text: str) -> str:
    """Return the text of plant.md with the table between its marks made anew."""
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}\n\n{table()}\n\n{END}{rest.split(END)[1]}"


def table() -> str:
    """Return the table in Markdown, one row a fault."""
    figures: dict[str, float] = json.loads(FIGURES.read_text(encoding="utf-8"))
    head = ["| fault | in the simulated rig | source | the effect | apart |", "|---|---|---|---|---|"]
    rows = [
        f"| {name} | {m.plant} | {m.source} | {m.effect or 'none: an outsider'} | {_apart(figures.get(name))} |"
        for name, m in MECHANISMS.items()
    ]
    return "\n".join([*head, *rows])


def _apart(figure: float | None) -> str:
    """Return a share as a percentage.

    >>> _apart(0.0123), _apart(None)
    ('1.2 %', '-')
    """
    return "-" if figure is None else f"{100 * figure:.1f} %"
