"""Configs that come with the program, by name: "rk4" is configs/rk4.toml of a checkout or of the installed package."""

from importlib import resources
from pathlib import Path

from rotorrig.rig.errors import ConfigError
from rotorrig.rig.whole_file import write_whole_text


def bundled_configs() -> dict[str, Path]:
    """Return the file of every bundled config by its name."""
    return {path.stem: path for path in sorted(_folder().glob("*.toml"))}


def bundled_config(name: str) -> Path:
    """Return the file of one bundled config. Raises ConfigError naming those there are."""
    configs = bundled_configs()
    if name not in configs:
        raise ConfigError(f"config '{name}': is neither a file nor bundled, want a path or one of {', '.join(configs)}")
    return configs[name]


def find_config(given: Path) -> Path:
    """Return the file of a config given by path, or by its bare name where it is a bundled one; a file wins.

    Raises ConfigError if a bare name is neither.
    """
    bare = given.name == str(given) and not given.suffix
    return bundled_config(given.name) if bare and not given.is_file() else given


def copy_config(name: str, to: Path) -> None:
    """Write a copy of a bundled config. Raises ConfigError if there is none of that name, DataError if that fails."""
    text = bundled_config(name).read_text(encoding="utf-8")
    write_whole_text(to, text)


def _folder() -> Path:
    package = Path(str(resources.files("rotorrig")))
    installed = package / "configs"  # where a wheel has them
    return installed if installed.is_dir() else package.parent / "configs"
