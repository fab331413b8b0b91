"""A config is read whole and right, or refused in one sentence naming file, key, what was got and what is wanted."""

from pathlib import Path

import pytest

from rotorrig.rig.config.description import from_si, load, parse
from rotorrig.rig.errors import ConfigError

CONFIGS = sorted((Path(__file__).parents[3] / "configs").glob("*.toml"))
RK4 = (Path(__file__).parents[3] / "configs" / "rk4.toml").read_text()


@pytest.mark.parametrize("path", CONFIGS, ids=lambda p: p.stem)
def test_every_config_that_comes_along_is_valid(path: Path) -> None:
    assert load(path).probes


def test_rk4_holds_the_chapters_table_9() -> None:
    rig = parse(RK4, where="rk4.toml")
    assert rig.shaft.youngs_modulus == 208.11e9
    assert rig.disk("disk").polar_inertia == 568.46e-6
    assert rig.bearing("spring").kxx == 33900
    assert rig.bearing("spring").position - rig.bearing("left B").position == pytest.approx(0.401)
    unbalance = rig.disk("disk").unbalance
    assert unbalance is not None
    assert unbalance.amount == pytest.approx(15e-6)


def test_a_config_survives_the_way_through_a_file_of_ours() -> None:
    rig = parse(RK4, where="rk4.toml")
    again = from_si(rig.model_dump(mode="json"), text=rig.text)
    assert again.model_dump() == rig.model_dump()
    assert again.hash == rig.hash
    assert again.text == RK4


def test_the_usual_search_named_or_not_is_one_config() -> None:
    rig = parse(RK4, where="x")
    named, other = (
        parse(RK4.replace("[identify]", f"[identify]\nsearch = '{s}'"), where="x") for s in ("vector", "seed")
    )
    assert named.hash == rig.hash
    assert other.hash != rig.hash
    assert other.identify.search == "seed"


def test_the_hash_follows_values_and_not_layout() -> None:
    rig = parse(RK4, where="rk4.toml")
    assert parse("# a comment\n" + RK4.replace("10 mm", "0.01 m"), where="x").hash == rig.hash
    assert parse(RK4.replace("33.9 kN/m", "33.8 kN/m"), where="x").hash != rig.hash


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"33.9 kN/m"', '"33.9 kN"', "rk4.toml: bearings[2].kxx: got '33.9 kN' (kN), want a stiffness"),
        ('"33.9 kN/m"', "33.9", "bearings[2].kxx: got 33.9, want a stiffness with its unit, such as '33.9 kN/m'"),
        ('kxx = "33.9', 'kxxx = "33.9', "bearings[2].kxxx: unknown key, did you mean 'kxx'"),
        ("[keyphasor]", "[keyfasor]", "keyfasor: unknown key, did you mean 'keyphasor'"),
        ('density = "7801 kg/m^3"', "", "shaft.density: is missing"),
        ('"481 mm" #', '"581 mm" #', "bearings[2].position: 'spring' is at 581 mm, want it on the shaft, 0 to 560 mm"),
        ("channel = 4", "channel = 3", "channel 3: used by probe '2y' and the keyphasor, want one each"),
        ('start = "480 rpm"', 'start = "48 Hz"', "plans.default.start: got '48 Hz', want a shaft speed in rpm"),
        ('start = "480 rpm"', 'start = "200 rpm"', "plans.default: want slow_roll < start < end"),
        ('edge = "falling"', 'edge = "down"', "keyphasor.edge: got 'down'"),
        ("poisson_ratio = 0.3", "poisson_ratio = nan", "shaft.poisson_ratio: got nan"),
        ('bearings = ["spring"]', 'bearings = ["sprung"]', "identify.bearings: no bearing 'sprung'"),
        ('bearings = ["spring"]', 'bearings = [["left A"], ["sprung"]]', "identify.bearings: no bearing 'sprung'"),
        ('bearings = ["spring"]', 'bearings = [["spring"], ["spring"]]', "bearings: 'spring' stands there twice"),
        ('bearings = ["spring"]', "bearings = []", "identify.bearings: got [], value should have at least 1 item"),
        (
            'unbalance = "disk"',
            'unbalance = ["disk", "disc"]',
            "identify.unbalance: no disk 'disc', want one of ['disk']",
        ),
        ('unbalance = "disk"', 'unbalance = "disk"\nalso = ["E"]', "identify.also[0]: got 'E', input should be"),
        ('unbalance = "disk"', 'unbalance = "disk"\ncoefficients = "cross"', "identify.coefficients: got 'cross'"),
        ('["1 N s/m", "1e3', '["0 N s/m", "1e3', "c_bounds: the lower bound is zero, want more"),
        ('["0.1 g mm", "1e3', '["1e4 g mm", "1e3', "u_bounds: got 0.01 to 0.001 (SI), want the lower bound first"),
        ('overspeed = "4000 rpm"', 'overspeed = "5000 rpm"', "limits.overspeed: is above motor.max_speed"),
        ('name = "1y"', 'name = "1x"', "probes: two are named '1x'"),
        ("[shaft]", "[shaft", "is no valid TOML"),
    ],
)
def test_a_mistake_is_one_sentence(old: str, new: str, said: str) -> None:
    assert old in RK4
    with pytest.raises(ConfigError) as caught:
        parse(RK4.replace(old, new, 1), where="rk4.toml")
    assert said in str(caught.value)
    assert str(caught.value).startswith("rk4.toml: ")
    assert "\n" not in str(caught.value)


def test_bearings_to_identify_are_one_set_or_several_and_a_dump_of_them_comes_back() -> None:
    together = parse(RK4.replace('["spring"]', '["left A", "left B"]'), where="x")
    apart = parse(RK4.replace('["spring"]', '[["left A", "left B"], ["spring"]]\ncoefficients = "all"'), where="x")
    assert together.identify is not None
    assert apart.identify is not None
    assert together.identify.bearings == (("left A", "left B"),)
    assert apart.identify.bearings == (("left A", "left B"), ("spring",))
    assert together.identify.coefficient_names == ("kxx", "kyy", "cxx", "cyy")
    assert apart.identify.coefficient_names == ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
    assert apart.identify.kxy_bounds == (-1e6, 1e6)
    assert from_si(apart.model_dump(mode="json")).identify == apart.identify


def test_estimates_carry_their_bearing_or_disk_where_there_are_several() -> None:
    identify = parse(RK4, where="x").identify
    assert identify is not None
    assert identify.coefficient_of(("spring",), "kxx") == "kxx"
    assert identify.unbalance_of("disk", "phase") == "phase"
    several = identify.model_copy(update={"bearings": (("a", "b"), ("c",)), "unbalance": ("d", "e")})
    assert several.coefficient_of(("a", "b"), "kxx") == "a+b kxx"
    assert several.unbalance_of("e", "phase") == "phase e"


def test_bearings_without_a_span_are_refused() -> None:
    one_place = RK4.replace('"65 mm"', '"80 mm"').replace('"481 mm"', '"80 mm"')
    with pytest.raises(ConfigError, match="all are at 80 mm, want at least two with a span"):
        parse(one_place, where="rk4.toml")


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.toml: cannot be read"):
        load(tmp_path / "none.toml")


def test_a_binary_file_is_no_config(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigError, match="not UTF-8 text"):
        load(path)
