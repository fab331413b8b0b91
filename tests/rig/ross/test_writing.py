"""What is written is what was meant: read back it is the same rotor, to the last digit."""

import dataclasses
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.reading import read_ross
from rotorrig.rig.ross.rotor import RossRotor
from rotorrig.rig.ross.writing import ross_text


def replaced_tag(rotor: RossRotor, tag: str) -> RossRotor:
    return dataclasses.replace(rotor, disks=(dataclasses.replace(rotor.disks[0], tag=tag), *rotor.disks[1:]))


@pytest.mark.parametrize("name", ["plain", "stepped", "tapered"])
def test_a_rotor_written_and_read_is_the_same(name: str, stored: Callable[[str], Path], tmp_path: Path) -> None:
    rotor = read_ross(stored(name))
    file = tmp_path / "again.toml"
    bearings = tuple(dataclasses.replace(b, kind="BearingElement") for b in rotor.bearings)  # a seal's class is lost
    file.write_text(ross_text(rotor, source="a test"))
    again = read_ross(file)
    assert (again.shaft, again.disks, again.bearings) == (rotor.shaft, rotor.disks, bearings)


def test_a_tag_may_hold_any_character(stored: Callable[[str], Path], tmp_path: Path) -> None:
    tag = 'Läufer "A" \\ 2.5'
    file = tmp_path / "again.toml"
    file.write_text(ross_text(replaced_tag(read_ross(stored("plain")), tag), source="a test"), encoding="utf-8")
    assert read_ross(file).disks[0].tag == tag


def test_the_file_has_what_ross_asks_for(stored: Callable[[str], Path]) -> None:
    text = ross_text(read_ross(stored("plain")), source="plain.toml")
    assert text.startswith("# The rotor of plain.toml, for Rotor.load of ROSS 2.3.0.\n")
    table = tomllib.loads(text)
    assert (table["ross_version"], table["parameters"]) == ("2.3.0", {})
    material = table["ShaftElement_Shaft Element 0"]["material"]
    assert " " not in material["name"]  # ROSS allows none
    assert {"rho", "E", "G_s"} < material.keys()


def test_two_parts_of_one_name_are_refused(stored: Callable[[str], Path]) -> None:
    with pytest.raises(ConfigError, match="two parts are named 'Bearing 0', want different names"):
        ross_text(replaced_tag(read_ross(stored("plain")), "Bearing 0"), source="a test")
