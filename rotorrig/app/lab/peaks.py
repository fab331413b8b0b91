"""Critical speeds of a response as rows of the table `peaks`."""

from collections.abc import Iterator
from typing import Any

from rotorrig.app.plot_data import critical_speeds
from rotorrig.processing import OrderTrackedResponse, Uncertain
from rotorrig.rig.config import RPM, UM


def peaks_of(response: OrderTrackedResponse) -> Iterator[dict[str, Any]]:
    """Yield the critical speeds of each probe and run (docs/critical-speeds.md), without the keys of a row."""
    for found in critical_speeds(response) if 1.0 in response.orders else ():
        peak = found.measured
        yield {
            "run": found.run,
            "probe": found.probe,
            "critical_speed_rpm": peak.omega.value * RPM,
            "peak_um": peak.amplitude.value * UM,
            "amplification_factor": _value(peak.amplification),
            "damping_ratio": _value(peak.damping),
        }


def _value(known: Uncertain | None) -> float | None:
    return None if known is None else known.value
