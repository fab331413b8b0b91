"""Critical speeds of a fitted model, as fit.json and diagnosis.json both have them: SI, amplitudes 0-peak."""

from collections.abc import Iterable
from typing import Any

from rotorrig.identify.identification import ModelResonance
from rotorrig.identify.result_files.plain_json import fields_of, number
from rotorrig.processing import Resonance, Uncertain

_FIGURES = ("omega", "amplitude", "lower", "upper", "amplification", "damping")


def resonances_out(resonances: Iterable[ModelResonance]) -> list[dict[str, Any]]:
    """Return a table for each; null for a half-power speed that is not within the run, and what follows from it."""
    return [
        fields_of(each, "response run probe") | {name: _figure_out(getattr(each.resonance, name)) for name in _FIGURES}
        for each in resonances
    ]


def resonances_in(tables: Iterable[dict[str, Any]]) -> tuple[ModelResonance, ...]:
    """Return the resonances in a file."""
    return tuple(
        ModelResonance(
            response=int(table["response"]),
            run=table["run"],
            probe=table["probe"],
            resonance=Resonance(**{name: _figure(table[name]) for name in _FIGURES}),
        )
        for table in tables
    )


def _figure_out(figure: Uncertain | None) -> dict[str, Any] | None:
    return None if figure is None else fields_of(figure, "value sigma")


def _figure(table: dict[str, Any] | None) -> Any:
    return None if table is None else Uncertain(value=float(table["value"]), sigma=number(table["sigma"]))
