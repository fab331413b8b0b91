"""The rigs of the fault campaign: configs/rk4.toml with every motor controller in turn, and a short sweep."""

import re
from collections.abc import Mapping
from pathlib import Path

from rotorrig.rig.config import RPM, load_profile, profile_names

_RK4 = Path(__file__).parents[3] / "configs/rk4.toml"

_RTU = {"driver": "modbus-rtu", "port": "/dev/ttyUSB0", "rpm_per_hz": 60.0}
_COMMON = {"max_speed": "4200 rpm", "watchdog": "2 s"}

Table = Mapping[str, str | float]


def _on_a_line(profile: str) -> Table:
    by_hand = {"ramp": "10 rad/s^2"} if load_profile(profile).ramp_by_hand else {}
    return {
        "driver": "modbus-rtu",
        "port": "/dev/ttyUSB0",
        "profile": profile,
        "rpm_per_hz": 60.0,
        **by_hand,
        **_COMMON,
    }


DRIVES: Mapping[str, Table] = {
    **{profile: _on_a_line(profile) for profile in profile_names()},
    "powerflex400-tcp": {
        **{"driver": "modbus-tcp", "profile": "powerflex400", "host": "127.0.0.1", "rpm_per_hz": 60.0},
        **_COMMON,
    },
    "serial-line": {"driver": "serial-line", "port": "/dev/ttyUSB0", **_COMMON},
    "canopen": {"driver": "canopen", "interface": "slcan", "channel": "/dev/ttyUSB0", **_COMMON},
}

SAMPLE_RATE = 10e3  # Hz
_DAQ: Table = {"driver": "stream", "port": "/dev/ttyACM0", "sample_rate": f"{SAMPLE_RATE:g} Hz"}

FASTEST, START = 400.0 / RPM, 200.0 / RPM  # rad/s, of the plan: up to the one, coasting down to the other
_PLAN: Table = {  # 8 s to the top, 6 s down to the start, 7 s more to rest
    "kind": "run-up-coast-down",
    "slow_roll": "180 rpm",
    "slow_roll_time": "0.5 s",
    "start": f"{START * RPM:g} rpm",
    "end": f"{FASTEST * RPM:g} rpm",
    "ramp": "10 rad/s^2",  # also that of settling: some drives have one ramp only
}


def config(drive: str, *, motor: Table | None = None, daq: Table | None = None) -> str:
    """Return the text of the config for a drive; keys of `motor` and `daq` stand instead of its own."""
    text = _RK4.read_text(encoding="utf-8")
    text = _replaced(text, "motor", {**DRIVES[drive], **(motor or {})})
    text = _replaced(text, "daq", {**_DAQ, **(daq or {})})
    return _replaced(text, "plans.default", _PLAN)


def _replaced(text: str, name: str, table: Table) -> str:
    """Return a config with the table `name` in place of its own."""
    lines = [f"[{name}]", *(f'{key} = "{v}"' if isinstance(v, str) else f"{key} = {v}" for key, v in table.items())]
    new, count = re.subn(rf"(?ms)^\[{re.escape(name)}\].*?(?=^\[|\Z)", "\n".join(lines) + "\n\n", text)
    assert count == 1, f"configs/rk4.toml has {count} tables [{name}]"
    return new
