"""A `MissingForce` in diagnosis.json, and back."""

from typing import Any

from rotorrig.identify.discovery import ForceOverSpeed, MissingForce, Rival
from rotorrig.identify.result_files.plain_json import (
    complex_in,
    complex_out,
    fields_of,
    number,
    numbers_in,
    numbers_out,
)


def missing_out(missing: MissingForce) -> dict[str, Any]:
    """Return it as a table of plain values."""
    over = missing.over_speed
    return {
        **fields_of(missing, "kind words laws like place place_sigma shortfall"),
        "places": numbers_out(missing.places),
        "probability": numbers_out(missing.probability),
        "rivals": [fields_of(rival, "words evidence") for rival in missing.rivals],
        "over_speed": {}
        if over is None
        else {
            "recording": over.recording,
            **{name: numbers_out(getattr(over, name)) for name in ("omega", "sigma")},
            **{name: complex_out(getattr(over, name)) for name in ("force", "law", "motion")},
        },
    }


def missing_in(table: dict[str, Any]) -> MissingForce:
    """Return what such a table holds. Raises KeyError, TypeError or ValueError where it is another."""
    over = table["over_speed"]
    return MissingForce(
        kind=table["kind"],
        words=table["words"],
        laws=tuple(table["laws"]),
        like=tuple(table["like"]),
        place=number(table["place"]),
        place_sigma=number(table["place_sigma"]),
        shortfall=table["shortfall"],
        places=numbers_in(table["places"]),
        probability=numbers_in(table["probability"]),
        rivals=tuple(Rival(words=each["words"], evidence=number(each["evidence"])) for each in table["rivals"]),
        over_speed=ForceOverSpeed(
            recording=int(over["recording"]),
            omega=numbers_in(over["omega"]),
            sigma=numbers_in(over["sigma"]),
            force=complex_in(over["force"]),
            law=complex_in(over["law"]),
            motion=complex_in(over["motion"]),
        )
        if over
        else None,
    )
