"""What the pictures and generated pages are made with."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from docs.field_comments import comments
from docs.make_tutorial import BEGIN, END, Done, filled
from docs.origin import origin_of, save_png
from docs.svg_plot import Figure


@dataclass
class Base:
    """A class to read."""

    width: float  # across
    plain: int = 0


@dataclass
class Derived(Base):
    """Another one."""

    # along, in one
    # sentence
    length: float = 1.0
    #: deep
    depth: float = 2.0  # or high


def test_the_comment_beside_a_field_and_the_lines_above_it_are_read() -> None:
    assert comments(Derived) == {"width": "across", "length": "along, in one sentence", "depth": "deep or high"}


def test_a_straightened_line_stays_within_a_hair_of_every_point() -> None:
    panel = Figure(width=400, height=200).panel((0, 0, 400, 200), x=(0, 10), y=(-1, 1))
    x = np.linspace(0, 10, 500)
    kept_x, kept_y = panel.straightened(x, np.sin(x), within=0.5)
    assert len(kept_x) < 60
    assert (kept_x[0], kept_x[-1]) == (0.0, 10.0)
    assert np.abs(np.interp(x, kept_x, kept_y) - np.sin(x)).max() * 100 < 0.5 * np.hypot(1, 2.5)  # px along y


def test_an_arrow_has_its_head_at_its_end() -> None:
    figure = Figure(width=100, height=100)
    figure.path([(10, 50), (90, 50)], arrow=True)
    assert 'd="M90.0 50.0L' in figure.text()


@pytest.mark.parametrize("ending", [".svg", ".png"])
def test_a_picture_tells_its_origin(ending: str, tmp_path: Path) -> None:
    out = tmp_path / f"picture{ending}"
    if ending == ".svg":
        Figure(width=10, height=10).save(out, origin="by hand")
    else:
        save_png(Image.new("RGB", (4, 4)), out, origin="by hand")
    assert origin_of(out) == "by hand"


def test_a_picture_that_says_nothing_has_no_origin(tmp_path: Path) -> None:
    Figure(width=10, height=10).save(tmp_path / "picture.svg")
    assert origin_of(tmp_path / "picture.svg") == ""


def test_the_tutorial_is_filled_with_what_came_out_and_how_long_it_took() -> None:
    text = f"```sh\nrotor check my.toml\n```\n\nIt says:\n\n```text\nold\n```\n\n{BEGIN}old\n{END}\n"
    got = filled(text, [Done(command="rotor check my.toml --model", printed="new\n", seconds=1.6)])
    assert "```text\nnew\n```" in got
    assert "| `rotor check --model` | 2 |" in got
    assert "old" not in got
