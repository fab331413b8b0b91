"""Extension of a config by effects: the rig and its TOML, `extend(rig, effects)`.

The text the rig was read from is kept, comments and all, and only its `[[effects]]` are written anew; a config without
such a text is written in bare SI numbers, under `units = "SI"`.
"""

import json
import re
from collections.abc import Mapping, Sequence

from rotorrig.rig.config.description import RigConfig, parse
from rotorrig.rig.config.extension import Extension
from rotorrig.rig.errors import ConfigError

_HEAD = "# What extends the model beyond the nameplate; SI, sigmas are one standard deviation."
_TABLE = re.compile(r"\s*\[")  # a line that begins a table
_EFFECTS = re.compile(r"\s*\[\[?\s*effects\b")


def extend(rig: RigConfig, effects: Sequence[Extension]) -> RigConfig:
    """Return the rig with `effects` in its model and no others; its `text` is the config to write."""
    tables = "\n".join([_HEAD, *(_table(effect) for effect in effects)]) if effects else ""
    bare = _without_effects(rig.text)
    if not _says(bare, rig):
        bare = _in_si(rig)
    return parse(f"{bare.rstrip()}\n\n{tables}".rstrip() + "\n", where=rig.name)


def _without_effects(text: str) -> str:
    """Return `text` less its tables of effects; comments stay."""
    kept, among = [], False
    for line in text.splitlines():
        if _TABLE.match(line):
            among = bool(_EFFECTS.match(line))
        if line != _HEAD and not (among and line.strip() and not line.lstrip().startswith("#")):
            kept.append(line)
    return "\n".join(kept)


def _says(text: str, rig: RigConfig) -> bool:
    """Return whether `text` is the nameplate of `rig`, effects apart."""
    try:
        return bool(text) and parse(text, where=rig.name).hash == rig.nameplate_hash
    except ConfigError:
        return False


def _in_si(rig: RigConfig) -> str:
    values = rig.model_dump(mode="json", exclude={"effects"}, exclude_none=True)
    return "\n".join(['units = "SI"', *(f"{_key(name)} = {_value(value)}" for name, value in values.items())])


def _table(effect: Extension) -> str:
    values = effect.model_dump(mode="json", exclude_defaults=True)
    return "\n".join(["[[effects]]", *(f"{_key(name)} = {_value(value)}" for name, value in values.items()), ""])


def _value(value: object) -> str:
    """Return a TOML value, tables and lists on one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(k))} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return repr(value) if isinstance(value, float) else json.dumps(value, ensure_ascii=False)


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)
