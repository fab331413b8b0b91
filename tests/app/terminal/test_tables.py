"""What `rotor identify` prints beside its values."""

import dataclasses
import io

import pytest
from rich.console import Console

from rotorrig.app.terminal.tables import critical_speeds_table
from rotorrig.app.text import NO_RESONANCE
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse


def test_critical_speeds_fit_a_terminal(response: OrderTrackedResponse, identification: Identification) -> None:
    shown = io.StringIO()
    Console(file=shown, width=80).print(critical_speeds_table(response, identification))
    lines = shown.getvalue().splitlines()
    rows = [line.split() for line in lines if line.count("±") > 1]
    assert [" ".join(row[:2]) for row in rows] == [
        f"{probe} {run}" for probe in response.probes for run in ("up", "down")
    ]
    for row in rows:
        assert float(row[2]) == pytest.approx(2233.6, abs=3), "the peak of 2230 rpm with 4 % damping"
        assert "…" not in row
    assert max(map(len, lines)) <= 80


def test_no_critical_speed_is_said_to_be_none(response: OrderTrackedResponse, identification: Identification) -> None:
    masked = dataclasses.replace(response, usable=response.usable & False)
    assert critical_speeds_table(masked, identification) == NO_RESONANCE
