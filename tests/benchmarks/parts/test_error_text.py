"""An exception as it is kept: where it was raised can be read anywhere, and no path of a machine is in it."""

from pathlib import Path

from benchmarks.parts.error_text import error_text


def test_paths_are_relative_to_the_project() -> None:
    try:
        int("seven")
    except ValueError:
        text = error_text()
    assert 'File "tests/benchmarks/parts/test_error_text.py", line' in text
    assert str(Path(__file__).parents[3]) not in text
    assert "ValueError: invalid literal" in text
