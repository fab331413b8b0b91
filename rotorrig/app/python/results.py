"""`Identification` and `Diagnosis` with their tables, their reprs and their files."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self

from rotorrig.app.python.card import Card, Shown, values
from rotorrig.app.text import causes_to_list, estimate_text, misfit_sentence
from rotorrig.identify import Diagnosis as Judgement
from rotorrig.identify import Identification as Fits
from rotorrig.identify import write_diagnosis, write_identification
from rotorrig.rig.config import UM

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Identification(Shown, Fits):
    """What a fit found, as `rr.identify` and `rr.read` return it."""

    @classmethod
    def of(cls, identification: Fits) -> Self:
        """Return the same identification with these views."""
        return cls(**values(identification))

    def to_pandas(self) -> "pd.DataFrame":
        """Return a row for each fit and estimate, nuisances behind the others; SI, `unit` beside the value."""
        import pandas as pd

        return pd.DataFrame(
            [
                {
                    "fit": fit.name,
                    "name": estimate.name,
                    "value": estimate.value,
                    "sigma": estimate.sigma,
                    "low95": (estimate.interval or (math.nan, math.nan))[0],
                    "high95": (estimate.interval or (math.nan, math.nan))[1],
                    "unit": estimate.unit,
                    "nameplate": estimate.nameplate,
                    "determined": estimate.determined,
                    "nuisance": estimate in fit.nuisances,
                }
                for fit in self.fits
                for estimate in (*fit.estimates, *fit.nuisances)
            ]
        )

    def save(self, path: str | Path) -> Path:
        """Write a fit.json. Raises DataError if it cannot be written."""
        write_identification(Path(path), self)
        return Path(path)

    @property
    def _card(self) -> Card:
        fit = self.fits[0]
        lines = [(estimate.name, estimate_text(estimate)) for estimate in fit.estimates]
        return Card(f"Identification, {fit.name}", [*lines, ("", misfit_sentence(fit))])


@dataclass(frozen=True, slots=True, kw_only=True, repr=False, eq=False)
class Diagnosis(Shown, Judgement):
    """The verdict on a model with its evidence, as `rr.diagnose` and `rr.read` return it."""

    @classmethod
    def of(cls, diagnosis: Judgement) -> Self:
        """Return the same diagnosis with these views."""
        return cls(**values(diagnosis))

    def to_pandas(self) -> "pd.DataFrame":
        """Return a row for each cause tried, best first; errors on unseen data in µm 0-peak."""
        import pandas as pd

        return pd.DataFrame(
            [
                {
                    "cause": cause.label,
                    "effect": cause.effect,
                    "place": cause.where,
                    "chosen": cause.chosen,
                    "plausible": cause.plausible,
                    "evidence_bic": cause.evidence,
                    "chi2_gain": cause.lam,
                    "unseen_error_before_um": cause.heldout_before * UM,
                    "unseen_error_after_um": cause.heldout_after * UM,
                    "words": cause.words,
                }
                for cause in self.causes
            ]
        )

    def save(self, path: str | Path) -> Path:
        """Write a diagnosis.json. Raises DataError if it cannot be written."""
        write_diagnosis(Path(path), self)
        return Path(path)

    @property
    def _card(self) -> Card:
        causes = [(f"{i + 1}.", cause.words) for i, cause in enumerate(causes_to_list(self))]
        return Card(f"Diagnosis: {self.verdict}", [("", self.sentence), *causes])
