"""Where things are on the chapter's rig."""

import math
from dataclasses import replace

import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.rig.errors import DataError
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.places import (
    bending_spans,
    disk_of_number,
    held_bearings,
    probe_of_number,
    same_plane,
    sense,
    sought_bearings,
    true_bearing,
)


def test_bearings_are_those_sought_and_the_others(rk4: RigConfig) -> None:
    assert [b.name for b in sought_bearings(rk4)] == ["spring"]
    assert [b.name for b in held_bearings(rk4)] == ["left A", "left B"]
    nothing_sought = rk4.model_copy(update={"identify": None})
    assert sought_bearings(nothing_sought) == rk4.bearings
    assert held_bearings(nothing_sought) == rk4.bearings[:1]
    assert true_bearing(nameplate(rk4), rk4.bearings[2]).kxx == 33.9e3


def test_parts_go_by_their_number(rk4: RigConfig) -> None:
    assert disk_of_number(rk4, 0.0).name == "disk"
    assert probe_of_number(rk4, 3.0) == 3
    assert [same_plane(rk4, i) for i in range(4)] == [[0, 1], [0, 1], [2, 3], [2, 3]]
    with pytest.raises(DataError, match=r"number 1: is no disk of 'RK4 .* want a whole number from 0 to 0"):
        disk_of_number(rk4, 1.0)


def test_the_sense_of_rotation_is_the_sign_of_the_speed(rk4: RigConfig) -> None:
    assert sense(rk4) == 1.0
    assert sense(rk4.model_copy(update={"rotation": "y-to-x"})) == -1.0


def test_spans_end_where_they_are_cut_and_where_the_section_changes(rk4: RigConfig) -> None:
    table = rk4.model_dump()
    table["shaft"] |= {
        "diameter": 0.02,
        "sections": [{"length": 0.3, "diameter": 0.010}, {"length": 0.26, "diameter": 0.02}],
    }
    stepped = from_si(table)
    spans = bending_spans(stepped, replace(nameplate(stepped), modulus_factor=1.01), 0.1, 0.4)
    EI = 1.01 * 208.11e9 * math.pi / 64 * 0.01**4
    assert [span[:2] for span in spans] == [(0.1, 0.3), (0.3, 0.4)]
    assert [span[2] for span in spans] == pytest.approx([EI, 16 * EI])
