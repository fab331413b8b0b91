"""Configs by name: those that come with the program, and files that go before them."""

from pathlib import Path

import pytest

from rotorrig.rig import ConfigError
from rotorrig.rig.config import bundled_configs, find_config, load

CONFIGS = Path(__file__).parents[3] / "configs"


def test_every_file_of_the_folder_is_bundled_and_a_rig() -> None:
    assert list(bundled_configs()) == sorted(path.stem for path in CONFIGS.glob("*.toml"))
    assert all(load(path).name for path in bundled_configs().values())


def test_a_bare_name_is_looked_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rk4").mkdir()  # a folder is no config
    assert find_config(Path("rk4")).samefile(CONFIGS / "rk4.toml")


def test_a_file_of_that_name_wins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rk4").write_text("")
    assert find_config(Path("rk4")) == Path("rk4")


@pytest.mark.parametrize("given", ["rk4.toml", "other/rk4", "/rk4"])
def test_a_path_is_left_alone(given: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert find_config(Path(given)) == Path(given)


def test_an_unknown_name_lists_those_there_are() -> None:
    with pytest.raises(ConfigError, match=r"config 'rk5': is neither a file nor bundled, .* one of kfupm-rk4, rk4$"):
        find_config(Path("rk5"))
