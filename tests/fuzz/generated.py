"""Inputs that hypothesis makes up from the grammar of a file, where mutations of a good one hardly get."""

import json
import struct
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.acquisition.importers import foreign_files as made
from tests.fuzz import corpus

_NUMBERS = st.one_of(
    st.integers(),
    st.floats(),
    st.sampled_from(["1e999", "-0", "nan", "1_0", "0x1", "9" * 500, "", "1e-400", "+1.", "٣", "1,5"]),
).map(str)
_UNITS = st.sampled_from(
    ["V", "mV", "um", "mil", "s", "ms", "Hz", "kg", "m^9^9", "V)+(V", "%", "", "°", "10 um", "Volts"]
)
_NAMES = st.sampled_from([*made.NAMES, "time", "", "1X", " 1x ", "a]b", "[", "NONE", "x" * 300, "µ"])
_QUANTITIES = st.tuples(_NUMBERS, _UNITS).map(" ".join)


def _cells(delimiter: str) -> st.SearchStrategy[str]:
    return st.lists(st.lists(_NUMBERS, min_size=4, max_size=7).map(delimiter.join), max_size=8).map("\n".join)


def _csv(delimiter: str) -> st.SearchStrategy[bytes]:
    named = st.tuples(_NAMES, _UNITS).map(lambda pair: f"{pair[0]} [{pair[1]}]")
    usual = st.just(["time [s]", "keyphasor [V]", "1x [um]", "1y [V]", "2x [mil]", "2y [V]"])
    heading = st.one_of(usual, st.lists(named, max_size=8)).map(delimiter.join)
    return st.tuples(heading, _cells(delimiter)).map(lambda parts: "\n".join(parts).encode())


_LEAVES = st.one_of(
    st.booleans(), st.integers(), st.floats(), st.text(max_size=20), _QUANTITIES, _NAMES, st.just("12 g mm")
)
_KEYS = st.sampled_from(["notes", "unit", "name", "channel", "probe", "speed", "kxx", "driver", "x", "é", "a b"])


def _toml_value(value: object) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(k)} = {_toml_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else str(value)


_VALUES = st.recursive(
    _LEAVES,
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(_KEYS, inner, max_size=4)),
    max_leaves=12,
)


@st.composite
def _toml(draw: st.DrawFn, good: bytes) -> bytes:
    """Return a good file in which some values are replaced, keys taken away or added."""
    table = tomllib.loads(good.decode())
    for _ in range(draw(st.integers(0, 3))):
        here: Any = table
        while True:
            key = draw(st.sampled_from(list(here) if isinstance(here, dict) else list(range(len(here)))))
            if not (isinstance(here[key], dict | list) and here[key]) or draw(st.integers(0, 4)) == 0:
                break
            here = here[key]
        match draw(st.sampled_from(["replace", "replace", "replace", "remove", "add"])):
            case "replace":
                here[key] = draw(_VALUES)
            case "remove":
                del here[key]
            case "add" if isinstance(here, dict):
                here[draw(_KEYS)] = draw(_VALUES)
        if not table:
            break
    text = "\n".join(f"{json.dumps(key)} = {_toml_value(value)}" for key, value in table.items())
    return text.encode("utf-8", "replace")


@st.composite
def _uff(draw: st.DrawFn) -> bytes:
    values = np.array(draw(st.lists(st.floats(width=32), min_size=1, max_size=9)))
    made_of = {
        "unit": draw(_UNITS)[:20],
        "function": draw(st.integers(0, 99)),
        "form": draw(st.sampled_from(["4E20.12", "6E13.5", "<d", ">f"])),
        "step": draw(st.floats()),
        "start": draw(st.floats()),
        "ordinate": draw(st.integers(0, 99)),
        "points": draw(st.integers(-9, 10**9)),
    }
    usual = {"function": 1, "step": 1e-4, "start": 0.0, "unit": "V", "points": len(values), "ordinate": 1}
    changed = draw(st.sets(st.sampled_from(sorted(made_of)), max_size=2))
    chosen = usual | {"form": made_of["form"]} | {name: made_of[name] for name in changed}
    return b"".join(made.uff58(name, values, **chosen) for name in draw(st.just(made.NAMES)))


@st.composite
def _tdms(draw: st.DrawFn) -> bytes:
    values = np.array(draw(st.lists(st.floats(), max_size=6)))
    timed: dict[str, float | str] = {"wf_increment": 1e-4, "unit_string": "V"}
    names = st.sampled_from([*timed, "NI_Number_Of_Scales", "NI_Scale[0]_Scale_Type", "NI_Scale[0]_Linear_Slope", "x"])
    others = st.dictionaries(
        names, st.one_of(st.floats(), _UNITS, st.sampled_from(["Linear", "Add", "RTD"])), max_size=4
    )
    channels = [(f"/'g'/'{name}'", values, timed | draw(others)) for name in made.NAMES]
    return made.tdms_segment(channels) * draw(st.integers(1, 3))


@st.composite
def _wav(draw: st.DrawFn) -> bytes:
    channels, bits = draw(st.integers(0, 6)), draw(st.sampled_from([0, 8, 12, 16, 24, 32, 64]))
    coding, rate = draw(st.sampled_from([1, 3, 6, 0xFFFE])), draw(st.integers(0, 2**32 - 1))
    header = struct.pack("<HHIIHH", coding, channels, rate, 0, channels * bits // 8, bits)
    return made.riff((b"fmt ", header), (b"data", draw(st.binary(max_size=200))))


STRATEGIES: dict[str, st.SearchStrategy[bytes]] = {
    "csv": st.one_of(_csv(","), _csv(";")),
    "bode": _csv(",").map(lambda text: text.replace(b"time [s],keyphasor [V],1x [um],1y [V]", b"run,rpm,amp,phase")),
    "channels": _toml(corpus.CHANNELS),
    "bode mapping": _toml(corpus.BODE_MAPPING),
    "config": _toml((corpus.ROOT / "configs/rk4.toml").read_bytes()),
    "uff": _uff(),
    "tdms": _tdms(),
    "wav": _wav(),
    "run": st.binary(max_size=500).map(lambda data: b"\x89MCAP0\r\n" + data),
    "response": st.binary(max_size=500).map(lambda data: b"\x89MCAP0\r\n" + data),
    "daq": st.lists(st.one_of(st.binary(max_size=40), st.just(b"\xa5\x5a")), max_size=20).map(b"".join),
    "daq info": st.dictionaries(
        st.sampled_from(
            ["protocol", "model", "serial", "sample_rate_hz", "channels", "volts_per_count", "full_scale_counts"]
        ),
        st.one_of(st.integers(), st.floats(), st.text(max_size=5), st.lists(st.floats(), max_size=3), st.none()),
    ).map(lambda said: json.dumps(json.loads(corpus.INFO) | said).encode()),
    "line": st.text(max_size=60).map(lambda text: b"<01 OK " + text.encode("utf-8", "replace")),
}


def generated(kind: str, rng: np.random.Generator) -> bytes | None:
    """Return what the strategy of `kind` makes of random bytes; None if they did not suffice."""
    _made.clear()
    _GRABBERS[kind].hypothesis.fuzz_one_input(rng.bytes(4000))
    return _made[-1] if _made else None


_made: list[bytes] = []


def _grabber(strategy: st.SearchStrategy[bytes]) -> Any:
    @settings(database=None, deadline=None, suppress_health_check=list(HealthCheck))
    @given(strategy)
    def grab(data: bytes) -> None:
        _made.append(data)

    return grab


_GRABBERS = {kind: _grabber(strategy) for kind, strategy in STRATEGIES.items()}
