"""Positions, diameter, hubs and tilt: against a plain rotor of another kind, meshes made for them, and closed forms."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.effects.base import find
from rotorrig.sims.rotor.model.assembly import (
    Added,
    RotorModel,
    assemble,
    matrices,
    scale_properties,
    with_added,
    with_geometry,
    with_tilt,
)
from rotorrig.sims.rotor.model.component_modes import condense_spans
from rotorrig.sims.rotor.model.derivatives import (
    Direction,
    along_bearing_position,
    along_diameter,
    along_disk_position,
    along_hub,
    along_position,
    along_probe_position,
    along_tilt,
)
from rotorrig.sims.rotor.model.geometry import position_range
from rotorrig.sims.rotor.model.reduction import reduce
from rotorrig.sims.rotor.modes.modes import whirl_modes
from rotorrig.sims.rotor.steady.derivatives import steady_derivatives
from rotorrig.sims.rotor.steady.harmonic_response import probe_response
from tests.sims.rotor.plain_beam import Rotor

OMEGA = np.array([60.0, 150.0, 205.0, 222.0, 229.0, 233.0, 237.0, 244.0, 260.0, 310.0, 400.0])  # rad/s; critical at 233

Change = Callable[[RotorModel, float], RotorModel]

#: name -> (the plain rotor after a change, our model after it, its direction, the size of a change)
CHANGES: dict[str, tuple[Callable[[float], Rotor], Change, Callable[[RotorModel], Direction], float]] = {
    "disk": (
        lambda p: Rotor(disk=0.2805 + p),
        lambda m, p: with_geometry(m, positions={"disk disk": p}),
        lambda m: along_disk_position(m, "disk"),
        3e-3,
    ),
    "left A": (
        lambda p: Rotor(bearings={"left A": 0.065 + p, "left B": 0.080, "spring": 0.481}),
        lambda m, p: with_geometry(m, positions={"bearing left A": p}),
        lambda m: along_bearing_position(m, "left A"),
        3e-3,
    ),
    "left B": (
        lambda p: Rotor(bearings={"left A": 0.065, "left B": 0.080 + p, "spring": 0.481}),
        lambda m, p: with_geometry(m, positions={"bearing left B": p}),
        lambda m: along_bearing_position(m, "left B"),
        3e-3,
    ),
    "spring": (
        lambda p: Rotor(bearings={"left A": 0.065, "left B": 0.080, "spring": 0.481 + p}),
        lambda m, p: with_geometry(m, positions={"bearing spring": p}),
        lambda m: along_bearing_position(m, "spring"),
        3e-3,
    ),
    "probe": (
        lambda p: Rotor(probes=(0.2505 + p, 0.3805)),
        lambda m, p: with_geometry(m, positions={"probe 1x": p}),
        lambda m: along_probe_position(m, "1x"),
        3e-3,
    ),
    "diameter": (
        lambda p: Rotor(diameter=0.010 * (1 + p)),
        lambda m, p: with_geometry(m, diameter=p),
        along_diameter,
        0.006,
    ),
    "hub": (
        lambda p: Rotor(hub=0.3 + p),
        lambda m, p: with_geometry(m, hubs={"disk": 0.3 + p}),
        lambda m: along_hub(m, "disk"),
        0.3,
    ),
    "tilt": (
        lambda p: Rotor(tilt={"left B": 200.0 + p, "spring": 50.0}),
        lambda m, p: with_tilt(m, {"left B": 200.0 + p, "spring": 50.0}),
        lambda m: along_tilt(m, "left B"),
        200.0,
    ),
}


@pytest.fixture(scope="module")
def rig(rk4: RigConfig) -> RigConfig:
    """The RK4 with a spring bearing alike in x and y, and its two probes along x."""
    spring = rk4.bearing("spring").model_copy(update={"kxx": 34e3, "kyy": 34e3})
    bearings = (rk4.bearing("left A"), rk4.bearing("left B"), spring)
    return rk4.model_copy(update={"bearings": bearings, "probes": (rk4.probe("1x"), rk4.probe("2x"))})


@pytest.fixture(scope="module", params=["full", "condensed"])
def model(request: pytest.FixtureRequest, rig: RigConfig) -> RotorModel:
    whole = assemble(rig, hubs=True)
    return whole if request.param == "full" else condense_spans(whole)


def seen(model: RotorModel) -> np.ndarray:
    return probe_response(model, OMEGA, unbalance={"disk": 1.0})


@pytest.mark.parametrize("name", CHANGES)
def test_what_a_change_does_is_what_it_does_to_a_plain_rotor(model: RotorModel, name: str) -> None:
    plain, changed, _, size = CHANGES[name]
    got = seen(changed(model, size)) - seen(changed(model, 0.0))
    want = plain(size).response(OMEGA) - plain(0.0).response(OMEGA)
    assert np.abs(got - want).max() < 1e-3 * np.abs(want).max()


@pytest.mark.parametrize("name", CHANGES)
def test_its_derivative_is_that_of_a_plain_rotor(model: RotorModel, name: str) -> None:
    plain, changed, direction, size = CHANGES[name]
    there, step = changed(model, 0.0), 0.01 * size
    (got,) = steady_derivatives(there, OMEGA, unbalance=["disk"], directions=[direction(there)]).by
    want = (plain(step).response(OMEGA) - plain(-step).response(OMEGA)) / (2 * step)
    assert np.abs(got[..., 0] - want).max() < 2e-3 * np.abs(want).max()


@pytest.mark.parametrize("name", CHANGES)
def test_its_derivative_is_the_limit_of_differences_wherever_the_rest_is(model: RotorModel, name: str) -> None:
    """With every other difference from the nameplate there too, structural and proportional damping, turning back."""
    rayleigh = model.rayleigh.model_copy(update={"stiffness": 1e-5, "mass": 0.3})
    model = replace(model, structural_damping=0.01, rayleigh=rayleigh, rotation=-1)
    model = scale_properties(model, youngs_modulus=1.02, density=0.97)
    part = {"disk": "disk disk", "probe": "probe 1x"}.get(name, f"bearing {name}")
    off: dict[str, Any] = {
        "positions": {"disk disk": -2e-3, "bearing left A": 1e-3, "bearing spring": 2e-3, "probe 2x": 4e-3},
        "hubs": {"disk": 0.5},
        "diameter": -0.003,
    }

    def at(p: float) -> RotorModel:
        if name == "tilt":
            return with_tilt(with_geometry(model, **off), {"left B": 100 + p})
        if name == "hub":
            return with_geometry(model, **off | {"hubs": {"disk": 0.5 + p}})
        if name == "diameter":
            return with_geometry(model, **off | {"diameter": p - 0.003})
        positions = off["positions"] | {part: off["positions"].get(part, 0.0) + p}
        return with_geometry(model, **off | {"positions": positions})

    there, step = at(0.0), 1e-3 * CHANGES[name][3]
    (got,) = steady_derivatives(there, OMEGA, unbalance=["disk"], directions=[CHANGES[name][2](there)]).by
    want = (seen(at(step)) - seen(at(-step))) / (2 * step)
    assert np.abs(got[..., 0] - want).max() < 1e-5 * np.abs(want).max()


PLACES: dict[str, dict[str, float]] = {
    "disk": {"disk disk": 3e-3},
    "disk, to the end of its range": {"disk disk": -10e-3},
    "pair": {"bearing left A": 3e-3, "bearing left B": -3e-3},
    "spring": {"bearing spring": 10e-3},
    "probes": {"probe 1x": 10e-3, "probe 1y": -3e-3, "probe 2x": 1e-6},
    "all": {
        "disk disk": 3e-3,
        "bearing left A": -3e-3,
        "bearing left B": 3e-3,
        "bearing spring": -3e-3,
        "probe 2y": 3e-3,
    },
}


@pytest.mark.parametrize("places", PLACES)
@pytest.mark.parametrize("max_element", [0.02, 0.05])
def test_a_moved_part_is_as_on_a_mesh_that_has_its_node_there(rk4: RigConfig, places: str, max_element: float) -> None:
    moved = PLACES[places]
    other = rk4.model_copy(
        update={
            f"{kind}s": tuple(
                p.model_copy(update={"position": p.position + moved.get(f"{kind} {p.name}", 0.0)})
                for p in getattr(rk4, f"{kind}s")
            )
            for kind in ("disk", "bearing", "probe")
        }
    )
    omega = np.linspace(25, 420, 80)
    want = probe_response(assemble(other, max_element=max_element), omega, unbalance={"disk": 1e-5})
    there = with_geometry(assemble(rk4, max_element=max_element), positions=moved)
    got = probe_response(there, omega, unbalance={"disk": 1e-5})
    assert np.abs(got - want).max() < 2e-5 * np.abs(want).max()


def test_as_the_nameplate_says_it_is_the_assembled_model(rk4: RigConfig) -> None:
    model = assemble(rk4, hubs=True)
    same = with_geometry(with_geometry(model, positions={"disk disk": 4e-3}, diameter=0.01))
    for got, want in zip(same.shaft, model.shaft, strict=True):
        np.testing.assert_allclose(got, want, atol=1e-12 * (1 + np.abs(want).max()))
    for name in ("probes", "weight", "centreline", "z"):
        np.testing.assert_allclose(getattr(same, name), getattr(model, name), atol=1e-14)


def test_a_wider_shaft_is_as_a_config_says_it(rk4: RigConfig) -> None:
    shaft = rk4.shaft.model_copy(update={"diameter": rk4.shaft.diameter * 1.02})
    want = assemble(rk4.model_copy(update={"shaft": shaft}))
    got = with_geometry(assemble(rk4), diameter=0.02)
    for name, A, B in zip(got.shaft._fields, got.shaft, want.shaft, strict=True):
        np.testing.assert_allclose(A, B, atol=1e-12 * (1 + np.abs(B).max()), err_msg=name)
    np.testing.assert_allclose(got.weight, want.weight, atol=1e-15)


def test_a_hub_is_a_stepped_shaft_of_a_higher_modulus(rk4: RigConfig) -> None:
    """But for its shear, which the section has stiffer too: 2e-4 of the bending within 25 mm."""
    (disk,) = rk4.disks
    ends = [0.0, disk.position - 0.0125, disk.position + 0.0125, rk4.shaft.length]
    sections = [
        {"length": b - a, "diameter": 0.01, "youngs_modulus": rk4.shaft.youngs_modulus * (2.5 if i == 1 else 1)}
        for i, (a, b) in enumerate(pairwise(ends))
    ]
    table = rk4.model_dump() | {"shaft": {**rk4.shaft.model_dump(), "sections": sections}}
    omega = np.linspace(25, 420, 80)
    stepped, plain = (probe_response(assemble(r), omega, unbalance={"disk": 1e-5}) for r in (from_si(table), rk4))
    got = probe_response(with_geometry(assemble(rk4, hubs=True), hubs={"disk": 0.6}), omega, unbalance={"disk": 1e-5})
    assert np.abs(stepped - plain).max() > 0.1 * np.abs(plain).max()
    assert np.abs(got - stepped).max() < 5e-3 * np.abs(stepped - plain).max()


def slender(*, tilt: float = 0.0) -> RigConfig:
    """Return a shaft of 5 mm and 1 m in two rigid bearings at its ends, with a disk of next to nothing."""
    bearing = {"rigid": True, "tilt_stiffness": tilt}
    return from_si(
        {
            "name": "beam",
            "shaft": {"length": 1.0, "diameter": 0.005, "density": 7800.0, "youngs_modulus": 2e11},
            "disks": [{"name": "d", "position": 0.4, "mass": 1e-9, "polar_inertia": 0.0, "transverse_inertia": 0.0}],
            "bearings": [{"name": "a", "position": 0.0, **bearing}, {"name": "b", "position": 1.0, **bearing}],
            "probes": [{"name": "p", "position": 0.5, "angle": 0.0, "channel": 0}],
        }
    )


def first_root(model: RotorModel) -> float:
    """Return beta L of the first bending frequency."""
    omega = abs(whirl_modes(model, 0.0, count=1)[0].eigenvalue)
    return math.sqrt(omega * math.sqrt(7800 * math.pi / 4 * 0.005**2 / (2e11 * math.pi / 64 * 0.005**4)))


@pytest.mark.parametrize(("kt", "root"), [(0.0, math.pi), (1e7, 4.730041)], ids=["pinned", "clamped"])
@pytest.mark.parametrize("kind", ["full", "condensed"])
def test_a_bearing_that_resists_all_tilt_clamps_the_shaft(kt: float, root: float, kind: str) -> None:
    model = assemble(slender())
    model = with_tilt(condense_spans(model) if kind == "condensed" else model, {"a": kt, "b": kt})
    assert first_root(model) == pytest.approx(root, rel=1e-4)


@pytest.mark.parametrize("ratio", [0.1, 1.0, 10.0, 100.0])
def test_a_bearing_that_resists_tilt_a_little_is_a_torsion_spring(ratio: float) -> None:
    """Symmetric modes about the middle: 2 c + r/2 (tan c + tanh c) 2 = 0 with c = beta L / 2, r = kt L / E I."""
    c = brentq(lambda c: 4 * c + ratio * (math.tan(c) + math.tanh(c)), math.pi / 2 + 1e-6, 4.7301 / 2)
    kt = ratio * 2e11 * math.pi / 64 * 0.005**4
    assert first_root(assemble(slender(tilt=kt))) == pytest.approx(2 * c, rel=1e-4)


def test_parts_near_each_other_keep_their_order(rk4: RigConfig) -> None:
    geometry = assemble(rk4, hubs=True).geometry
    assert geometry is not None
    assert position_range(geometry, "bearing left A") == pytest.approx(0.4 * 15e-3)
    assert position_range(geometry, "disk disk") == position_range(geometry, "probe 2y") == 10e-3


def test_ends_and_steps_stay_unless_they_are_next_to_a_part(rk4: RigConfig) -> None:
    sections = [{"length": each, "diameter": 0.01} for each in (0.08, 0.22, 0.16, 0.1)]  # steps at 80, 300, 460 mm
    shaft = {**rk4.shaft.model_dump(), "sections": sections}
    model = assemble(from_si(rk4.model_dump() | {"shaft": shaft}))
    moved = with_geometry(model, positions={"bearing left B": 2e-3, "bearing spring": 4e-3, "disk disk": -1e-3})
    shift = dict(zip(np.round(model.z, 6), moved.z - model.z, strict=True))
    assert shift[0.0] == shift[0.56] == shift[0.065] == 0.0
    assert shift[0.08] == pytest.approx(2e-3)  # a shoulder, and its bearing
    assert shift[0.481] == pytest.approx(4e-3)
    assert shift[0.46] == 0.0  # 21 mm from the spring bearing
    assert -1e-3 < shift[0.3] < 4e-3 * (0.3 - 0.2805) / (0.46 - 0.2805)  # 19.5 mm from the disk: with its surroundings


def test_parts_at_one_place_move_as_one_and_a_shaft_ends_where_its_last_bearing_is(lalanne_like: RigConfig) -> None:
    model = assemble(lalanne_like)
    moved = with_geometry(model, positions={"bearing right": 1e-3, "disk 1": 2e-3})
    assert moved.z[-1] - model.z[-1] == pytest.approx(1e-3)
    assert moved.z[0] == 0.0
    both = with_geometry(model, positions={"disk 1": 1e-3, "bearing middle": 1e-3})
    np.testing.assert_allclose(both.z, with_geometry(model, positions={"disk 1": 2e-3}).z, atol=1e-15)


@pytest.fixture(scope="module")
def lalanne_like() -> RigConfig:
    """A stout shaft that ends in its bearings, one more right under a disk, and a plane next to it."""
    disk = {"mass": 10.0, "polar_inertia": 0.1, "transverse_inertia": 0.06}
    bearing = {"kxx": 5e7, "kyy": 7e7, "cxx": 500.0, "cyy": 700.0}
    ends = {"left": 0.0, "middle": 0.3, "right": 1.0}
    return from_si(
        {
            "name": "stout",
            "shaft": {"length": 1.0, "diameter": 0.05, "density": 7800.0, "youngs_modulus": 2e11},
            "disks": [{"name": "1", "position": 0.3, **disk}, {"name": "2", "position": 0.65, **disk}],
            "planes": [{"name": "ring", "position": 0.31}],
            "bearings": [{"name": name, "position": z, **bearing} for name, z in ends.items()],
            "probes": [{"name": "p", "position": 0.3, "angle": 0.4, "channel": 0}],
        }
    )


def test_a_condensed_model_is_the_full_one_under_all_priors_at_three_sigmas(rk4: RigConfig) -> None:
    full = assemble(rk4, hubs=True)
    small = condense_spans(full)
    assert small.dof <= 28
    omega, rng = np.linspace(25, 420, 60), np.random.default_rng(5)
    parts = [f"{kind} {p.name}" for kind in ("disk", "bearing", "probe") for p in getattr(rk4, f"{kind}s")]
    worst = 0.0
    for _ in range(6):
        off = {
            "positions": {part: 3e-3 * rng.choice([-1, 1]) for part in parts},
            "hubs": {"disk": rng.choice([0.0, 0.9])},
            "diameter": 0.006 * rng.choice([-1, 1]),
        }
        tilts = {b.name: 3 * rk4.tilt_prior(b.name) * rng.choice([0, 1]) for b in rk4.bearings}
        want, got = (
            probe_response(with_tilt(with_geometry(m, **off), tilts), omega, unbalance={"disk": 1e-5})
            for m in (full, small)
        )
        worst = max(worst, np.abs(got - want).max() / np.abs(want).max())
    assert worst < 5e-6


def test_a_condensed_model_of_other_rotors_is_the_full_one(lalanne_like: RigConfig) -> None:
    """To three times the speed range of the chapter's stout rotor: 12,000 rpm."""
    full = assemble(lalanne_like, hubs=True)
    small = condense_spans(full)
    omega = np.linspace(50, 1260, 80)
    off = {
        "positions": {"disk 2": 5e-3, "bearing right": -5e-3, "probe p": 2e-3},
        "hubs": {"2": 0.6},
        "diameter": 0.006,
    }
    for change in ({}, off):
        want, got = (
            probe_response(with_geometry(m, **change), omega, unbalance={"ring": 1e-5, "2": 1e-5j})
            for m in (full, small)
        )
        assert np.abs(got - want).max() < 1e-4 * np.abs(want).max()


def test_static_loads_at_the_parts_of_a_condensed_model_are_exact_in_every_geometry(rk4: RigConfig) -> None:
    flexibility = []
    full = assemble(rk4, hubs=True)
    for model in (full, condense_spans(full, modes=1)):
        there = with_geometry(model, positions={"disk disk": 9e-3, "bearing left A": 5e-3}, hubs={"disk": 0.8})
        there = with_tilt(there, {"spring": 1e3})
        rows = np.vstack([there.disk("disk").rows, there.tilt("left A").rows, there.probes])
        flexibility.append(rows @ np.linalg.solve(matrices(there).K, rows[:6].T))
    np.testing.assert_allclose(flexibility[1], flexibility[0], rtol=1e-7, atol=1e-12)


def test_coordinates_added_later_leave_the_geometry_to_be_changed(rk4: RigConfig) -> None:
    model = find(rk4, "pedestal, x").change_matrices(
        condense_spans(assemble(rk4)), {"lightness": 0.2, "omega": 200.0, "damping ratio": 0.03}
    )
    (got,) = steady_derivatives(model, OMEGA, unbalance=["disk"], directions=[along_position(model, "disk disk")]).by
    step = 1e-5
    up, down = (with_geometry(model, positions={"disk disk": p}) for p in (step, -step))
    want = (seen(up) - seen(down)) / (2 * step)
    assert np.abs(got[..., 0] - want).max() < 1e-5 * np.abs(want).max()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"positions": {"disk wheel": 1e-3}}, "no part 'disk wheel'"),
        ({"positions": {"left A": 1e-3}}, "no part 'left A'"),
        ({"positions": {"bearing left A": 7e-3}}, "position of bearing left A is off by 0.007, want -0.006 to 0.006 m"),
        ({"hubs": {"wheel": 0.5}}, "no hub of a disk 'wheel'"),
        ({"hubs": {"disk": -0.1}}, "hub of 'disk' is off by -0.1"),
        ({"diameter": math.nan}, "diameter is off by nan"),
    ],
)
def test_what_cannot_be_is_refused(rk4: RigConfig, change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        with_geometry(assemble(rk4, hubs=True), **change)


def test_models_without_a_geometry_say_so(rk4: RigConfig) -> None:
    with pytest.raises(ValueError, match="condense_spans"):
        with_geometry(reduce(assemble(rk4)), diameter=0.01)
    with pytest.raises(ValueError, match="no hub of a disk 'disk'"):
        along_hub(assemble(rk4), "disk")
    with pytest.raises(ValueError, match="want zero or more"):
        with_tilt(assemble(rk4), {"spring": -1.0})
    added = with_added(assemble(rk4), Added(K=np.zeros((128, 128))))
    with pytest.raises(ValueError, match="as assembled"):
        condense_spans(added)
