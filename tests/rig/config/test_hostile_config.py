"""A config may hold anything: each is read, or refused in one sentence and in time."""

import copy
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rotorrig.rig.config import ModbusTcp, RigConfig, load, parse, profile_names, read_toml, to_si, validate_table
from rotorrig.rig.config.description import from_si
from rotorrig.rig.config.units import QUANTITIES
from rotorrig.rig.errors import ConfigError

RK4 = (Path(__file__).parents[3] / "configs/rk4.toml").read_text()


def changed(old: str, new: str) -> str:
    assert old in RK4
    return RK4.replace(old, new, 1)


def test_a_byte_order_mark_is_no_part_of_a_config(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_bytes(b"\xef\xbb\xbf" + RK4.encode())
    rig = load(tmp_path / "rig.toml")
    assert (rig.hash, rig.text) == (parse(RK4, where="rk4.toml").hash, RK4)
    assert parse("\ufeff" + RK4, where="rk4.toml").hash == rig.hash


@pytest.mark.parametrize(
    "text",
    [
        ".".join(["a"] * 100_000) + " = 1",
        "[" + " . ".join(["a"] * 100_000) + "]",
        ".".join(['"a.b"'] * 50_000) + " = 1",
        ".".join(["'a'"] * 50_000) + " = 1",
        "\n".join(f"k{i}." + ".".join(["a"] * 98) + " = 1" for i in range(1000)),
        "x = " + "[" * 100_000,
        "x = " + "{a=" * 50_000,
        "a" * 4_000_000,
        '"' * 200_000,
        "a " * 100_000 + "= 1",
    ],
    ids=["dotted", "header", "quoted", "literal", "many", "lists", "tables", "long", "quotes", "words"],
)
def test_a_table_nested_too_deep_is_refused_in_time(text: str, tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(text)
    began = time.process_time()
    with pytest.raises(ConfigError):
        load(tmp_path / "rig.toml")
    assert time.process_time() - began < 5.0


def test_dots_in_text_are_no_nesting(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text(f'notes = "{"." * 500} {"a. " * 500}"\nx = [{"1.5, " * 500}]\n')
    assert len(read_toml(tmp_path / "x.toml", want="a table")[0]["x"]) == 500


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("number", ["1e308", "-1e308", "1" + "0" * 60, "1e31", "1e400"])
def test_a_number_that_nobody_means_is_refused(quantity: str, number: str) -> None:
    with pytest.raises(ValueError, match=r"^got .*, want "):
        to_si(f"{number} {QUANTITIES[quantity][0]}", quantity)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_next_to_nothing_is_nothing(quantity: str) -> None:
    assert to_si(f"1e-300 {QUANTITIES[quantity][0]}", quantity) == 0.0


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_what_is_no_number_is_not_taken_for_nothing(value: float) -> None:
    table = copy.deepcopy(SI)
    table["probes"][0]["angle"] = value
    with pytest.raises(ConfigError, match=r"probes\[0\]\.angle: got"):
        from_si(table)


@pytest.mark.parametrize("profile", [name for name in profile_names() if name != "vfd-ed"])
def test_a_drive_is_not_asked_for_a_frequency_its_register_does_not_hold(profile: str) -> None:
    table = {"driver": "modbus-tcp", "host": "x", "profile": profile, "max_speed": "4200 rpm", "rpm_per_hz": 0.25}
    with pytest.raises(ConfigError, match=rf"max_speed is 1.68e\+04 Hz at .*, want at most .* of a {profile}"):
        validate_table(ModbusTcp, table, where="rig.toml: motor")
    validate_table(ModbusTcp, table | {"rpm_per_hz": 30.0}, where="rig.toml: motor")


@pytest.mark.parametrize("name", ["keyphasor", "Keyphasor", "time", ".", "..", "...", "", "a/b", "x\n", "x" * 61])
def test_a_probe_is_not_called_what_something_else_is(name: str) -> None:
    table = tomllib.loads(RK4)
    table["probes"][0]["name"] = name
    with pytest.raises(ConfigError, match=r"probes\[0\]\.name: "):
        validate_table(RigConfig, table, where="rig.toml")


CONTROLS = ["\x1b[2J", "\x1b]0;owned\x07", "\n", "\r", "\t", "\0", "\x7f", "\u202e", "\u2028", "\u200b", "\x9b2J"]


def names(table: dict[str, Any]) -> Iterator[tuple[Any, Any]]:
    """Yield every place of a name: its table and its key."""
    yield table, "name"
    for kind in ("disks", "bearings"):
        yield table[kind][0], "name"
    yield table["motor"], "port"
    yield table["daq"], "port"


@pytest.mark.parametrize("control", CONTROLS, ids=ascii)
def test_no_name_holds_what_a_terminal_obeys(control: str) -> None:
    for number in range(5):
        table = tomllib.loads(RK4)
        place, key = list(names(table))[number]
        place[key] = f"x{control}y"
        with pytest.raises(ConfigError, match=r"name|port") as caught:
            validate_table(RigConfig, table, where="rig.toml")
        assert str(caught.value).isprintable()
    for kind in ("plans", "identify.bands"):
        table = tomllib.loads(RK4)
        place = table["plans"] if kind == "plans" else table["identify"]["bands"]
        place[f"x{control}y"] = next(iter(place.values()))
        with pytest.raises(ConfigError):
            validate_table(RigConfig, table, where="rig.toml")


def test_notes_may_have_lines_and_no_escape_sequences() -> None:
    table = tomllib.loads(RK4) | {"notes": "one\n\ttwo\r\n"}
    assert validate_table(RigConfig, table, where="x").notes == table["notes"]
    with pytest.raises(ConfigError, match=r"notes: has the control character U\+001B"):
        validate_table(RigConfig, table | {"notes": "\x1b[2J"}, where="x")


@pytest.mark.campaign
def test_a_list_of_a_hundred_thousand_is_refused_in_time() -> None:
    table = tomllib.loads(RK4)
    table["disks"] *= 100_000
    began = time.process_time()
    with pytest.raises(ConfigError, match=r"disks: .*at most 256"):
        validate_table(RigConfig, table, where="rig.toml")
    assert time.process_time() - began < 20.0


@pytest.mark.parametrize("word", ["x" * 200_000, "driver" * 40_000])
def test_a_long_word_is_compared_in_time(word: str) -> None:
    for old, new in (("[motor]", f"[motor]\n{word} = 1"), ('"modbus-rtu"', f'"{word}"')):
        began = time.process_time()
        with pytest.raises(ConfigError) as caught:
            parse(changed(old, new), where="rig.toml")
        assert time.process_time() - began < 5.0
        assert len(str(caught.value)) < 1100


def leaves(node: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in items:
        yield from leaves(value, (*at, key))
    if not isinstance(node, dict | list):
        yield at


TABLE = tomllib.loads(RK4)
SI = parse(RK4, where="rk4.toml").model_dump(mode="json")
NUMBERS = st.one_of(
    st.floats(), st.integers(), st.sampled_from([10**400, -(10**400), 1e308, -1e308, 5e-324, 2**31, 2**63, 0, 0.25])
)
ANYTHING = st.one_of(
    st.text(),
    NUMBERS,
    st.booleans(),
    st.none(),
    st.lists(st.integers(), max_size=3),
    st.dictionaries(st.text(max_size=5), st.integers(), max_size=3),
    st.builds("{} {}".format, NUMBERS, st.sampled_from([unit for unit, *_ in QUANTITIES.values()])),
)


@settings(max_examples=300, deadline=None)
@given(data=st.data(), value=ANYTHING, stored=st.booleans())
def test_whatever_stands_at_a_key_is_read_or_refused_in_a_sentence(
    data: st.DataObject, value: object, stored: bool
) -> None:
    table = copy.deepcopy(SI if stored else TABLE)
    at = data.draw(st.sampled_from(sorted(leaves(table), key=str)))
    node = table
    for key in at[:-1]:
        node = node[key]
    node[at[-1]] = value
    try:
        rig = from_si(table) if stored else validate_table(RigConfig, table, where="rig.toml")
    except ConfigError as error:
        assert str(error).isprintable()
        assert len(str(error)) < 1100
    else:
        assert from_si(rig.model_dump(mode="json")).hash == rig.hash
