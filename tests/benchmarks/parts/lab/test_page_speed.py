"""The pages' speed is measured on pages that were made and opened."""

import pytest

from benchmarks.parts.lab.page_speed import measure_page
from tests.app.browser import needs_chromium


@pytest.mark.browser
@needs_chromium
def test_a_small_lab_is_quick_and_curves_that_are_there_are_quicker() -> None:
    figures = measure_page(runs=60)
    assert set(figures) == {
        *("page_seconds", "page_seconds_again", "page_seconds_reading"),
        *("page_open_ms", "page_open_first_ms", "page_index_mb"),
    }
    assert 0 < figures["page_seconds_again"] < figures["page_seconds_reading"]
    assert 0 < figures["page_open_ms"] < 1000
    assert 0.02 < figures["page_index_mb"] < 0.15
