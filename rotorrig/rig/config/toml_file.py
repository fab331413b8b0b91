"""Reading of TOML files, with one sentence for what is no valid TOML."""

import tomllib
from pathlib import Path
from typing import Any

from rotorrig.rig.errors import ConfigError

LARGEST = 4 * 2**20  # bytes; a config with its comments has some thousand


def read_toml(path: Path, *, want: str) -> tuple[dict[str, Any], str]:
    """Return the table in `path` and its text. Raises ConfigError; `want` is what the file should hold."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
        text = data.decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise ConfigError(f"{path}: cannot be read ({reason}), want {want} in TOML") from error
    if len(data) > LARGEST:
        raise ConfigError(f"{path}: has more than {LARGEST >> 20} MiB, want {want} in TOML")
    return parse_toml(text, where=str(path)), text.replace("\r\n", "\n")


def parse_toml(text: str, *, where: str) -> dict[str, Any]:
    """Return the table in `text`; `where` names it in errors. Raises ConfigError."""
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ConfigError(f"{where}: is no valid TOML: its tables or lists are nested too deep") from error
    except ValueError as error:  # a TOMLDecodeError, or what int() and datetime say of hostile digits
        raise ConfigError(f"{where}: is no valid TOML: {error}") from error
