"""The command line of the chapter's identifications: what --quick leaves out, and what it leaves to other options."""

import pytest

from benchmarks.identification import QUICK, arguments


def test_quick_is_a_few_runs_of_each_unless_an_option_says_more() -> None:
    full, quick, more = arguments([]), arguments(["--quick"]), arguments(["--quick", "--seeds", "7"])
    assert all(getattr(quick, name) == count < getattr(full, name) for name, count in QUICK.items())
    assert (more.seeds, more.rigs) == (7, QUICK["rigs"])


def test_a_count_of_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        arguments(["--quick", "--chapter-staged", "0"])
    assert "--chapter-staged is 0, want at least 1" in capsys.readouterr().err
