"""The reference is that of the code: generated pages are current, and hand-written ones leave nothing out."""

import re
from functools import cache

import pytest

from docs.config_reference import default_of, taken_by
from docs.make_docs import DOCS, pages
from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.devices import ModbusRtu
from rotorrig.rig.config.drive_profiles import profile_names
from rotorrig.rig.config.nameplate import Disk, Probe
from rotorrig.rig.config.validation import validate_table
from tests.documents.pages import blocks, text_of

GENERATED = (
    *("api.md", "chea.md", "chea-choices.md", "chea-table7.md", "cli.md", "config.md", "effects.md", "lab.md"),
    "plant.md",
)
#: keys whose name says all, in a table that says whose they are
PLAIN = {"density", "youngs_modulus", "mass"}


@cache
def generated() -> dict[str, str]:
    return pages()


def test_every_generated_page_is_compared() -> None:
    assert set(generated()) == set(GENERATED)


@pytest.mark.parametrize("name", GENERATED)
def test_a_generated_page_is_that_of_the_code(name: str) -> None:
    assert generated()[name] == (DOCS / name).read_text(encoding="utf-8"), "run `make docs`"


def test_every_key_of_a_config_has_its_meaning() -> None:
    rows = re.findall(r"^\| `(\w+)` \|.*\| ([^|]*)\|$", generated()["config.md"], re.MULTILINE)
    assert len(rows) > 120
    assert [key for key, meaning in rows if not meaning.strip() and key not in PLAIN] == []


def test_a_key_is_told_with_its_unit_its_bounds_and_its_default() -> None:
    mass, width, angle = (Disk.model_fields[name] for name in ("mass", "width", "position"))
    assert taken_by(mass.annotation, mass.metadata) == "mass [kg], above 0"
    assert default_of(mass) == "required"
    assert default_of(width) == '`"25 mm"`'
    assert taken_by(angle.annotation, angle.metadata) == "length [m], 0 or more"
    linear = Probe.model_fields["linear_range"]
    assert default_of(linear) == '`["-18 V", "-2 V"]`'
    address = ModbusRtu.model_fields["address"]
    assert taken_by(address.annotation, address.metadata) == "whole number, 1 or more, 247 or less"


def test_the_defaults_shown_are_read_as_the_defaults() -> None:
    shown = dict(re.findall(r"^\| `(\w+)` \| [^|]*\| `([^`]+)` \|", _section("`[prior]`"), re.MULTILINE))
    assert len(shown) == len(RigConfig.model_fields["prior"].default.model_fields_set | set(shown))
    table = "[prior]\n" + "\n".join(f"{key} = {value}" for key, value in shown.items())
    own = parse(_rk4() + table, where="defaults")
    plain = parse(_rk4(), where="rk4.toml")
    for key in shown:
        assert getattr(own.prior, key) == pytest.approx(getattr(plain.prior, key), rel=1e-4)


def test_the_limits_shown_are_limits(rig_config: RigConfig) -> None:
    (table,) = (text for text in blocks("docs/your-rig.md", "toml") if text.startswith("[limits]"))
    rk4 = _rk4()
    own = parse(rk4[: rk4.index("[limits]")] + table + rk4[rk4.index("[plans.default]") :], where="your-rig.md")
    assert own.limits is not None and own.limits.critical_ramp is not None
    assert own.limits.overspeed == rig_config.limits.overspeed
    assert validate_table(RigConfig, own.model_dump(), where="again", context={"si": True}).hash == own.hash


def _section(heading: str) -> str:
    return generated()["config.md"].partition(f"## {heading}\n")[2].partition("\n## ")[0]


def _rk4() -> str:
    text = text_of("configs/rk4.toml")
    return text[: text.index("[prior]")]


def test_every_drive_stands_in_the_example_of_its_page() -> None:
    text = (DOCS / "motors.md").read_text(encoding="utf-8")
    named = re.search(r"^profile = .* # (.*)$", text, re.MULTILINE)
    assert named is not None
    assert tuple(named[1].split(", ")) == profile_names()
