"""The config of a rotor of ROSS: the same shaft, disks and bearings in the units a person writes."""

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.nameplate import OverSpeed
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.reading import read_ross
from rotorrig.rig.ross.rotor import RossRotor
from rotorrig.rig.ross.to_config import config_text
from rotorrig.sims.rotor.model.assembly import assemble
from rotorrig.sims.rotor.modes.modes import whirl_modes

Stored = Callable[[str], Path]


def config_of(rotor: RossRotor, *, keep_nodes: bool = False) -> RigConfig:
    return parse(config_text(rotor, name="it", source="rotor.toml", keep_nodes=keep_nodes), where="rotor.toml")


def eigenvalues(rig: RigConfig, omega: float) -> list[complex]:
    """The eight lowest, on a mesh of sections, disks and bearings alone."""
    return [mode.eigenvalue for mode in whirl_modes(assemble(rig, max_element=10.0), omega, count=8)]


def said_eigenvalues(said: dict[str, Any], name: str, omega: float) -> list[complex]:
    return [complex(*value) for value in said[name]["eigenvalues"][f"{omega:g}"]]


@pytest.mark.parametrize("name", ["plain", "stepped"])
@pytest.mark.parametrize("omega", [100.0, 300.0])
def test_on_ross_nodes_the_model_has_the_eigenvalues_ross_says(
    name: str, omega: float, stored: Stored, said: dict[str, Any]
) -> None:
    rig = config_of(read_ross(stored(name)), keep_nodes=True)
    assert assemble(rig, max_element=10.0).z == pytest.approx(said[name]["nodes"], abs=1e-9)
    assert eigenvalues(rig, omega) == pytest.approx(said_eigenvalues(said, name, omega), rel=1e-9)


@pytest.mark.parametrize("omega", [100.0, 300.0])
def test_a_taper_in_steps_is_nearer_to_many_elements_of_ross_than_its_single_one(
    omega: float, stored: Stored, said: dict[str, Any]
) -> None:
    ours = eigenvalues(config_of(read_ross(stored("tapered")), keep_nodes=True), omega)
    many, single = (np.array(said_eigenvalues(said, name, omega)) for name in ("tapered in 20", "tapered"))
    assert abs(ours[0] / many[0] - 1) < 4e-4
    assert abs(single[0] / many[0] - 1) > 5e-3
    assert ours[:4] == pytest.approx(many[:4], rel=1e-3)


def test_steps_of_a_taper_weigh_what_the_frustum_does(stored: Stored) -> None:
    tubes = config_of(read_ross(stored("tapered"))).shaft.tubes
    steps = [tube for tube in tubes if 0.4 < tube.start + tube.length / 2 < 0.6]
    volume = sum(math.pi / 4 * (t.diameter**2 - t.inner_diameter**2) * t.length for t in steps)
    frustum = math.pi / 12 * 0.2 * ((0.04**2 + 0.04 * 0.06 + 0.06**2) - 0.02**2)
    assert volume == pytest.approx(frustum, rel=1e-9)  # outer and bore slope alike: the midpoints are exact


@pytest.mark.parametrize("omega", [100.0, 300.0])
def test_sleeves_as_disks_have_nearly_the_eigenvalues_ross_says(
    omega: float, stored: Stored, said: dict[str, Any]
) -> None:
    rig = config_of(read_ross(stored("sleeved")), keep_nodes=True)
    assert eigenvalues(rig, omega)[:4] == pytest.approx(said_eigenvalues(said, "sleeved", omega)[:4], rel=2e-3)
    nodes = sum(disk.mass for disk in rig.disks)
    shaft = 7810 * math.pi / 4 * 0.05**2 * 1.5
    assert nodes + shaft == pytest.approx(said["sleeved"]["mass"])


def test_alike_neighbours_become_one_section(stored: Stored) -> None:
    uniform = config_of(read_ross(stored("plain"))).shaft
    assert (uniform.sections, uniform.length, uniform.diameter) == ((), 1.5, 0.05)
    stepped = config_of(read_ross(stored("stepped"))).shaft
    assert [section.length for section in stepped.sections] == pytest.approx([0.6, 0.3, 0.1])
    assert [section.density for section in stepped.sections] == [None, 4430.0, None]  # the shaft's where not said
    assert (stepped.rayleigh.mass, stepped.rayleigh.stiffness) == (2.0, 1e-5)


def test_kept_nodes_are_sections(stored: Stored) -> None:
    assert len(config_of(read_ross(stored("stepped")), keep_nodes=True).shaft.sections) == 6


def test_tables_keep_their_values_and_constants_stay_numbers(stored: Stored) -> None:
    film = config_of(read_ross(stored("stepped"))).bearing("film")
    assert isinstance(film.kyx, OverSpeed)
    assert film.kyx.speed == pytest.approx((0.0, 100.0, 300.0))
    assert film.kyx.value == (0.0, -5e5, -9e5)
    assert film.cxy == 0.0
    assert config_of(read_ross(stored("stepped"))).bearing("ball").cyx == -20.0


def test_the_text_is_for_people(stored: Stored) -> None:
    text = config_text(read_ross(stored("stepped")), name="it", source="rotor.toml")
    assert text.startswith("# The rotor of rotor.toml, saved by ROSS 2.3.0.\n")
    assert "# Without its axial coefficients here, as the model is of lateral motion: 'ball'." in text
    assert 'length = "600 mm"' in text
    assert 'youngs_modulus = "211 GPa"' in text
    assert 'kxx.value = ["1000 kN/m", "2000 kN/m", "3000 kN/m"]' in text
    assert 'kxx.speed = ["0 rad/s", "100 rad/s", "300 rad/s"]' in text
    assert "[[bearings]] # node 3, SealElement as ROSS computed it" in text
    assert max(map(len, text.splitlines())) <= 120


def test_probes_stand_in_at_the_first_disk(stored: Stored) -> None:
    rig = config_of(read_ross(stored("plain")))
    assert [(p.name, p.position, p.angle) for p in rig.probes] == [
        ("x", 0.5, 0.0),
        ("y", 0.5, pytest.approx(math.pi / 2)),
    ]


def test_a_shaft_of_two_dampings_is_refused(stored: Stored) -> None:
    rotor = read_ross(stored("stepped"))
    other = dataclasses.replace(rotor.shaft[4], beta=3e-5)
    with pytest.raises(
        ConfigError, match="'Shaft Element 4': alpha and beta are 2 and 3e-05, want those of 'Shaft Elem"
    ):
        config_of(dataclasses.replace(rotor, shaft=(*rotor.shaft[:4], other, rotor.shaft[5])))


def test_a_rotor_without_a_disk_is_refused(stored: Stored) -> None:
    with pytest.raises(ConfigError, match=r"rotor\.toml: has no disk, want at least one"):
        config_of(dataclasses.replace(read_ross(stored("plain")), disks=()))
