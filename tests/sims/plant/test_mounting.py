"""A base plate that gives way and a shaft that moves past its keyphasor, against what other rigs' probes show there."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.plant.draw import nameplate
from rotorrig.sims.plant.plant import Plant
from rotorrig.sims.plant.truth import Noise, Unmodelled

from .by_hand import measured, run_to, volts_of


def plant_of(rig: RigConfig, **values: float) -> Plant:
    """Return the nameplate's rig with these deviations; noise of the probes, without which counts are rounded alike."""
    dither = replace(Noise.none(), probe=1.5e-3)
    return Plant(rig, replace(nameplate(rig), noise=dither, unmodelled=Unmodelled(**values)))  # type: ignore[arg-type]


def with_probes_at(rig: RigConfig, place: float) -> RigConfig:
    """Move all probes to `place` [m]; they look along x, y, x, y."""
    return rig.model_copy(update={"probes": tuple(p.model_copy(update={"position": place}) for p in rig.probes)})


def phasors(plant: Plant, rpm: float) -> NDArray[np.complex128]:
    return measured(run_to(plant, rpm), 1.0)


@pytest.mark.parametrize("rpm", [1100.0, 2900.0])
def test_a_probe_reads_less_by_what_the_base_moves_as_a_mass_on_a_spring(rk4: RigConfig, rpm: float) -> None:
    """2 %, times (1 + 2 j zeta r) / (1 - r^2 + 2 j zeta r), r to 100 Hz."""
    place = rk4.bearing("spring").position
    plain, at_bearing = phasors(plant_of(rk4), rpm), phasors(plant_of(with_probes_at(rk4, place)), rpm)
    r, damped = rpm / 60 / 100, 2j * 0.03 * rpm / 60 / 100
    want = -0.02 * (1 + damped) / (1 - r * r + damped) * at_bearing
    got = phasors(plant_of(rk4, base_share=0.02, base_frequency=100.0), rpm) - plain
    assert np.abs(want).min() > 5e-8
    assert got == pytest.approx(want, abs=0.01 * np.abs(want).max() + 1e-9)


@pytest.mark.parametrize("direction", [0.4, math.pi / 2])
@pytest.mark.parametrize("rotation", ["x-to-y", "y-to-x"])
def test_a_shaft_that_moves_on_with_its_surface_brings_the_mark_early(
    rk4: RigConfig, direction: float, rotation: str
) -> None:
    """By that motion over the wheel's radius, at the moment the mark passes: the sag, and the whirl of the driven end.

    The wheel is the shaft's end here, of 1 mm radius, and the shift is larger than any real one's.
    """
    rig = rk4.model_copy(update={"rotation": rotation})
    end = with_probes_at(rig, 0.0)
    rpm, lead = 1700.0, 1e3
    plain = phasors(plant_of(rig), rpm)
    plant = run_to(plant_of(end), rpm)
    whirl = measured(plant, 1.0)[:2].real  # where it is as the mark passes, from the middle of its orbit
    middle = volts_of(plant, 60 / rpm * 20)[:, :2].mean(axis=0)
    x, y = whirl + (middle - [p.gap_voltage for p in rig.probes[:2]]) / 7874.0
    on = (1 if rotation == "x-to-y" else -1) * (y * math.cos(direction) - x * math.sin(direction))
    got = phasors(plant_of(rig, mark_lead=lead, keyphasor_direction=direction), rpm)
    assert abs(lead * on) > 2e-3
    assert np.angle(got / plain) == pytest.approx(-lead * on, abs=0.1 * abs(lead * on) + 2e-4)
    assert np.abs(got) == pytest.approx(np.abs(plain), rel=1e-3)
