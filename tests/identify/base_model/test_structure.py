"""The rotor of a candidate: as assembled from a config that says the same, and its derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from rotorrig.identify.base_model.structure import StructuralModel, Structure, with_places
from rotorrig.rig.config.description import RigConfig
from rotorrig.sims.rotor.model.assembly import assemble, with_geometry
from rotorrig.sims.rotor.model.derivatives import finite_difference
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

PROBES = ("2y", "1x")
OMEGA = np.array([900.0, 2150.0, 3000.0]) * np.pi / 30
STRUCTURE = Structure(
    K=np.array([np.diag([31e3, 38e3])]),
    C=np.array([np.diag([9.0, 22.0])]),
    youngs_modulus=1.01,
    density=0.98,
    disk_mass=1.02,
    others=(1.1, 0.9, 1.0, 1.2),
)


NO_CHANGE = Structure(
    K=np.zeros((1, 2, 2)), C=np.zeros((1, 2, 2)), youngs_modulus=0.0, density=0.0, disk_mass=0.0, others=(0.0,) * 4
)


@pytest.fixture(scope="module")
def structural(rig: RigConfig) -> StructuralModel:
    return StructuralModel(rig, PROBES, groups=[["spring"]], others=["left A", "left B"])


def test_the_reduced_rotor_answers_as_the_one_assembled_from_a_config_of_those_values(
    rig: RigConfig, structural: StructuralModel
) -> None:
    shaft = rig.shaft.model_copy(
        update={"youngs_modulus": rig.shaft.youngs_modulus * 1.01, "density": rig.shaft.density * 0.98}
    )
    (disk,) = rig.disks
    values = {
        "left A": {"kxx": 2.2e6, "kyy": 1.8e6},
        "left B": {"kxx": 2.0e6, "kyy": 2.4e6},
        "spring": {"kxx": 31e3, "kyy": 38e3, "cxx": 9.0, "cyy": 22.0},
    }
    bearings = tuple(b.model_copy(update=values[b.name]) for b in rig.bearings)
    heavier = disk.model_copy(
        update={
            "mass": 1.02 * disk.mass,
            "polar_inertia": 1.02 * disk.polar_inertia,
            "transverse_inertia": 1.02 * disk.transverse_inertia,
        }
    )
    same = rig.model_copy(update={"shaft": shaft, "disks": (heavier,), "bearings": bearings})
    expected = probe_response(assemble(same), OMEGA, unbalance={"disk": 1e-5})
    found = probe_response(structural(STRUCTURE), OMEGA, unbalance={"disk": 1e-5})
    np.testing.assert_allclose(found[:, 0], expected[:, 3], rtol=1e-6)  # 2y
    np.testing.assert_allclose(found[:, 1], expected[:, 0], rtol=1e-6)  # 1x


def test_every_probe_is_there_once_more_turned_by_a_right_angle(structural: StructuralModel) -> None:
    found = probe_response(structural.nominal, OMEGA, unbalance={"disk": 1e-5})
    minus_x, y = found[:, 2], found[:, 3]  # across 2y, across 1x
    along_2y, along_1x = found[:, 0], found[:, 1]
    assert found.shape == (3, 4)
    # the nominal bearings are all but alike in x and y, and the whirl is forward: y = -j x
    np.testing.assert_allclose(minus_x[0], -1j * along_2y[0], rtol=0.05)
    np.testing.assert_allclose(y[0], -1j * along_1x[0], rtol=0.05)


@pytest.mark.parametrize("name", ["youngs_modulus", "density", "disk_mass", "K", "C", "others"])
def test_a_direction_is_the_derivative_of_the_matrices(structural: StructuralModel, name: str) -> None:
    unit = {"K": np.array([np.diag([1e3, 0.0])]), "C": np.array([np.diag([0.0, 1.0])]), "others": (0.0, 0.1, 0.0, 0.0)}
    along = unit.get(name, 0.01)
    change = replace(NO_CHANGE, **{name: along})
    moved = np.add(getattr(STRUCTURE, name), along)
    there = replace(STRUCTURE, **{name: tuple(moved) if name == "others" else moved})
    model = structural(STRUCTURE)
    found = structural.direction(model, STRUCTURE, change)
    expected = finite_difference(model, structural(there), 1.0)
    assert any(np.any(matrix) for matrix in expected)
    for matrix, left, right in zip(found._fields, found, expected, strict=True):
        np.testing.assert_allclose(left, right, atol=1e-9 * (1 + np.abs(right).max()), err_msg=matrix)


def test_planes_beyond_an_end_stand_at_that_end(rig: RigConfig) -> None:
    more = with_places(rig, {"inside": 0.1, "before": -0.01, "behind": 9.0})
    assert {p.name: p.position for p in more.planes[len(rig.planes) :]} == pytest.approx(
        {"inside": 0.1, "before": 0.0, "behind": rig.shaft.length}
    )
    assert with_places(rig, {}) is rig


OFF = replace(
    STRUCTURE,
    positions=(2e-3, -1e-3, 1.5e-3, -3e-3, 2e-3, -1e-3),  # disk, left A, left B, spring, 2y, 1x
    hubs=(0.4,),
    tilts=(30.0, 0.0, 5.0),
    diameter=0.004,
)


@pytest.fixture(scope="module")
def adjustable(rig: RigConfig) -> StructuralModel:
    return StructuralModel(rig, PROBES, groups=[["spring"]], others=["left A", "left B"], adjustable=True)


def test_an_adjustable_rotor_answers_as_the_other_on_the_nameplate(
    structural: StructuralModel, adjustable: StructuralModel
) -> None:
    want, found = (
        probe_response(model(STRUCTURE), OMEGA, unbalance={"disk": 1e-5}) for model in (structural, adjustable)
    )
    assert np.abs(found - want).max() < 2e-5 * np.abs(want).max()


def test_off_the_nameplate_it_answers_as_the_one_assembled_from_a_config_of_those_values(
    rig: RigConfig, adjustable: StructuralModel
) -> None:
    shift = dict(zip(adjustable.movable, OFF.positions, strict=True))
    assert list(shift) == ["disk disk", "bearing left A", "bearing left B", "bearing spring", "probe 2y", "probe 1x"]
    shaft = rig.shaft.model_copy(
        update={
            "youngs_modulus": rig.shaft.youngs_modulus * 1.01,
            "density": rig.shaft.density * 0.98,
            "diameter": rig.shaft.diameter * 1.004,
        }
    )
    values = {
        "left A": {"kxx": 2.2e6, "kyy": 1.8e6, "tilt_stiffness": 30.0},
        "left B": {"kxx": 2.0e6, "kyy": 2.4e6},
        "spring": {"kxx": 31e3, "kyy": 38e3, "cxx": 9.0, "cyy": 22.0, "tilt_stiffness": 5.0},
    }

    def moved(kind: str, part, **more):
        return part.model_copy(update={"position": part.position + shift[f"{kind} {part.name}"], **more})

    (disk,) = rig.disks
    inertia = {name: 1.02 * getattr(disk, name) for name in ("mass", "polar_inertia", "transverse_inertia")}
    same = rig.model_copy(
        update={
            "shaft": shaft,
            "disks": (moved("disk", disk, **inertia, hub_width=rig.hub_width("disk")),),
            "bearings": tuple(moved("bearing", b, **values[b.name]) for b in rig.bearings),
            "probes": tuple(moved("probe", rig.probe(name)) for name in PROBES),
        }
    )
    stiff = with_geometry(assemble(same, hubs=True), hubs={"disk": 0.4})
    expected = probe_response(stiff, OMEGA, unbalance={"disk": 1e-5})
    found = probe_response(adjustable(OFF), OMEGA, unbalance={"disk": 1e-5})
    assert np.abs(found[:, :2] - expected).max() < 2e-5 * np.abs(expected).max()
    assert np.abs(expected - probe_response(adjustable(STRUCTURE), OMEGA, unbalance={"disk": 1e-5})[:, :2]).max() > 1e-5


@pytest.mark.parametrize(("name", "number"), [("positions", n) for n in range(6)] + [("hubs", 0), ("tilts", 2)])
def test_so_is_a_direction_of_what_the_nameplate_has_wrong(adjustable: StructuralModel, name: str, number: int) -> None:
    values = list(getattr(OFF, name))
    step = {"positions": 1e-6, "hubs": 1e-4, "tilts": 1.0}[name]
    unit = np.zeros(len(values))
    unit[number] = 1.0

    def at(p: float):
        return adjustable(replace(OFF, **{name: tuple(np.add(values, p * unit))}))

    model = at(0.0)
    found = adjustable.direction(model, OFF, replace(NO_CHANGE, **{name: tuple(unit)}))
    expected = finite_difference(at(-step), at(step), 2 * step)
    assert any(np.any(matrix) for matrix in expected)
    for matrix, left, right in zip(found._fields, found, expected, strict=True):
        np.testing.assert_allclose(left, right, atol=1e-5 * np.abs(right).max(), err_msg=matrix)


def test_so_is_the_direction_of_the_diameter(adjustable: StructuralModel) -> None:
    found = adjustable.direction(adjustable(OFF), OFF, replace(NO_CHANGE, diameter=1.0))
    ahead, behind = (adjustable(replace(OFF, diameter=0.004 + p)) for p in (1e-5, -1e-5))
    for left, right in zip(found, finite_difference(behind, ahead, 2e-5), strict=True):
        np.testing.assert_allclose(left, right, atol=1e-6 * np.abs(right).max())


def test_a_rotor_that_is_not_adjustable_says_so(structural: StructuralModel) -> None:
    with pytest.raises(ValueError, match="condense_spans"):
        structural(OFF)
