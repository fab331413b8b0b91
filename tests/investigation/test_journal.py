"""The journal of an investigation comes back as it was written."""

import json
from pathlib import Path

import pytest

from rotorrig.identify import Verdict
from rotorrig.investigation.beliefs import Belief
from rotorrig.investigation.journal import Journal, Round, read_journal, write_journal
from rotorrig.rig import DataError, Provenance

SOURCE = Provenance(config_hash="abc", code_version="1", source="simulated rig")
FIRST = Round(
    number=1,
    plan="default",
    trial=(),
    why="The first.",
    unseen=False,
    seconds=90.0,
    verdict=Verdict.TIED,
    sentence="Tied.",
    beliefs=(Belief("bow", 0.6), Belief("runout, plane 1", 0.4)),
)
PENDING = Round(number=3, plan="default-faster", trial=("disk: 12 g mm at 90 deg",), why="More.", unseen=True)
JOURNAL = Journal(config_hash="abc", rounds=(FIRST, PENDING))


def test_it_is_read_as_it_was_written(tmp_path: Path) -> None:
    write_journal(tmp_path / "investigation.json", JOURNAL, SOURCE)
    assert read_journal(tmp_path / "investigation.json") == JOURNAL


def test_a_run_that_was_not_made_counts_for_nothing() -> None:
    assert (JOURNAL.judged, JOURNAL.seconds) == ((FIRST,), 90.0)
    assert (JOURNAL.mounted, Journal(config_hash="").mounted) == (PENDING.trial, ())
    assert JOURNAL.with_last(seconds=50.0).seconds == 140.0


def test_what_is_no_journal_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "investigation.json"
    write_journal(path, JOURNAL, SOURCE)
    table = json.loads(path.read_text())
    del table["rounds"][0]["why"]
    path.write_text(json.dumps(table))
    with pytest.raises(DataError, match=r"investigation\.json: is no whole investigation \('why'\)"):
        read_journal(path)
    path.write_text("{")
    with pytest.raises(DataError, match=r"investigation\.json: is no JSON"):
        read_journal(path)
