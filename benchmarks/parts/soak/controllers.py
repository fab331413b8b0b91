"""The controllers of the fault campaign, and the config of a short sweep on the ports of a peer bench."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]

CONTROLLERS = (
    "acs355-tcp",
    "canopen",
    "line",
    "acs355-rtu",
    "powerflex400-rtu",
    "powerflex400-tcp",
    "m-max-rtu",
    "m-max-tcp",
    "vfd-ed-rtu",
    "vfd-ed-tcp",
)
FOR_PAIRS = CONTROLLERS[:3]

RATE = 5000.0  # Hz
RPM_PER_HZ = 60.0
MAX_SPEED = 1800.0  # rpm
TOP = 1200.0  # rpm, of the plan
_RAMP = "500 rpm/s"
PLAN = {
    "kind": "stepped",
    "slow_roll": "300 rpm",
    "slow_roll_time": "0.5 s",
    "speeds": [f"{TOP:g} rpm"],
    "ramp": _RAMP,
    "dwell": "1.5 s",
    "settle": "0.5 s",
}
DWELL = {"kind": "dwell", "speed": "300 rpm", "time": "20 s", "ramp": "100 rpm/s", "settle": "0.5 s"}
LIMITS = {"overspeed": "1700 rpm", "vibration": "900 um"}

Table = Mapping[str, Any]


def config(
    controller: str, ports: Mapping[str, Table], *, plan: Table = PLAN, limits: Table | None = LIMITS, **motor: Any
) -> str:
    """Text of configs/rk4.toml with a controller and a DAQ at `ports`; keys of `motor` stand instead of its own."""
    text = (ROOT / "configs/rk4.toml").read_text(encoding="utf-8")
    text = _replace(text, "motor", {**_motor(controller), **motor, **ports["motor"]})
    text = _replace(text, "daq", {"driver": "stream", "sample_rate": f"{RATE:g} Hz", **ports["daq"]})
    text = _replace(text, "limits", limits)
    return _replace(text, "plans.default", plan)


def has_watchdog(controller: str) -> bool:
    """Return whether a drive stops by itself when nobody speaks to it."""
    return not controller.startswith("vfd-ed")


def _motor(controller: str) -> dict[str, Any]:
    common = {"max_speed": f"{MAX_SPEED:g} rpm", "watchdog": "2 s"}
    if controller == "canopen":
        return {"driver": "canopen", "interface": "slcan", "bitrate": 500000, **common}
    if controller == "line":
        return {"driver": "serial-line", **common}
    family, _, wire = controller.rpartition("-")
    by_hand = {"ramp": _RAMP} if family == "vfd-ed" else {}
    return {"driver": f"modbus-{wire}", "profile": family, "rpm_per_hz": RPM_PER_HZ, **by_hand, **common}


def _replace(text: str, name: str, table: Table | None) -> str:
    """Return a config with `table` in place of its own of that name; None: without it."""
    lines = [] if table is None else [f"[{name}]", *(f"{k} = {json.dumps(v)}" for k, v in table.items()), "", ""]
    new, count = re.subn(rf"(?ms)^\[{re.escape(name)}\].*?(?=^\[|\Z)", lambda match: "\n".join(lines), text)
    if count != 1:
        raise ValueError(f"configs/rk4.toml has {count} tables [{name}], expected 1")
    return new
