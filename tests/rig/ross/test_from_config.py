"""A config as a rotor of ROSS: the same numbers on the nodes given, or a refusal."""

from pathlib import Path

import pytest

from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.nameplate import COEFFICIENTS
from rotorrig.rig.errors import ConfigError
from rotorrig.rig.ross.from_config import ross_rotor
from rotorrig.rig.ross.reading import read_ross
from rotorrig.rig.ross.to_config import config_text
from rotorrig.rig.ross.writing import ross_text

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()
SHAFT = 'length = "560 mm"\ndiameter = "10 mm"\n'
LEFT_A = 'kxx = "2.0e6 N/m" # assumed\nkyy = "2.0e6 N/m"\n'
STEPS = """
[[shaft.sections]]
length = "260 mm"
diameter = "12 mm"
inner_diameter = "4 mm"

[[shaft.sections]]
length = "300 mm"
diameter = "10 mm"
density = "2700 kg/m^3"
youngs_modulus = "70 GPa"
poisson_ratio = 0.33
"""
NODES = [0.0, 0.065, 0.08, 0.2505, 0.26, 0.2805, 0.3805, 0.481, 0.56]


def changed(*changes: tuple[str, str]) -> RigConfig:
    text = RK4
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return parse(text, where="changed rk4.toml")


def stepped() -> RigConfig:
    return changed((SHAFT, ""), ("poisson_ratio = 0.3\n", "poisson_ratio = 0.3\n" + STEPS))


def test_parts_sit_on_their_nodes(rig_config: RigConfig) -> None:
    rotor = ross_rotor(rig_config, nodes=NODES)
    assert rotor.nodes == pytest.approx(NODES, abs=1e-12)
    assert [(part.tag, rotor.nodes[part.n]) for part in (*rotor.disks, *rotor.bearings)] == [
        ("disk", 0.2805),
        ("left A", 0.065),
        ("left B", 0.08),
        ("spring", 0.481),
    ]
    assert rotor.bearings[2].coefficients["kyy"] == (34600.0,)
    assert rotor.disks[0].polar_inertia == 568.46e-6


def test_elements_have_the_section_they_lie_in() -> None:
    rotor = ross_rotor(stepped(), nodes=NODES)
    assert [element.outer for element in rotor.shaft] == [(0.012, 0.012)] * 4 + [(0.01, 0.01)] * 4
    assert [element.inner for element in rotor.shaft] == [(0.004, 0.004)] * 4 + [(0.0, 0.0)] * 4
    assert rotor.shaft[3].material == pytest.approx((7801.0, 208.11e9, 208.11e9 / 2.6))
    assert rotor.shaft[4].material == pytest.approx((2700.0, 70e9, 70e9 / 2.66))


def test_tables_are_put_on_one_list_of_speeds() -> None:
    stiffness = 'kxx = { speed = ["0 rad/s", "200 rad/s"], value = ["30 kN/m", "40 kN/m"] }\nkyy = "34.6 kN/m"'
    damping = 'cxx = { speed = ["100 rad/s", "300 rad/s"], value = ["10 N s/m", "30 N s/m"] }'
    rotor = ross_rotor(changed((LEFT_A, f"{stiffness}\n{damping}\n")), nodes=NODES)
    assert rotor.notes[-1].endswith("a curve in ROSS, of four speeds or more a smoothed one: 'left A'.")
    left = rotor.bearings[0]
    assert left.frequency == pytest.approx((0.0, 100.0, 200.0, 300.0))
    assert left.coefficients["kxx"] == pytest.approx((30e3, 35e3, 40e3, 40e3))  # held beyond its ends
    assert left.coefficients["cxx"] == pytest.approx((10.0, 10.0, 20.0, 30.0))
    assert left.coefficients["kyy"] == (34600.0,) * 4


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        (LEFT_A, "rigid = true\n", "bearing 'left A': is rigid, want kxx and kyy"),
        (LEFT_A, LEFT_A + 'tilt_stiffness = "3 N m/rad"\n', "bearing 'left A': has a tilt_stiffness, want none"),
        (
            "poisson_ratio = 0.3\n",
            "poisson_ratio = 0.3\nstructural_damping = 0.01\n",
            "shaft.structural_damping: got 0.01, want 0",
        ),
        ("\n[shaft]", '\nrotation = "y-to-x"\n[shaft]', "rotation: got 'y-to-x', want 'x-to-y'"),
    ],
)
def test_what_ross_has_not_is_refused(old: str, new: str, wanted: str) -> None:
    with pytest.raises(ConfigError) as refused:
        ross_rotor(changed((old, new)), nodes=NODES)
    assert wanted in str(refused.value)


def test_what_has_no_place_in_the_file_is_said(rig_config: RigConfig) -> None:
    (note,) = ross_rotor(rig_config, nodes=NODES).notes
    for word in ("[[probes]]", "unbalance of 'disk'", "[keyphasor]", "[motor]", "[daq]", "[limits]", "[identify]"):
        assert word in note


@pytest.mark.parametrize("rig", [changed(), stepped()], ids=["uniform", "stepped"])
def test_to_ross_and_back_is_the_same_config(rig: RigConfig, tmp_path: Path) -> None:
    file = tmp_path / "rotor.toml"
    file.write_text(ross_text(ross_rotor(rig, nodes=NODES), source="a test"))
    again = parse(config_text(read_ross(file), name="again", source="rotor.toml"), where="again")
    same_rotor(rig, again)


def same_rotor(rig: RigConfig, again: RigConfig) -> None:
    assert len(rig.shaft.tubes) == len(again.shaft.tubes)
    for here, there in zip(rig.shaft.tubes, again.shaft.tubes, strict=True):
        for name in ("start", "length", "diameter", "inner_diameter", "density", "youngs_modulus", "poisson_ratio"):
            assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-11, abs=1e-12), name
    for d, e in zip(rig.disks, again.disks, strict=True):
        assert (e.name, e.position) == (d.name, pytest.approx(d.position, abs=1e-12))
        assert (e.mass, e.polar_inertia, e.transverse_inertia) == (d.mass, d.polar_inertia, d.transverse_inertia)
    for b, c in zip(rig.bearings, again.bearings, strict=True):
        assert (c.name, c.position) == (b.name, pytest.approx(b.position, abs=1e-12))
        assert [c.constant(name) for name in COEFFICIENTS] == [b.constant(name) for name in COEFFICIENTS]
