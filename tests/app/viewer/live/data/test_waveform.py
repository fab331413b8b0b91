"""Waveforms at equal angles, and what is made of them while a sweep runs: slow roll, full spectra, readings."""

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.app.text.amplitude_units import AS_STATED, AmplitudeUnit, read_amplitude_unit
from rotorrig.app.viewer.live.data.slow_roll import FEWEST, SlowRollSoFar, slow_roll_speeds
from rotorrig.app.viewer.live.data.spectra import SpectraSoFar
from rotorrig.app.viewer.live.data.tracker import Turns
from rotorrig.app.viewer.live.data.waveform import POINTS, THETA, Waveform, at_equal_angles
from rotorrig.app.viewer.live.parts.orbits import at_edges, first_order
from rotorrig.app.viewer.live.parts.readings import readings
from rotorrig.rig.config.description import RigConfig

RAD = np.pi / 30
RUNOUT = np.array([3.0, 4.0, 2.0, 1.0]) * 1e-6  # m, 1X, per probe
DENT = 0.5e-6  # m, 3X, every probe


def turned(x: NDArray[np.float64], *, rpm: float, turns: int, begin: float = 0.0) -> Waveform:
    """A waveform that repeats x (POINTS, probe) every turn."""
    return Waveform(edges=begin + np.arange(turns + 1) * 60 / rpm, x=np.tile(x, (turns, 1)))


def rolling() -> NDArray[np.float64]:
    """One turn of runout and a dent (POINTS, probe) [m], 10 um from the gap voltage's place."""
    return RUNOUT * np.cos(THETA)[:, None] + DENT * np.cos(3 * THETA)[:, None] + 10e-6


def rolled(rig: RigConfig, *, turns: int, rpm: float = 240.0) -> SlowRollSoFar:
    slow = SlowRollSoFar(rig)
    for i in range(0, turns, 2):
        waveform = turned(rolling(), rpm=rpm, turns=2, begin=i * 60 / rpm)
        z = np.tile(RUNOUT.astype(complex), (2, 1))
        gap = np.full((2, len(RUNOUT)), 10e-6)
        slow.add(Turns(t=waveform.edges[1:], omega=np.full(2, rpm * RAD), z=z, gap=gap), waveform)
    return slow


@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_sine_at_an_order_is_there_at_equal_angles(order: int) -> None:
    """Edges at fractional samples; POINTS means per turn damp order n by sinc(n / POINTS)."""
    first, edges = 1000.0, np.array([1000.37, 1351.81, 1700.02])
    samples = np.arange(1000, 1702)
    turn = np.interp(samples, edges, [0.0, 1.0, 2.0])
    x = np.cos(2 * np.pi * order * turn)[:, None]
    found = at_equal_angles(x, first=first, edges=edges)
    expected = np.tile(np.cos(order * THETA), 2) * np.sinc(order / POINTS)
    assert found.shape == (2 * POINTS, 1)
    assert np.abs(found[1:-1, 0] - expected[1:-1]).max() < 2e-3  # the trapezium between samples


def test_a_waveform_at_its_edges_and_its_first_order() -> None:
    waveform = turned(1e-4 * np.cos(THETA - 0.5)[:, None], rpm=1000, turns=3)
    assert first_order(waveform) == pytest.approx(1e-4 * np.exp(-0.5j))  # lags by 0.5 rad
    assert at_edges(waveform.x)[1:-1, 0] == pytest.approx(1e-4 * np.cos(0.5), rel=2e-3)
    assert len(at_edges(waveform.x)) == 4
    assert waveform.last(2).turns == 2 and waveform.last(9).turns == 3
    assert waveform.omega == pytest.approx(1000 * RAD)


def test_the_slow_roll_is_the_runout_at_the_plans_speed(rig: RigConfig) -> None:
    assert slow_roll_speeds(rig) == pytest.approx([240 * RAD])
    slow = rolled(rig, turns=20)
    assert slow.known and slow.turns == 20
    assert slow.z == pytest.approx(RUNOUT)
    assert slow.shape == pytest.approx(rolling() - 10e-6, abs=1e-12)
    assert slow.words == "slow roll of 20 turns at 240 rpm"


def test_there_is_no_slow_roll_from_few_turns_at_another_speed_or_without_a_plan(rig: RigConfig) -> None:
    assert not rolled(rig, turns=FEWEST - 2).known
    fast = rolled(rig, turns=20, rpm=480)
    assert not fast.known and fast.words == "no slow roll seen yet, at 240 rpm"
    planless = rolled(rig.model_copy(update={"plans": {}}), turns=20)
    assert not planless.known and "no plan of the config has one" in planless.words


def test_a_full_spectrum_has_forward_whirl_at_plus_and_backward_at_minus_its_order(rig: RigConfig) -> None:
    """x and y of 80 um forward at 1X and 5 um backward at 2X."""
    spectra = SpectraSoFar(rig)
    x = 80e-6 * np.cos(THETA) + 5e-6 * np.cos(2 * THETA)
    y = 80e-6 * np.sin(THETA) - 5e-6 * np.sin(2 * THETA)
    for rpm in (500.0, 510.0, 700.0):  # the second is nearer than a step
        spectra.add(turned(np.column_stack([x, y, x, y]), rpm=rpm, turns=8), direction=1)
    spectra.add(turned(np.column_stack([x, y, x, y]), rpm=700.0, turns=7), direction=-1)  # too few turns
    assert (spectra.count(1), spectra.count(-1)) == (2, 0)
    found = spectra.cascade(0, direction=1)
    assert found.rpm == pytest.approx([500, 700])
    at = dict(zip(found.order.tolist(), found.amplitude[0].tolist(), strict=True))
    assert at[1.0] == pytest.approx(80e-6, rel=1e-3)
    assert at[-2.0] == pytest.approx(5e-6, rel=3e-3)
    assert at[-1.0] < 1e-8 and at[2.0] < 1e-8


def test_the_readings_say_vectors_gap_and_what_the_rig_does(rig: RigConfig) -> None:
    waveform = turned(rolling() + 1e-4 * np.cos(THETA - np.pi / 2)[:, None], rpm=1500, turns=4)
    words = readings(
        rig, waveform, np.array([-10.0, -1.5, -10.0, -10.0]), rolled(rig, turns=20), unit=AS_STATED, note="up"
    )
    assert words.startswith("**1500 rpm** – up – slow roll of 20 turns at 240 rpm")
    (row,) = (line for line in words.splitlines() if line.startswith("| 1x "))
    raw, lag = np.hypot(100, 3), np.degrees(np.arctan2(100, 3))
    assert row.endswith(f"| {raw:.1f} at {lag:.0f}° | 100.0 at 90° |")
    assert "-1.50 **out of range**" in words
    still = readings(rig, None, np.full(4, -10.0), rolled(rig, turns=0), unit=AS_STATED)
    assert "no turn seen" in still and "no slow roll seen yet" in still


def test_the_readings_are_in_the_unit_that_is_asked_for(rig: RigConfig) -> None:
    """25.4 um 0-peak are 2 mil from peak to peak, and 1 mil 0-peak."""
    waveform = turned(np.tile(25.4e-6 * np.cos(THETA - THETA[0])[:, None], 4), rpm=1500, turns=4)
    told = {}
    for name in ("um pp", "mil pp", "mil 0-peak"):
        unit = AmplitudeUnit(read_amplitude_unit(name, where="test"))
        words = readings(rig, waveform, np.full(4, -10.0), rolled(rig, turns=0), unit=unit)
        head, row = (next(line for line in words.splitlines() if line.startswith(of)) for of in ("| probe", "| 1x "))
        told[name] = (head.split(" | ")[2:4], row.split(" | ")[2:4], words.splitlines()[-1].partition("1X: ")[2])
    at, lag = f"at {np.degrees(THETA[0]):.0f}°", "at its phase lag."
    assert told["um pp"] == (["p-p, µm", "1X raw, µm"], ["50.8", f"50.8 {at}"], f"pp, {lag}")
    assert told["mil pp"] == (["p-p, mil", "1X raw, mil"], ["2.00", f"2.00 {at}"], f"pp, {lag}")
    assert told["mil 0-peak"] == (["p-p, mil", "1X raw, mil"], ["2.00", f"1.00 {at}"], f"0-peak, {lag}")
