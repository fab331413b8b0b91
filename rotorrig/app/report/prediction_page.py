"""The picture of a prediction: amplitude over speed and polar plot at every probe, before and with masses on."""

from collections.abc import Mapping
from pathlib import Path

from rotorrig.app.report.frame import write_page
from rotorrig.app.report.html import paragraph
from rotorrig.app.report.sections import vibration
from rotorrig.app.text import mass_text
from rotorrig.balancing import Prediction
from rotorrig.rig import Provenance
from rotorrig.rig.config import RigConfig


def write_prediction_page(
    path: Path,
    prediction: Prediction,
    masses: Mapping[str, complex],
    *,
    rig: RigConfig,
    source: Provenance,
    units: str = "",
) -> None:
    """Write what `masses` [kg m] on the planes are predicted to do, amplitudes in `units` as `write_report`.

    Raises DataError if it cannot be written.
    """
    added = "; ".join(mass_text(plane, u) for plane, u in masses.items())
    write_page(
        path,
        kind="Predicted vibration",
        heading=rig.name,
        source=source.source,
        units=units,
        body=paragraph(f"With {added} from the keyphasor mark in the sense of rotation.") + vibration(prediction, rig),
        conventions="Amplitudes are 0-peak, phases lag; angles are counted from the keyphasor mark.",
    )
