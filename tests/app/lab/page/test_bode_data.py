"""A run's curves are few points that keep the peak, in a script that says nothing but them."""

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rotorrig.app.lab.page.bode_data import POINTS, is_written, write_bode_data
from rotorrig.processing.response import OrderTrackedResponse

RUN = "0123456789abcdef"


def table_of(path: Path) -> dict[str, Any]:
    """What the script hands to the page."""
    form, call = path.read_text().splitlines()
    assert form.startswith("//")
    assert call.startswith(f'rotorLab.take("{RUN}", ') and call.endswith(");")
    found: dict[str, Any] = json.loads(call.removeprefix(f'rotorLab.take("{RUN}", ').removesuffix(");"))
    return found


def test_a_probe_has_at_most_two_hundred_points_and_its_peak_among_them(
    tmp_path: Path, response: OrderTrackedResponse
) -> None:
    assert np.count_nonzero(response.run > 0) > 3 * POINTS
    write_bode_data(tmp_path / "a.js", RUN, response)
    table = table_of(tmp_path / "a.js")
    assert table["slow_roll_subtracted"] is True
    assert [probe["name"] for probe in table["probes"]] == list(response.probes)
    for probe in table["probes"]:
        assert sum(len(curve["rpm"]) for curve in probe["curves"]) <= POINTS
        assert [(curve["run"], curve["direction"]) for curve in probe["curves"]] == [("up", 1), ("down", -1)]
    up = table["probes"][0]["curves"][0]
    assert max(up["amplitude"]) == pytest.approx(187.5, rel=0.01)  # e / (2 zeta)
    assert up["rpm"][int(np.argmax(up["amplitude"]))] == pytest.approx(2230, rel=0.01)
    assert up["lag"][int(np.argmax(up["amplitude"]))] == pytest.approx(90 - 40, abs=6)  # 90 behind the unbalance


def test_rows_that_are_not_usable_are_gaps(tmp_path: Path, response: OrderTrackedResponse) -> None:
    usable = response.usable.copy()
    usable[100:300] = False
    write_bode_data(tmp_path / "a.js", RUN, dataclasses.replace(response, usable=usable))
    up = table_of(tmp_path / "a.js")["probes"][0]["curves"][0]
    assert None in up["amplitude"]
    assert all(rpm is not None for rpm in up["rpm"])


def test_a_name_cannot_say_anything_else(tmp_path: Path, response: OrderTrackedResponse) -> None:
    nasty = '</script>"); alert(1); //\u2028'
    runs = (response.runs[0], *(dataclasses.replace(run, name=nasty) for run in response.runs[1:]))
    write_bode_data(tmp_path / "a.js", RUN, dataclasses.replace(response, runs=runs))
    assert "<" not in (tmp_path / "a.js").read_text()
    assert table_of(tmp_path / "a.js")["probes"][0]["curves"][0]["run"] == nasty


def test_a_script_of_another_form_counts_as_missing(tmp_path: Path, response: OrderTrackedResponse) -> None:
    path = tmp_path / "a.js"
    assert not is_written(path)
    path.write_bytes(b"\xff\xfe")
    assert not is_written(path)
    path.write_text("// Curves of one run for the page of a lab, form 0\n")
    assert not is_written(path)
    write_bode_data(path, RUN, response)
    assert is_written(path)
