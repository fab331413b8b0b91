"""What `rotor identify` prints beside its values."""

import dataclasses
import io

import pytest
from rich.console import Console

from rotorrig.app.terminal.tables import critical_speeds_table
from rotorrig.app.text import NO_RESONANCE
from rotorrig.identify.identification import Identification, ModelResonance
from rotorrig.processing.resonance import Resonance, Uncertain
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


def test_the_models_critical_speeds_are_told_with_their_uncertainty_below_the_measured_ones(
    response: OrderTrackedResponse, identification: Identification
) -> None:
    """And those of the response shown, not of the other one that the fit was made of."""
    figures = (Uncertain(value=v, sigma=s) for v, s in ((234.0, 0.02), (1e-4, 1e-6), (225.0, 0.1), (243.0, 0.1)))
    peak = Resonance(
        **dict(zip(("omega", "amplitude", "lower", "upper"), figures, strict=True)),
        amplification=Uncertain(value=13.0, sigma=0.25),
        damping=Uncertain(value=0.0385, sigma=0.0007),
    )
    other = dataclasses.replace(peak, omega=Uncertain(value=230.0, sigma=0.02))
    found = [
        ModelResonance(response=n, run=run, probe=probe, resonance=each)
        for n, each in enumerate((peak, other))
        for probe in response.probes
        for run in ("up", "down")
    ]
    fit = dataclasses.replace(identification.fits[0], resonances=tuple(found))
    shown = io.StringIO()
    told = dataclasses.replace(identification, fits=(fit,))
    Console(file=shown, width=80).print(critical_speeds_table(response, told))
    rows = [line.split() for line in shown.getvalue().splitlines() if "model" in line]
    assert rows == [["model", "2234.54", "±", "0.19", "13.00", "±", "0.25", "3.850", "±", "0.070"]] * 2 * len(
        response.probes
    )


def test_no_critical_speed_is_said_to_be_none(response: OrderTrackedResponse, identification: Identification) -> None:
    masked = dataclasses.replace(response, usable=response.usable & False)
    assert critical_speeds_table(masked, identification) == NO_RESONANCE
