"""Reading of TOML files, with one sentence for what is no valid TOML."""

import re
import tomllib
from pathlib import Path
from typing import Any

from rotorrig.rig.errors import ConfigError

LARGEST = 4 * 2**20  # bytes; a config with its comments has some thousand
DEEPEST = 100  # parts of a dotted key; the parser takes time with their square
_PART = re.compile(r"""[\w-]++|"[^"\n]*+"|'[^'\n]*+'""")
#: dotted or not, so that no place is looked at twice
_DOTTED = re.compile(rf"(?:{_PART.pattern})(?:[ \t]*+\.[ \t]*+(?:{_PART.pattern}))*+")


def read_toml(path: Path, *, want: str) -> tuple[dict[str, Any], str]:
    """Return the table in `path` and its text. Raises ConfigError; `want` is what the file should hold."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
        text = data.decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise ConfigError(f"{path}: cannot be read ({reason}), want {want} in TOML") from error
    if len(data) > LARGEST:
        raise ConfigError(f"{path}: has more than {LARGEST >> 20} MiB, want {want} in TOML")
    return parse_toml(text, where=str(path)), text.replace("\r\n", "\n")


def parse_toml(text: str, *, where: str) -> dict[str, Any]:
    """Return the table in `text`, which may begin with a byte order mark; `where` names it in errors.

    Raises ConfigError.
    """
    text = text.removeprefix("\ufeff")
    if any(len(_PART.findall(key.group())) > DEEPEST for key in _DOTTED.finditer(text)):
        raise ConfigError(f"{where}: is no valid TOML: its tables or lists are nested too deep")
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ConfigError(f"{where}: is no valid TOML: its tables or lists are nested too deep") from error
    except ValueError as error:  # a TOMLDecodeError, or what int() and datetime say of hostile digits
        raise ConfigError(f"{where}: is no valid TOML: {error}") from error
