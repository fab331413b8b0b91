"""`rotor check --model`: the drawing is to scale, the tables say what is known by hand."""

import sys
from pathlib import Path

import pytest

from rotorrig.app import cli
from rotorrig.app.terminal.model_drawing import draw_rotor
from rotorrig.rig.config.description import RigConfig, from_si

RK4 = Path(__file__).parents[3] / "configs/rk4.toml"
SPRING = {"kxx": 1e6, "kyy": 1e6, "cxx": 50.0, "cyy": 50.0}


def rotor(**change: object) -> RigConfig:
    """A shaft of 800 mm x 40 mm, 41 columns of 20 mm: two columns of the drawing per 40 mm."""
    disk = {
        "name": "wheel",
        "position": 0.4,
        "mass": 30.0,
        "polar_inertia": 0.2,
        "transverse_inertia": 0.11,
        "width": 0.06,
        "diameter": 0.22,
    }
    return from_si(
        {
            "name": "drawn",
            "shaft": {"length": 0.8, "diameter": 0.06, "density": 7800.0, "youngs_modulus": 2e11},
            "disks": [disk],
            "bearings": [{"name": "left", "position": 0.1, **SPRING}, {"name": "right", "position": 0.7, **SPRING}],
            "probes": [
                {"name": "x", "position": 0.2, "angle": 0.0, "channel": 0},
                {"name": "y", "position": 0.2, "angle": 1.57, "channel": 1},
            ],
        }
        | change
    )


def rows(rig: RigConfig, width: int = 41, *, plain: bool = False) -> list[str]:
    return draw_rotor(rig, width=width, plain=plain).plain.split("\n")


def squares(lines: list[str], column: int) -> int:
    """Return how many half rows are filled in a column."""
    return sum({"█": 2, "▀": 1, "▄": 1}.get(text[column], 0) for text in lines)


def test_the_drawing_is_to_scale() -> None:
    lines = rows(rotor())
    assert all(len(text) == 41 for text in lines)
    assert squares(lines, 1) == 3  # 60 mm of shaft at 20 mm a square
    wheel = [column for column in range(41) if squares(lines, column) > 3]
    assert [squares(lines, column) for column in wheel] == [11, 11, 11]  # 220 mm high, 60 mm wide
    assert wheel[0] <= 20 <= wheel[-1]  # about 400 mm


def test_bearings_touch_the_shaft_from_below_and_probes_from_above() -> None:
    lines = rows(rotor())
    shaft = [i for i, text in enumerate(lines) if text[1] in "█▀▄"]
    assert [column for column, sign in enumerate(lines[shaft[-1] + 1]) if sign == "▲"] == [5, 35]
    assert [column for column, sign in enumerate(lines[shaft[0] - 1]) if sign == "▼"] == [10]
    whole = "\n".join(lines)
    assert all(words in whole for words in ("left", "right", "x, y", "wheel"))


def test_a_step_and_a_bore_are_seen() -> None:
    sections = [
        {"length": 0.4, "diameter": 0.06},
        {"length": 0.4, "diameter": 0.22, "inner_diameter": 0.14},
    ]
    lines = rows(rotor(shaft={"sections": sections, "density": 7800.0, "youngs_modulus": 2e11}))
    assert squares(lines, 2) == 3
    assert squares(lines, 38) == 4  # walls of 40 mm


def test_names_that_would_meet_stand_in_lines_of_their_own() -> None:
    bearings = [{"name": f"a long name {i}", "position": z, **SPRING} for i, z in enumerate((0.1, 0.2, 0.7))]
    lines = rows(rotor(bearings=bearings))
    assert all(sum(f"a long name {i}" in text for text in lines) == 1 for i in range(3))


@pytest.mark.parametrize("width", [1, 24, 80, 200])
def test_any_width_will_do(width: int) -> None:
    assert {len(text) for text in rows(rotor(), width)} == {max(width, 24)}


def test_plain_is_ascii() -> None:
    assert "\n".join(rows(rotor(), plain=True)).isascii()


def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: object) -> tuple[object, str]:
    monkeypatch.setattr(sys, "argv", ["rotor", *map(str, words)])
    monkeypatch.setattr(cli.out, "_width", 100)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    printed = capsys.readouterr()
    return ended.value.code, printed.out + printed.err


def test_check_model_prints_what_the_rk4_weighs_carries_and_resonates_at(monkeypatch, capsys) -> None:
    code, said = run(monkeypatch, capsys, "check", RK4, "--model")
    assert code in (0, None)
    assert "1.152" in said  # 0.809 kg of disk and 0.343 kg of shaft, 7801 pi / 4 0.01^2 0.56
    loads = [
        float(text.split()[-2]) for text in said.splitlines() if text.split()[:1] == ["bearing"] and "k" not in text
    ]
    assert sum(loads) == pytest.approx(1.152 * 9.80665, abs=0.02)
    assert "backward" in said
    assert "2225.7" in said
    assert "stable from rest to 4200 rpm" in said


def test_a_rotor_that_nothing_holds_is_one_sentence(monkeypatch, capsys, tmp_path) -> None:
    text = RK4.read_text().replace('"2.0e6 N/m"', '"0 N/m"').replace('"34.6 kN/m"', '"0 N/m"')
    (config := tmp_path / "loose.toml").write_text(text)
    code, said = run(monkeypatch, capsys, "check", config, "--model")
    assert code == 1
    assert "do not hold the shaft" in said
    assert "Traceback" not in said
