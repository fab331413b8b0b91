"""Configs that come with the program, by name: "rk4" is configs/rk4.toml of a checkout or of the installed package."""

from importlib import resources
from pathlib import Path

from rotorrig.rig.errors import ConfigError


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
    """Write a copy of a bundled config. Raises ConfigError if there is none of that name, or `to` exists."""
    text = bundled_config(name).read_text(encoding="utf-8")
    try:
        with to.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise ConfigError(f"{to}: is there already, want --out with another name") from error
    except OSError as error:
        raise ConfigError(f"{to}: cannot be written ({error.strerror})") from error


def _folder() -> Path:
    package = Path(str(resources.files("rotorrig")))
    installed = package / "configs"  # where a wheel has them
    return installed if installed.is_dir() else package.parent / "configs"
