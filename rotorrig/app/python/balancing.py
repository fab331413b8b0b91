"""Balancing as functions: `balance` and `predict`, and what they return with its tables."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np

from rotorrig.app.commands.balancing import HoleOptions, predict_by_fit, read_task
from rotorrig.app.python.card import Card, Shown, values
from rotorrig.app.python.given import OneResponse, PathLike, Responses, list_responses, read_responses
from rotorrig.app.text import (
    GMM,
    correction_rows,
    grade_sentence,
    highest_rows,
    hole_lines,
    known_sentences,
    mounted_sentence,
)
from rotorrig.balancing import DIRECTIONS, write_balance
from rotorrig.balancing import Balance as Correction
from rotorrig.balancing import Prediction as Predicted
from rotorrig.balancing import balance as compute
from rotorrig.identify import Identification as Fits
from rotorrig.identify import read_identification
from rotorrig.rig import ConfigError
from rotorrig.rig.config import RPM, UM

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Prediction(Shown, Predicted):
    """Vibration predicted with masses on, as `rr.predict` and `balance.prediction` return it."""

    @classmethod
    def of(cls, prediction: Predicted) -> Self:
        """Return the same prediction with these views."""
        return cls(**values(prediction))

    def to_pandas(self) -> "pd.DataFrame":
        """Return a row for each speed, probe and direction; µm 0-peak, less slow roll, and degrees of phase lag."""
        import pandas as pd

        low, high = self.band
        vectors = {"before": self.before, "after": self.after}
        return pd.DataFrame(
            {
                "probe": [self.probes[i] for i in self.probe],
                "speed_rpm": self.omega * RPM,
                "direction": [DIRECTIONS[int(d)] for d in self.direction],
                **{f"{when}_um": np.abs(z) * UM for when, z in vectors.items()},
                **{f"{when}_lag_deg": -np.degrees(np.angle(z)) % 360.0 for when, z in vectors.items()},
                "after_low95_um": low * UM,
                "after_high95_um": high * UM,
            }
        )

    @property
    def _card(self) -> Card:
        lines = [(r.probe, f"{r.before} before, {r.after} after (95 %: {r.band})") for r in highest_rows(self)]
        return Card("Prediction, largest 1X amplitude, µm 0-peak", lines)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Balance(Shown, Correction):
    """Which mass to put where, and what it will do, as `rr.balance` and `rr.read` return it."""

    @classmethod
    def of(cls, balance: Correction) -> Self:
        """Return the same balance with these views."""
        return cls(**values(balance) | {"prediction": Prediction.of(balance.prediction)})

    def to_pandas(self) -> "pd.DataFrame":
        """Return a row for each plane and method, and for the masses to mount.

        g mm, degrees from the mark in the sense of rotation, half the 95 % interval of each.
        """
        import pandas as pd

        rows = [
            (plane, each.by, w, *each.half_widths[i])
            for each in self.corrections
            for i, (plane, w) in enumerate(zip(self.planes, each.W, strict=True))
        ]
        rows += [(p, "to mount", w, np.nan, np.nan) for p, w in zip(self.planes, self.mounted, strict=True)]
        planes, by, masses, amounts, angles = zip(*rows, strict=True)
        return pd.DataFrame(
            {
                "plane": planes,
                "by": by,
                "amount_gmm": np.abs(masses) * GMM,
                "angle_deg": np.degrees(np.angle(masses)) % 360.0,
                "amount_half95_gmm": np.array(amounts) * GMM,
                "angle_half95_deg": np.degrees(angles),
            }
        )

    def save(self, path: str | Path) -> Path:
        """Write a balance.json. Raises DataError if it cannot be written."""
        write_balance(Path(path), self)
        return Path(path)

    @property
    def _card(self) -> Card:
        rows = [(plane, f"{amount} at {angle}, {by}") for plane, by, amount, _, angle, _ in correction_rows(self)]
        told = (*known_sentences(self), *hole_lines(self), mounted_sentence(self), grade_sentence(self))
        return Card("Balance: masses to add, from the mark in the sense of rotation", [*rows, *(("", t) for t in told)])


def balance(
    responses: Responses,
    *,
    identification: PathLike | Fits | None = None,
    after: OneResponse | None = None,
    planes: str | None = None,
    speeds: str | None = None,
    radius: str | None = None,
    holes: int | None = None,
    masses: str | None = None,
    first_hole: str = "0 deg",
    most_holes: int = 2,
    min_max: bool = False,
) -> Balance:
    """Say which mass to put where, as `rotor balance`, by trial masses, by a fit of the responses, or by both.

    `after` is the response of a run with masses on, to hold against the prediction. Texts are as the command takes
    them: `speeds` "1500 rpm, 1800 to 2400 rpm", `radius` "30 mm", `masses` "1 g, 2 g". Raises DataError, ConfigError.
    """
    every = read_responses([*list_responses(responses), *([] if after is None else [after])])
    measured, last = (every, None) if after is None else (every[:-1], every[-1])
    at_hand = HoleOptions(holes=holes, masses=masses, radius=radius, first=first_hole, most=most_holes)
    fit = None if identification is None else _read_fit(identification)
    task = read_task(measured, planes=planes, speeds=speeds, holes=at_hand, min_max=min_max, fitted=fit is not None)
    return Balance.of(compute(measured, task, identification=fit, after=last))


def predict(responses: Responses, *, identification: PathLike | Fits, masses: str | Sequence[str]) -> Prediction:
    """Predict the first response with masses on by a fit of the responses, as `rotor predict`.

    `masses` are texts such as "disk: 24 g mm at 135 deg", from the mark in the sense of rotation. Raises DataError,
    ConfigError.
    """
    named = [masses] if isinstance(masses, str) else list(masses)
    if not named:
        raise ConfigError("masses: none was given, want at least one such as 'disk: 12 g mm at 90 deg'")
    prediction, _ = predict_by_fit(read_responses(responses), _read_fit(identification), named)
    return Prediction.of(prediction)


def _read_fit(identification: PathLike | Fits) -> Fits:
    return read_identification(Path(identification)) if isinstance(identification, (str, Path)) else identification
