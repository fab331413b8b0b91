"""Files of ROSS read back to the numbers they were made of (tests/data/ross/make.py), or refused by name."""

import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.reading import read_ross

Stored = Callable[[str], Path]


def test_the_shaft_is_read_from_left_to_right(stored: Stored, said: dict[str, Any]) -> None:
    rotor = read_ross(stored("stepped"))
    assert rotor.nodes == pytest.approx(said["stepped"]["nodes"], abs=1e-12)
    assert [element.outer[0] for element in rotor.shaft] == [0.05, 0.05, 0.05, 0.06, 0.06, 0.04]
    assert [element.inner[0] for element in rotor.shaft] == [0, 0, 0, 0.02, 0.02, 0.01]
    assert rotor.shaft[3].material == pytest.approx((4430, 113.8e9, 113.8e9 / 2 / 1.342))
    assert rotor.shaft[3].material.poisson_ratio == pytest.approx(0.342)
    assert (rotor.shaft[0].alpha, rotor.shaft[0].beta) == (2.0, 1e-5)
    assert rotor.version == "2.3.0"


def test_a_disk_has_the_inertias_of_its_geometry(stored: Stored) -> None:
    wheel = read_ross(stored("stepped")).disks[0]
    mass = 7810 * 0.05 * math.pi / 4 * (0.3**2 - 0.05**2)
    assert (wheel.tag, wheel.n) == ("wheel", 2)
    assert wheel.mass == pytest.approx(mass)
    assert wheel.polar_inertia == pytest.approx(mass * (0.3**2 + 0.05**2) / 8)
    assert wheel.transverse_inertia == pytest.approx(mass * ((0.3**2 + 0.05**2) / 16 + 0.05**2 / 12))


def test_a_bearing_keeps_its_coefficients_over_speed(stored: Stored) -> None:
    film, seal, ball = read_ross(stored("stepped")).bearings
    assert film.frequency == (0.0, 100.0, 300.0)
    assert film.coefficients["kyx"] == (0.0, -5e5, -9e5)
    assert film.coefficients["cyy"] == (1000.0, 900.0, 700.0)  # ROSS takes cxx where cyy is not given
    assert (seal.kind, seal.coefficients["kxy"]) == ("SealElement", (5e3,))
    assert (ball.n, ball.coefficients["cxy"], ball.frequency) == (5, (20.0,), ())


def test_what_is_left_out_or_changed_is_said(stored: Stored) -> None:
    assert read_ross(stored("stepped")).notes == (
        "Coefficients over speed are joined by straight lines here, by a curve in ROSS: 'film'.",
        "Without its axial coefficients here, as the model is of lateral motion: 'ball'.",
    )
    (tapered,) = read_ross(stored("tapered")).notes
    assert tapered == "Tapered in ROSS, in uniform steps here, so that figures differ slightly: 'Shaft Element 2'."
    (sleeves,) = read_ross(stored("sleeved")).notes
    assert (
        sleeves
        == "Without stiffness of its own, so disks at the nodes here: "
        + ", ".join(f"'sleeve {n}'" for n in range(6, 12))
        + "."
    )
    assert read_ross(stored("plain")).notes == ()


def test_a_sleeve_is_half_a_disk_at_either_end(stored: Stored) -> None:
    rotor = read_ross(stored("sleeved"))
    assert len(rotor.shaft) == 18
    assert [element.outer for element in rotor.shaft] == [(0.05, 0.05)] * 18
    disks = rotor.disks[1:]
    ring = 7800 * 0.05 * math.pi / 4 * (0.12**2 - 0.05**2)
    assert [disk.n for disk in disks] == [6, 7, 8, 9, 10, 11, 12]
    assert [disk.mass for disk in disks] == pytest.approx([ring / 2, *[ring] * 5, ring / 2])
    assert disks[1].polar_inertia == pytest.approx(ring * (0.12**2 + 0.05**2) / 8)
    assert disks[1].transverse_inertia == pytest.approx(disks[1].polar_inertia / 2)


def test_a_point_mass_is_a_disk_without_inertia(stored: Stored, tmp_path: Path) -> None:
    file = tmp_path / "rotor.toml"
    file.write_text(stored("plain").read_text() + "[PointMass_coupling]\nn = 6\nmx = 2.5\nmy = 2.5\n")
    coupling = read_ross(file).disks[-1]
    assert (coupling.tag, coupling.n, coupling.mass, coupling.polar_inertia) == ("coupling", 6, 2.5, 0.0)


def test_json_is_read_as_toml_is(stored: Stored, tmp_path: Path) -> None:
    file = tmp_path / "rotor.json"
    file.write_text(json.dumps({"_note": "by ROSS", **tomllib.loads(stored("stepped").read_text())}))
    assert read_ross(file) == read_ross(stored("stepped"))


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        ("axial_force = 0", "axial_force = 500.0", "ShaftElement 'Shaft Element 0': axial_force is 500, want 0"),
        ("torque = 0", "torque = 3.0", "'Shaft Element 0': torque is 3, want 0"),
        ("shear_effects = true", "shear_effects = false", "'Shaft Element 0': shear_effects is false, want it true"),
        ("gyroscopic = true", "gyroscopic = false", "gyroscopic is false, want it true"),
        ("L = 0.25", 'L = "long"', "'Shaft Element 0': L: got 'long', want a number"),
        ("L = 0.25\n", "", "L: is missing, want a number"),
        ("n = 0\naxial", 'n = "np.int64(0)"\naxial', "n: got 'np.int64(0)', want the number of a node"),
        (
            "n = 1\naxial",
            "n = 0\naxial",
            "'Shaft Element 0' and 'Shaft Element 1' both start at node 0 and are both stiff",
        ),
        ("n = 2\naxial", "n = 7\naxial", "no shaft element starts at node 2"),
        ("n = 4\nm =", "n = 9\nm =", "'Disk 4' is at node 9, want it on the shaft, node 0 to 6"),
        ("n = 6\nscale_factor", "n = 6\nn_link = 7\nscale_factor", "BearingElement 'Bearing 1': stands on node 7"),
        ("mxx = [ 0,]", "mxx = [ 2.5,]", "'Bearing 0': mxx is 2.5 kg, want 0"),
        ("kxx = [ 1000000.0,]", "kxx = [ 1e6, 2e6,]", "'Bearing 0': kxx has 2 values, want 1"),
        ("kxx = [ 1000000.0,]", "kxx = [ true,]", "'Bearing 0': kxx: got [True], want a list of numbers"),
        ("[parameters]", "[PointMass_pm]\nn = 0\nmx = 2\nmy = 1\n[parameters]", "PointMass 'pm': mx is 2 and my 1 kg"),
        ("kxx = [ 1000000.0,]", "kxx = [ -2.0,]", "BearingElement 'Bearing 0': kxx is -2, want it at or above zero"),
        ("cxx = [ 1000.0,]", "cxx = [ nan,]", "BearingElement 'Bearing 0': cxx: got [nan], want a list of numbers"),
        ("G_s = 81200000000.0", "G_s = 0", "'Shaft Element 0' material: G_s is 0 Pa, want it above zero"),
        ("[parameters]", "[GearElement_g]\nn = 0\n[parameters]", "GearElement 'g': has no counterpart here"),
        ('ross_version = "2.3.0"', "", "has no ross_version"),
        ("[parameters]", "[parameters", "is no valid toml"),
    ],
)
def test_what_cannot_be_represented_is_refused_by_name(
    old: str, new: str, wanted: str, stored: Stored, tmp_path: Path
) -> None:
    text = stored("plain").read_text()
    assert old in text
    file = tmp_path / "rotor.toml"
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError) as refused:
        read_ross(file)
    assert wanted in str(refused.value)
    assert str(refused.value).startswith(str(file))


def test_a_bearing_without_lateral_coefficients_is_left_out(stored: Stored, tmp_path: Path) -> None:
    thrust = "[ThrustPad_thrust]\nn = 3\nkxx = [ 0,]\ncxx = [ 0,]\nkzz = [ 1e8,]\n"
    file = tmp_path / "rotor.toml"
    file.write_text(stored("plain").read_text() + thrust)
    rotor = read_ross(file)
    assert [bearing.tag for bearing in rotor.bearings] == ["Bearing 0", "Bearing 1"]
    assert rotor.notes == ("Left out, as without any lateral coefficient: 'thrust'.",)


def test_a_file_that_is_not_there_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.toml: cannot be read \(No such file"):
        read_ross(tmp_path / "none.toml")
