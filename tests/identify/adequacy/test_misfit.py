"""A misfit is described as it was drawn."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.identify.adequacy.misfit import Misfit, Stretch, describe_misfit
from rotorrig.processing.response import OrderTrackedResponse

Complex = NDArray[np.complex128]


def described(response: OrderTrackedResponse, residual: Complex, *, probe: str = "1x") -> Misfit:
    """Describe what is left at 1X of `residual` (speed, probe) from the first to the last row of the run up."""
    model = np.full(response.z.shape[:2], 20e-6 + 0j)
    z = response.z.copy()
    z[..., 0] = model + residual
    stretch = Stretch(
        run=0, probe=response.probes.index(probe), order=0, rows=np.flatnonzero(response.run == 0), sigma=7.0
    )
    return describe_misfit(replace(response, z=z), {1: model}, residual[..., None], stretch)


def test_high_and_late_is_said_so(healthy: OrderTrackedResponse) -> None:
    off = np.full(healthy.z.shape[:2], 20e-6 * (1.25 * np.exp(-0.1j) - 1))
    found = described(healthy, off)
    assert found.relative == pytest.approx(0.25)
    assert found.phase == pytest.approx(-0.1)
    assert "25.0% high and 5.7 deg late" in found.sentence
    assert "7 sigma" in found.sentence


@pytest.mark.parametrize(("down", "words"), [(1.0, "the same"), (0.1, "hardly any"), (-1.0, "otherwise"), (9, "much")])
def test_the_other_direction_is_compared(healthy: OrderTrackedResponse, down: float, words: str) -> None:
    off = np.where(healthy.run[:, None] == 0, 1.0, down) * np.full(healthy.z.shape[:2], 2e-6 + 1e-6j)
    assert described(healthy, off).other_run.startswith(words)
    assert described(healthy, off).sentence.endswith("in the down run.")


def test_the_sense_of_whirl_is_told(healthy: OrderTrackedResponse) -> None:
    off = np.zeros(healthy.z.shape[:2], complex)
    x, y = (healthy.probes.index(name) for name in ("1x", "1y"))
    off[:, x], off[:, y] = 3e-6, -3e-6j  # y follows x: with the rotor
    assert described(healthy, off).backward == pytest.approx(0)
    assert "100% of it whirling forward" in described(healthy, off).sentence
    assert described(healthy, off.conj()).backward == pytest.approx(1)
    off[:, y] = 0
    assert described(healthy, off).backward == pytest.approx(0.5)
    assert "whirling" not in described(healthy, off).sentence


def test_a_run_of_one_direction_alone_is_compared_with_none(healthy: OrderTrackedResponse) -> None:
    alone = replace(healthy, runs=tuple(replace(run, direction=1) for run in healthy.runs))
    off = np.full(healthy.z.shape[:2], 2e-6 + 0j)
    assert described(alone, off).other_run == ""
