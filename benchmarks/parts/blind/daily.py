"""The case of the day: a fault on a rig that nobody has seen, drawn from the date, large enough to be named.

Large enough is lam >= 100 to the base model and to the nearest rival, four times and six times what detecting and
naming ask for: a diagnosis that misses it is wrong, not unlucky. A fault that is smaller on its rig, or trips the
sweep, is drawn again, all of it, rig and kind too.

A test that hides one has to print `Hidden.case`: its design, fault and seed are all that makes it again.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np

from benchmarks.parts.blind.cases import Case, modelled
from benchmarks.parts.blind.lam import Lam, lam_of
from benchmarks.parts.blind.measured import measure
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import LimitExceeded
from rotorrig.sims.plant import Truth, unseal

LARGE = 100.0  # lam, to the base and to the nearest rival
MOST_DRAWS = 30  # of one case: more are a fault of the drawing


@dataclass(frozen=True, slots=True, kw_only=True)
class Hidden:
    """A case as it was measured, its truth, and how well it can be seen."""

    case: Case
    responses: list[OrderTrackedResponse]
    truth: Truth
    lam: Lam


def draw_day(day: date, *, number: int = 0, hide: Callable[[Case], Hidden | None]) -> Hidden:
    """Return the case of a day, the first one or another `number`, hidden by `hide` (hide_fault), None: too small."""
    rng = np.random.default_rng([day.toordinal(), number])
    for i in range(MOST_DRAWS):
        seed = (int(f"{day:%Y%m%d}") * 100 + number) * MOST_DRAWS + i
        hidden = hide(Case(design="day", faults=(str(rng.choice(modelled())),), seed=seed))
        if hidden is not None and min(hidden.lam["lam"], hidden.lam["rival_lam"]) >= LARGE:
            return hidden
    raise AssertionError(f"{day}, case {number}: none of {MOST_DRAWS} is large enough")


def healthy_of_day(day: date) -> Case:
    """Return a healthy rig of a day, which must not be named."""
    return Case(design="day", seed=int(f"{day:%Y%m%d}"))


def hide_fault(case: Case, folder: Path) -> Hidden | None:
    """Sweep a case and compute its lam; None if the sweep trips. Sealed truth and recordings go into `folder`."""
    place = folder / case.name
    place.mkdir()
    try:
        responses = measure(case, sealed=place / "sealed.json", folder=place)
    except LimitExceeded:
        return None
    truth = unseal(place / "sealed.json")
    return Hidden(case=case, responses=responses, truth=truth, lam=lam_of(case, truth, folder, enough=LARGE))
