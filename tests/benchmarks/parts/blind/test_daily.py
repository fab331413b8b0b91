"""The case of the day is drawn from the date alone, and large enough that missing it is no bad luck."""

from collections import Counter
from datetime import UTC, date, datetime, timedelta
from pathlib import Path

import pytest

from benchmarks.parts.blind.cases import Case, modelled
from benchmarks.parts.blind.daily import LARGE, Hidden, draw_day, healthy_of_day, hide_fault
from benchmarks.parts.blind.lam import Lam, lam_of
from benchmarks.parts.blind.measured import measure
from rotorrig.identify import diagnose
from rotorrig.identify.verdict import Verdict
from rotorrig.sims.plant.draw import draw

DAY = date(2026, 11, 23)


def as_large_as_its_seed(case: Case) -> Hidden | None:
    """Stand in for a sweep and lam: of ten cases three can be seen, one of which its rival cannot be told from."""
    lam, rival = {0: (900.0, 400.0), 1: (100.0, 100.0), 2: (900.0, 99.9)}.get(case.plant_seed % 10, (99.9, 99.9))
    truth = draw(case.rig, seed=case.plant_seed)
    return Hidden(case=case, responses=[], truth=truth, lam=Lam(lam=lam, rival_lam=rival, rival=""))


def seeded(case: Case) -> Hidden | None:
    """Stand in for a sweep of which every second trips, without a rig."""
    lam = Lam(lam=LARGE, rival_lam=LARGE, rival="")
    return None if case.plant_seed % 2 else Hidden(case=case, responses=[], truth=None, lam=lam)  # type: ignore[arg-type]


def test_the_case_is_that_of_the_day_and_the_first_that_is_large_enough() -> None:
    found = draw_day(DAY, hide=as_large_as_its_seed)
    again = draw_day(DAY, hide=as_large_as_its_seed)
    assert (found.case, found.truth) == (again.case, again.truth)
    assert found.case.plant_seed % 10 in (0, 1)
    assert found.case.is_drawn
    assert len(found.case.rig.probes) == 4


def test_days_and_cases_of_a_day_differ_and_every_fault_has_its_turn() -> None:
    drawn = [draw_day(DAY + timedelta(days=i), number=n, hide=seeded).case for i in range(100) for n in range(3)]
    assert len({case.plant_seed for case in drawn}) == 300
    assert set(Counter(case.faults[0] for case in drawn)) == set(modelled())
    assert len({healthy_of_day(DAY + timedelta(days=i)).plant_seed for i in range(100)}) == 100


def test_a_day_on_which_nothing_can_be_seen_is_said() -> None:
    with pytest.raises(AssertionError, match="none of 30 is large enough"):
        draw_day(DAY, hide=lambda case: None)


@pytest.mark.campaign
@pytest.mark.parametrize(
    ("fault", "seed", "label"),
    [("rub", 60783084004, "rub, at mid-span"), ("rub", 7, "rub, at disk"), ("cubic_spring", 7, "cubic_spring")],
)
def test_a_force_law_on_a_rig_of_another_scale_is_named(fault: str, seed: int, label: str, tmp_path: Path) -> None:
    """Cases of development: a gap of 13 um where the RK4 has 200, a soft ring, a base that ends in a poor minimum."""
    case = Case(design="day", faults=(fault,), seed=seed)
    found = diagnose(measure(case, sealed=tmp_path / "sealed.json", folder=tmp_path))
    assert label in [cause.label for cause in found.causes if cause.chosen]
    assert found.verdict in (Verdict.NAMED, Verdict.TIED)


def test_todays_case_can_be_seen_and_told_from_its_nearest_rival(tmp_path: Path) -> None:
    """Drawn twice, once with a sweep each: lam is computed anew."""
    today = datetime.now(UTC).date()
    found = draw_day(today, hide=lambda case: hide_fault(case, tmp_path))
    lam = lam_of(found.case, found.truth, tmp_path, enough=LARGE)
    assert lam == found.lam, found.case
    assert min(lam["lam"], lam["rival_lam"]) >= LARGE, found.case
    assert [fault.name for fault in found.truth.faults] == list(found.case.faults)
