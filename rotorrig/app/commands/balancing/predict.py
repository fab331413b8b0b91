"""`rotor predict`: vectors with masses added, by the fitted model, as table, CSV, JSON or picture."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rotorrig.app.commands.diagnose import read_responses
from rotorrig.app.terminal import out, prediction_table, working
from rotorrig.app.text import AMPLITUDE_UNITS, mass_text
from rotorrig.balancing import DIRECTIONS, Prediction, influence_of_fit, predict_vibration, write_prediction
from rotorrig.identify import Identification, read_identification
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import ConfigError, write_whole_text
from rotorrig.rig.config import RPM, UM, read_trial_mass, trial_unbalance

HEAD = (
    "# predicted vectors; µm 0-peak, less the slow-roll vector if there is one; phase lag = -arg z in degrees, "
    "theta = 0 at the keyphasor edge; bands 95 %"
)
COLUMNS = (
    "probe,speed [rpm],direction,before [um],before lag [deg],after [um],after lag [deg],after low [um],after high [um]"
)


def predict_with_masses(
    paths: Sequence[Path], *, fit: Path, masses: Sequence[str]
) -> tuple[Prediction, dict[str, complex], OrderTrackedResponse]:
    """Predict the first response with masses on; return the masses [kg m] and that response, too.

    Raises DataError, ConfigError.
    """
    if not masses:
        raise ConfigError("--mass: missing, want at least one such as 'disk: 12 g mm at 90 deg'")
    responses = read_responses(paths)
    with working("predicting"):
        prediction, added = predict_by_fit(responses, read_identification(fit), masses)
    return prediction, added, responses[0]


def predict_by_fit(
    responses: Sequence[OrderTrackedResponse], identification: Identification, masses: Sequence[str]
) -> tuple[Prediction, dict[str, complex]]:
    """Predict the first response with masses on, and return these [kg m]. Raises DataError, ConfigError."""
    planes = responses[0].rig.unbalance_planes
    added = trial_unbalance([read_trial_mass(text, planes=planes) for text in masses])
    influence = influence_of_fit(identification, responses, planes=tuple(added))
    return predict_vibration(influence, np.array(list(added.values()))), added


def write_predicted(
    path: Path,
    prediction: Prediction,
    masses: dict[str, complex],
    measured: OrderTrackedResponse,
    *,
    units: str = "",
) -> None:
    """Write a prediction for a response as CSV, JSON or picture by its path's ending. Raises DataError.

    The picture has its amplitudes in `units` as `write_report`; the files are µm 0-peak and SI.
    """
    ending = path.suffix.lower()
    if ending == ".csv":
        write_whole_text(path, _table(prediction, masses))
    elif ending == ".json":
        write_prediction(path, prediction, masses, measured.source)
    else:
        from rotorrig.app.report import write_prediction_page

        write_prediction_page(path, prediction, masses, rig=measured.rig, source=measured.source, units=units)


def show_prediction(prediction: Prediction, masses: dict[str, complex], unit: str = AMPLITUDE_UNITS[0]) -> None:
    """Print the largest amplitudes before and after, in `unit`."""
    words = "; ".join(mass_text(plane, u) for plane, u in masses.items())
    out.print(f"Vibration as measured, and what the fitted model says these change: {words}.", highlight=False)
    out.print(prediction_table(prediction, unit))


def _table(prediction: Prediction, masses: dict[str, complex]) -> str:
    text = io.StringIO()
    print(HEAD, file=text)
    for plane, u in masses.items():
        print(f"# {mass_text(plane, u)} from the keyphasor mark in the sense of rotation", file=text)
    print(COLUMNS, file=text)
    writer = csv.writer(text, lineterminator="\n")
    low, high = prediction.band
    for m in range(len(prediction.omega)):
        vectors = []
        for z in (prediction.before[m], prediction.after[m]):
            vectors += [f"{abs(z) * UM:.4f}", f"{-np.degrees(np.angle(z)) % 360:.2f}"]
        writer.writerow(
            [
                prediction.probes[prediction.probe[m]],
                f"{prediction.omega[m] * RPM:.2f}",
                DIRECTIONS[int(prediction.direction[m])],
                *vectors,
                f"{low[m] * UM:.4f}",
                f"{high[m] * UM:.4f}",
            ]
        )
    return text.getvalue()
