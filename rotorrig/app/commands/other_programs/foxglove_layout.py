"""Foxglove layout for a `response.mcap`: Bode plots, whirl and gap over speed, orbits in 3D.

Foxglove plots any numeric field against any other, by paths such as `/bode/1x/1X.amplitude_um`. The layout's panels and
their settings are those a layout file of Foxglove holds: https://docs.foxglove.dev/docs/visualization/layouts
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rotorrig.app.plot_data import slow_roll_known
from rotorrig.processing import OrderTrackedResponse, measured_planes, require_phases
from rotorrig.processing.files import FRAME
from rotorrig.rig import DataError, write_whole_text

SPEED = "exact_speed_rpm"
COLOURS = ("#4aa3df", "#f28e2b", "#62be78", "#ce74be", "#dcc85a", "#78c8d2")
Panels = dict[str, dict[str, Any]]
Node = str | dict[str, Any]  # a panel's name, or two nodes side by side


def write_foxglove_layout(path: Path, response: OrderTrackedResponse) -> int:
    """Write the layout for `response` to `path`; return the number of its panels. Raises DataError."""
    layout = foxglove_layout(response)
    write_whole_text(path, json.dumps(layout, indent=2) + "\n")
    return len(layout["configById"])


def foxglove_layout(response: OrderTrackedResponse) -> dict[str, Any]:
    """Return a layout: orbits and log on the left; a Bode plot per probe, whirl and gap over speed on the right.

    Raises DataError if the response has no 1X.
    """
    require_phases([response], "the layout")
    if 1.0 not in response.orders:
        raise DataError("response: was not tracked at 1X, which the layout's Bode plots need")
    panels: Panels = {"3D!orbits": _scene(), "RosOut!log": {"topicToRender": "/log", "minLogLevel": 1}}
    known = slow_roll_known(response)
    columns: list[Node] = []
    for name in response.probes:
        topic = f"/bode/{name}/1X"
        size = (
            [("compensated_amplitude_um", "compensated"), ("amplitude_um", "raw")]
            if known
            else [("amplitude_um", "raw")]
        )
        lag = "compensated_phase_lag_deg" if known else "phase_lag_deg"
        amplitude, phase = f"Plot!amplitude-{name}", f"Plot!phase-{name}"
        panels[amplitude] = _plot(f"{name}: 1X, µm 0-peak", topic, [(field, f"{name} {word}") for field, word in size])
        panels[phase] = _plot(f"{name}: 1X phase lag, °", topic, [(lag, f"{name} lag")])
        columns.append(_split("column", amplitude, phase, 65))
    below: list[Node] = []
    for plane, _ in measured_planes(response.rig, response.probes):
        joined = "-".join(plane.probes)
        panels[f"Plot!whirl-{joined}"] = _plot(
            f"{plane.name}: 1X whirl, µm",
            f"/whirl/{joined}/1X",
            [("forward_um", "forward"), ("backward_um", "backward")],
        )
        below.append(f"Plot!whirl-{joined}")
    if 0.0 in response.orders:
        for name in response.probes:
            panels[f"Plot!gap-{name}"] = _plot(f"{name}: gap, µm", f"/gap/{name}", [("gap_um", f"{name} gap")])
        below.append(_row([f"Plot!gap-{name}" for name in response.probes]))
    right = _split("column", _row(columns), _row(below), 65) if below else _row(columns)
    layout = _split("row", _split("column", "3D!orbits", "RosOut!log", 65), right, 30)
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": layout,
    }


def _scene() -> dict[str, Any]:
    """Return the settings of the 3D view: the rig from its side."""
    return {
        "followTf": FRAME,
        "cameraState": {
            "perspective": True, "distance": 0.8, "phi": 70, "thetaOffset": 15, "target": [0, 0, 0],
            "targetOffset": [0.28, 0, 0], "targetOrientation": [0, 0, 0, 1], "fovy": 45, "near": 0.01, "far": 100,
        },
        "scene": {"transforms": {"visible": False}},
        "topics": {
            topic: {"visible": True, "pointSize": 3, "colorMode": "rgba-fields"} for topic in ("/rig", "/orbits")
        },
    }  # fmt: skip


def _plot(title: str, topic: str, fields: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """Return the settings of a plot of fields of a topic over the speed; `fields` are names and labels."""
    paths = [
        {"value": _path(topic, field), "label": label, "enabled": True, "timestampMethod": "receiveTime",
         "color": COLOURS[i % len(COLOURS)], "showLine": True, "lineSize": 1.5}
        for i, (field, label) in enumerate(fields)
    ]  # fmt: skip
    return {
        "foxglovePanelTitle": title,
        "paths": paths,
        "xAxisVal": "custom",
        "xAxisPath": {"value": _path(topic, SPEED), "enabled": True, "timestampMethod": "receiveTime"},
        "xAxisLabel": "speed, rpm",
        "isSynced": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": False,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "sidebarDimension": 240,
    }


def _path(topic: str, field: str) -> str:
    """Return a message path; a topic with a dot in its name has to be quoted."""
    return f'"{topic}".{field}' if "." in topic else f"{topic}.{field}"


def _row(nodes: Sequence[Node]) -> Node:
    """Return nodes side by side, all of one width."""
    first, *others = nodes
    return _split("row", first, _row(others), 100 / len(nodes)) if others else first


def _split(direction: str, first: Node, second: Node, percentage: float) -> Node:
    return {"direction": direction, "first": first, "second": second, "splitPercentage": percentage}
