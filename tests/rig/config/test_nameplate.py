"""Stepped and damped shafts, bearings over speed and rigid ones, as text and as numbers."""

import math
from pathlib import Path

import pytest

from rotorrig.rig.config.description import RigConfig, from_si, parse
from rotorrig.rig.config.nameplate import OverSpeed
from rotorrig.rig.errors import ConfigError

RK4 = (Path(__file__).parents[3] / "configs" / "rk4.toml").read_text()
SPRING = 'kxx = "33.9 kN/m"\nkyy = "34.6 kN/m"\ncxx = "15 N s/m" # assumed\ncyy = "15 N s/m"\n'
UNIFORM = 'length = "560 mm"\ndiameter = "10 mm"\n'
TABLE = '{ speed = ["0 rpm", "3000 rpm"], value = ["30 kN/m", "35 kN/m"] }'
STEPS = """
[[shaft.sections]]
length = "300 mm"
diameter = "10 mm"
[[shaft.sections]]
length = "260 mm"
diameter = "12 mm"
inner_diameter = "4 mm"
density = "2700 kg/m^3"
youngs_modulus = "70 GPa"
poisson_ratio = 0.0
"""


def rk4(*, shaft: str = UNIFORM, more: str = "", spring: str = SPRING, end: str = "") -> str:
    """Return the RK4's config with another shaft, spring bearing or parts, and the left bearings to identify."""
    text = RK4
    for old, new in (
        (UNIFORM, shaft),
        ("poisson_ratio = 0.3\n", "poisson_ratio = 0.3\n" + more),
        (SPRING, spring),
        ('bearings = ["spring"]', 'bearings = ["left A"]'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    return text + end


def config(**changes: str) -> RigConfig:
    return parse(rk4(**changes), where="rk4.toml")


def test_sections_say_the_shafts_length_and_largest_diameter() -> None:
    shaft = config(shaft="", more=STEPS).shaft
    assert shaft.length == pytest.approx(0.56)
    assert shaft.diameter == 0.012
    first, second = shaft.tubes
    assert (first.start, first.end, first.diameter, first.inner_diameter) == (0, 0.3, 0.01, 0)
    assert (first.density, first.youngs_modulus, first.poisson_ratio) == (7801, 208.11e9, 0.3)  # the shaft's
    assert (second.start, second.end) == (0.3, pytest.approx(0.56))
    assert (second.density, second.youngs_modulus, second.poisson_ratio) == (2700, 70e9, 0)


def test_a_uniform_shaft_is_one_tube() -> None:
    (tube,) = config().shaft.tubes
    assert (tube.start, tube.length, tube.diameter, tube.density) == (0, 0.56, 0.01, 7801)


def test_a_length_that_agrees_with_the_sections_is_welcome() -> None:
    assert config(shaft='length = "560 mm"\n', more=STEPS).shaft.length == 0.56


def test_shaft_damping_is_read_with_units() -> None:
    shaft = config(more='rayleigh = { mass = "0.1 1/s", stiffness = "10 us" }\nstructural_damping = 0.002\n').shaft
    assert shaft.rayleigh.mass == 0.1
    assert shaft.rayleigh.stiffness == pytest.approx(1e-5)
    assert shaft.structural_damping == 0.002


def test_a_coefficient_may_be_a_table_over_speed() -> None:
    bearing = config(spring=f'kxx = {TABLE}\nkyy = "34.6 kN/m"\n').bearing("spring")
    assert isinstance(bearing.kxx, OverSpeed)
    assert bearing.kxx.speed == (0, pytest.approx(100 * math.pi))
    assert bearing.kxx.value == (30e3, 35e3)
    assert bearing.over_speed
    assert bearing.constant("kyy") == 34.6e3


def test_a_rigid_bearing_needs_no_coefficients() -> None:
    bearing = config(spring="rigid = true\n").bearing("spring")
    assert bearing.rigid
    assert not bearing.over_speed


def test_a_plane_may_stand_anywhere_on_the_shaft() -> None:
    rig = config(end='\n[[planes]]\nname = "coupling"\nposition = "5 mm"\n')
    assert rig.planes[0].position == 0.005


@pytest.mark.parametrize(
    "changes",
    [
        {"shaft": "", "more": STEPS},
        {"spring": f'kxx = {TABLE}\nkyy = "34.6 kN/m"\n'},
        {"spring": "rigid = true\n"},
        {"more": 'rayleigh = { mass = "0.1 1/s" }\nstructural_damping = 0.002\n'},
    ],
    ids=["sections", "table", "rigid", "damping"],
)
def test_it_survives_the_way_through_a_file_of_ours(changes: dict[str, str]) -> None:
    rig = config(**changes)
    again = from_si(rig.model_dump(mode="json"))
    assert again.hash == rig.hash
    assert again.hash != config().hash


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"shaft": ""}, "shaft: length is missing, want it, or the shaft in sections"),
        (
            {"more": STEPS},
            "shaft: diameter 10 mm, but the sections' largest is 12 mm; want it to agree or be left out",
        ),
        (
            {"shaft": 'length = "561 mm"\n', "more": STEPS},
            "shaft: length 561 mm, but the sections' sum is 560 mm; want it to agree or be left out",
        ),
        (
            {"shaft": 'inner_diameter = "2 mm"\n', "more": STEPS},
            "shaft: inner_diameter stands beside sections, want it in each section that is hollow",
        ),
        (
            {"shaft": "", "more": STEPS.replace('"4 mm"', '"14 mm"')},
            "shaft.sections[1]: inner_diameter 14 mm, want less than the 12 mm diameter",
        ),
        (
            {"shaft": "", "more": STEPS.replace('"260 mm"', '"0 mm"')},
            "shaft.sections[1].length: got '0 mm', input should be greater than 0",
        ),
        (
            {"shaft": "", "more": STEPS.replace('"260 mm"', '"0.5 um"')},
            "shaft.sections[1]: length 0.5 um, want more than 1 um",
        ),
        ({"more": 'rayleigh = { mass = "0.1 s" }\n'}, "shaft.rayleigh.mass: got '0.1 s' (s), want a damping rate"),
        ({"more": "structural_damping = -0.1\n"}, "shaft.structural_damping: got -0.1"),
        ({"spring": ""}, "bearings[2]: 'spring' has no kxx, want a stiffness such as '33.9 kN/m', or rigid = true"),
        ({"spring": f"rigid = true\n{SPRING}"}, "bearings[2]: 'spring' is rigid and has kxx, want one or the other"),
        ({"spring": SPRING.replace('"33.9', '"-33.9')}, "bearings[2].kxx: got '-33.9 kN/m', input should be greater"),
        ({"spring": SPRING.replace('"33.9', '"nan')}, "bearings[2].kxx: got 'nan kN/m', want a stiffness"),
        (
            {"spring": f'kxx = {TABLE.replace("35 kN/m", "35 kN")}\nkyy = "1 N/m"\n'},
            "bearings[2].kxx.value[1]: got '35 kN' (kN), want a stiffness",
        ),
        (
            {"spring": f'kxx = {TABLE.replace("35 kN/m", "-35 kN/m")}\nkyy = "1 N/m"\n'},
            "bearings[2].kxx.value[1]: got '-35 kN/m', input should be greater",
        ),
        (
            {"spring": f'kxx = {TABLE.replace(", " + chr(34) + "35 kN/m" + chr(34), "")}\nkyy = "1 N/m"\n'},
            "bearings[2].kxx: 2 speeds and 1 values, want one value for every speed",
        ),
        (
            {"spring": f'kxx = {TABLE.replace("3000 rpm", "0 rpm")}\nkyy = "1 N/m"\n'},
            "bearings[2].kxx: the speeds do not rise from each to the next, want them in order",
        ),
        (
            {"spring": f'kxx = {TABLE.replace("speed", "speeds")}\nkyy = "1 N/m"\n'},
            "bearings[2].kxx.speeds: unknown key, did you mean 'speed'",
        ),
        (
            {"end": '\n[[planes]]\nname = "ring"\nposition = "561 mm"\n'},
            "planes[0].position: 'ring' is at 561 mm, want it on the shaft, 0 to 560 mm",
        ),
        (
            {"end": '\n[[planes]]\nname = "disk"\nposition = "5 mm"\n'},
            "planes: 'disk' is a disk too, want another name; a disk is a plane already",
        ),
    ],
)
def test_a_mistake_is_one_sentence(changes: dict[str, str], said: str) -> None:
    with pytest.raises(ConfigError) as caught:
        config(**changes)
    assert str(caught.value).startswith(f"rk4.toml: {said}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("spring", "said"),
    [
        ("rigid = true\n", "identify.bearings: 'spring' is rigid, want a bearing of constant coefficients"),
        (f'kxx = {TABLE}\nkyy = "1 N/m"\n', "identify.bearings: 'spring' is given over speed, want a bearing of"),
    ],
)
def test_only_constants_can_be_identified(spring: str, said: str) -> None:
    text = rk4(spring=spring).replace('bearings = ["left A"]', 'bearings = ["spring"]')
    with pytest.raises(ConfigError) as caught:
        parse(text, where="rk4.toml")
    assert said in str(caught.value)


def test_asking_for_a_constant_that_is_none_is_one_sentence() -> None:
    with pytest.raises(ConfigError, match="bearing 'spring': is rigid, want kxx and the other coefficients"):
        config(spring="rigid = true\n").bearing("spring").constant("kxx")
    with pytest.raises(ConfigError, match="bearing 'spring': kxx depends on speed, want a constant"):
        config(spring=f'kxx = {TABLE}\nkyy = "1 N/m"\n').bearing("spring").constant("kxx")


def test_the_examples_of_the_manual_are_valid() -> None:
    manual = (Path(__file__).parents[3] / "docs" / "your-rig.md").read_text()
    blocks = [block.split("```")[0] for block in manual.split("```toml\n")[1:]]
    shaft, bearings = (next(b for b in blocks if b.startswith(table)) for table in ("[shaft]", "[[bearings]]"))
    parts = (
        RK4[RK4.index("[[disks]]") : RK4.index("[[bearings]]")] + RK4[RK4.index("[[probes]]") : RK4.index("[motor]")]
    )
    rig = parse('name = "example"\n' + shaft + bearings + parts, where="your-rig.md")
    assert [tube.density for tube in rig.shaft.tubes] == [7801, 2700]
    assert [bearing.over_speed for bearing in rig.bearings] == [True, False]


PRIOR = 'runout = "4 um"'


def test_how_far_the_nameplate_may_be_off_is_read_with_its_units() -> None:
    text = RK4.replace(
        PRIOR, 'position = "0.5 mm"\ndiameter = "0.1 %"\nhub = "40 %"\ntilt = "20 N m/rad"\nbearing = 0.1'
    )
    text = text.replace(SPRING, SPRING + 'tilt_stiffness = "3 N m/rad"\n').replace(
        'mass = "0.8', 'hub_width = "18 mm"\nmass = "0.8'
    )
    rig = parse(text, where="x")
    assert (rig.prior.position, rig.prior.diameter, rig.prior.hub, rig.prior.bearing) == (0.5e-3, 0.001, 0.4, 0.1)
    assert rig.tilt_prior("spring") == rig.tilt_prior("left A") == 20.0
    assert (rig.bearing("spring").tilt_stiffness, rig.bearing("left A").tilt_stiffness) == (3.0, 0.0)
    assert rig.hub_width("disk") == 0.018
    assert from_si(rig.model_dump(mode="json")).hash == rig.hash


def test_what_a_config_does_not_say_of_that_leaves_it_the_hash_it_had() -> None:
    rig = parse(RK4, where="x")
    assert (rig.prior.position, rig.prior.diameter, rig.prior.hub) == (1e-3, 0.002, 0.5)
    assert rig.hub_width("disk") == pytest.approx(0.025)  # 2.5 shaft diameters
    assert rig.tilt_prior("spring") == pytest.approx(0.01 * 208.11e9 * math.pi / 64 * 0.01**3)  # 1 % of E I / d
    assert rig.hash == "ad71dc66cb73566f"  # as before there were such keys
    assert parse(RK4.replace(PRIOR, PRIOR + '\nposition = "1 mm"'), where="x").hash == rig.hash
    assert parse(RK4.replace(PRIOR, PRIOR + '\nposition = "2 mm"'), where="x").hash != rig.hash


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ('position = "1 kg"', "prior.position: got '1 kg' (kg), want a length"),
        ("position = 0.001", "prior.position: got 0.001, want a length with its unit"),
        ('diameter = "0.2 mm"', "prior.diameter: got '0.2 mm', want a number such as 0.002, or text in per cent"),
        ('hub = "120 %"', "prior.hub"),
        ('tilt = "5 N/m"', "prior.tilt: got '5 N/m' (N/m), want a tilt stiffness"),
    ],
)
def test_what_makes_no_sense_of_it_is_refused(key: str, said: str) -> None:
    with pytest.raises(ConfigError) as error:
        parse(RK4.replace(PRIOR, key), where="x")
    assert said in str(error.value)
