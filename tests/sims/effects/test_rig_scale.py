"""Sizes of effects on a rig of another scale: stiffer, of less motion, faster, as a rig similar to the RK4 is."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pint
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.effects.base import Effect, Parameter, find
from rotorrig.sims.effects.rig_scale import POWERS, RK4, RigScale
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.nonlinear import steady_with_law
from tests.sims.effects.predicted import OMEGA, UNBALANCE, Complex, base_load, pair_at, predicted, simple_rig

STIFFER, FURTHER, FASTER = 20.0, 0.1, 1.7
SCALE = RigScale(stiffness=STIFFER * RK4.stiffness, motion=FURTHER * RK4.motion, speed=FASTER * RK4.speed)
BARE = RigScale(stiffness=40e3, motion=RK4.motion, speed=RK4.speed)


def rig_of(scale: RigScale) -> RigConfig:
    """The small rig, as much stiffer, lighter and faster in every part, without gravity and without a drive."""
    stiffer, faster = scale.stiffness / BARE.stiffness, scale.speed / BARE.speed
    heavier = stiffer / faster**2
    table: dict[str, Any] = simple_rig(pair_at(0.15), gravity="none").model_dump(mode="json", exclude_unset=True)
    table["shaft"] |= {"youngs_modulus": 207e9 * stiffer, "density": 7800.0 * heavier}
    for disk in table["disks"]:
        disk |= {name: disk[name] * heavier for name in ("mass", "polar_inertia", "transverse_inertia")}
    for bearing in table["bearings"]:
        bearing |= {name: bearing[name] * stiffer for name in ("kxx", "kyy") if name in bearing}
        bearing |= {name: bearing[name] * stiffer / faster for name in ("cxx", "cyy") if name in bearing}
    return from_si(table)


def answer(label: str, share: Mapping[str, float], scale: RigScale) -> Complex:
    """1X vectors (speed, probe) of the rig of that scale, in its own largest motion, with every unknown so many sizes.

    They are at the speeds that go with its critical one.
    """
    rig = rig_of(scale)
    effect: Effect = find(rig, label).rescale(scale)
    theta = {p.name: share.get(p.name, p.at_zero / p.size) * p.size for p in effect.parameters}
    model, omega = assemble(rig), OMEGA * scale.speed / BARE.speed
    grown = scale.motion / BARE.motion
    heavier = grown * scale.stiffness / BARE.stiffness / (scale.speed / BARE.speed) ** 2
    if laws := effect.force_laws(model, theta):
        z = steady_with_law(model, omega, [base_load(model, 1.0)], [UNBALANCE * heavier], laws)[..., 0]
        return z / grown
    with_it, without = (
        predicted(effect, t, rig=rig, model=model, base=False, omega=omega)[1] for t in (theta, effect.at_zero)
    )
    return (with_it - without) / grown


@pytest.mark.parametrize(
    ("label", "share"),
    [
        ("cubic_spring, bearing A", {"k3": 1.3}),
        ("clearance, bearing A", {"gap": 0.03}),
        ("drag", {"c2": 2.0}),
        ("rub, at disk", {"gap": 2.0, "stiffness": 0.3, "friction": 0.0}),
        ("bow, even", {"bow re": 1.0, "bow im": 0.4}),
        ("coupling", {"force 1X re": 1.0, "force 1X im": -0.3}),
        ("unbalance_plane, at 80 mm", {"unbalance re": 0.5, "unbalance im": 1.0}),
    ],
)
def test_a_similar_rig_answers_alike_to_the_same_number_of_sizes(label: str, share: Mapping[str, float]) -> None:
    scale = RigScale(stiffness=STIFFER * BARE.stiffness, motion=FURTHER * BARE.motion, speed=FASTER * BARE.speed)
    like, other = (answer(label, share, each) for each in (BARE, scale))
    assert np.abs(like).max() > 1e-7
    assert other == pytest.approx(like, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("unit", POWERS)
def test_a_unit_grows_by_the_dimensions_that_it_has(unit: str) -> None:
    of = pint.UnitRegistry().Quantity(1.0, unit.replace(" s", "*s").replace(" m", "*m")).dimensionality
    mass, length, time = (of.get(f"[{name}]", 0.0) for name in ("mass", "length", "time"))
    heavier = STIFFER / FASTER**2
    assert SCALE.ratio(unit) == pytest.approx(heavier**mass * FURTHER**length * FASTER**-time, rel=1e-12)


def test_what_is_not_of_the_rig_stays() -> None:
    runout = Parameter(name="runout re", unit="m", low=-25e-6, high=25e-6, size=5e-6)
    assert runout.rescale(SCALE) is runout


def test_every_figure_of_an_unknown_is_scaled() -> None:
    gap = Parameter(
        name="gap", unit="m", low=1e-6, high=5e-6, size=2e-6, at_zero=3e-6, starts=(2e-6, 4e-6), of_rig=True
    )
    small = gap.rescale(SCALE)
    assert (small.low, small.high, small.size, small.at_zero) == pytest.approx((1e-7, 5e-7, 2e-7, 3e-7))
    assert small.starts == pytest.approx((2e-7, 4e-7))
    assert math.isinf(small.prior)
