"""A thing in a few lines: as text for `repr`, as an HTML table for notebooks."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from html import escape
from typing import Any


@dataclass(frozen=True, slots=True)
class Card:
    """Title and lines of (what, value)."""

    title: str
    lines: Sequence[tuple[str, str]]

    @property
    def text(self) -> str:
        """The card as plain text.

        >>> print(Card("Rotor: RK4", [("disks", "1"), ("probes", "1x, 1y")]).text)
        Rotor: RK4
          disks   1
          probes  1x, 1y
        """
        width = max((len(what) for what, _ in self.lines), default=0)
        return "\n".join([self.title, *(f"  {what:<{width}}  {value}" for what, value in self.lines)])

    @property
    def html(self) -> str:
        """The card as an HTML table, in the colours of the notebook."""
        rows = "".join(
            f'<tr><th style="text-align:left">{escape(what)}</th><td style="text-align:left">{escape(value)}</td></tr>'
            for what, value in self.lines
        )
        title = f'<caption style="text-align:left"><b>{escape(self.title)}</b></caption>'
        return f"<table>{title}<tbody>{rows}</tbody></table>"


class Shown:
    """What shows itself by its card, in a terminal and in a notebook."""

    __slots__ = ()

    @property
    def _card(self) -> Card:
        raise NotImplementedError

    def __repr__(self) -> str:
        return self._card.text

    def _repr_html_(self) -> str:
        return self._card.html


def values(result: Any) -> dict[str, Any]:
    """Return the fields of a result, a dataclass, as they are: those of the same result with views of this face."""
    return {field.name: getattr(result, field.name) for field in fields(result)}
