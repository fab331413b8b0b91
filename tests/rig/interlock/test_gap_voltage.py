"""A probe that is dead, shorted or out of its range is not OK, and stops the rotor after a second."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig
from rotorrig.rig.errors import LimitExceeded
from rotorrig.rig.interlock import Interlock
from rotorrig.rig.probes.base import Block, DaqInfo
from tests.rig.signals import RATE, block, cut, pulse_volts, to_counts

T = np.arange(20_000) / RATE
EVERY_20_MS = list(range(200, 20_000, 200))


def probe_at(volts: float, *, seconds: float = 2.0) -> Block:
    """Return two seconds of a rotor at 1200 rpm; probe 1y reads `volts` for the first `seconds`, then is sound."""
    whole = block(pulse_volts(20 * T), 50e-6 * np.cos(40 * np.pi * T))
    whole.counts[: round(seconds * RATE), 1] = to_counts(np.array([volts]))[0]
    return whole


def watch(rig: RigConfig, info: DaqInfo, whole: Block) -> tuple[float, str]:
    """Check a block in pieces of 20 ms; return the time [s] of a trip and what it says, or the end and nothing."""
    interlock = Interlock(rig, info)
    for piece in cut(whole, EVERY_20_MS):
        try:
            interlock.check(piece)
        except LimitExceeded as error:
            return (piece.first_sample + len(piece.counts)) / RATE, str(error)
    return len(whole.counts) / RATE, ""


@pytest.mark.parametrize("limits", [True, False])
@pytest.mark.parametrize("volts", [0.0, -19.9, -1.5, -18.5, 3.0])
def test_a_probe_outside_its_range_stops_the_rotor_after_a_second(
    rk4: RigConfig, info: DaqInfo, volts: float, limits: bool
) -> None:
    rig = rk4 if limits else rk4.model_copy(update={"limits": None})
    at, said = watch(rig, info, probe_at(volts))
    want = "want -18 to -2 V; check its gap and cable"
    assert said == f"probe 1y: not OK, gap voltage {volts:.1f} V for 1.0 s, {want}"
    assert at == pytest.approx(1.0, abs=0.03)


def test_a_loose_contact_of_less_than_a_second_does_not(rk4: RigConfig, info: DaqInfo) -> None:
    assert rk4.limits
    wide = rk4.model_copy(update={"limits": rk4.limits.model_copy(update={"vibration": 0.1})})
    assert watch(wide, info, probe_at(0.0, seconds=0.9)) == (2.0, "")


def test_the_swing_of_a_slow_turn_is_not_the_gap(rk4: RigConfig, info: DaqInfo) -> None:
    turns = 1.5 * T  # 90 rpm: the mean of a block is where the shaft is just then
    whole = block(pulse_volts(turns), -500e-6 + 850e-6 * np.cos(2 * np.pi * turns))  # to -20.6 V, and back
    assert watch(rk4, info, whole) == (2.0, "")


def test_a_range_that_is_not_the_probes_is_not_held_against_it(rk4: RigConfig, info: DaqInfo) -> None:
    divided = tuple(probe.model_copy(update={"gap_voltage": -1.0, "sensitivity": 787.4}) for probe in rk4.probes)
    tenth = rk4.model_copy(update={"probes": divided, "limits": None})
    whole = probe_at(-1.0)
    whole.counts[:, :4] = to_counts(np.array([-1.0]))[0]
    assert watch(tenth, info, whole) == (2.0, "")


def test_an_inverting_input_is_judged_by_the_probes_volts(rk4: RigConfig, info: DaqInfo) -> None:
    inverted = replace(info, volts_per_count=tuple(-v for v in info.volts_per_count))
    whole = probe_at(-10.0)
    assert watch(rk4, inverted, Block(counts=-whole.counts, first_sample=0, t_ns=0)) == (2.0, "")
