"""Summary and remarks of a tracked response: lines for a person, plain values for a program."""

from typing import Any

import numpy as np

from rotorrig.processing import OrderTrackedResponse, Tracking
from rotorrig.processing.rows import crowded_share
from rotorrig.rig.config import RPM


def tracking_line(response: OrderTrackedResponse) -> str:
    """Return rows, runs, masked rows and trial masses in a line."""
    masked = int((~response.usable).any(axis=1).sum())
    loaded = ", ".join(dict.fromkeys(disk for run in response.runs for disk in run.trial_unbalance))
    return f"{len(response.omega)} rows in {len(response.runs)} runs, {masked} with masked probes" + (
        f", with a trial mass on {loaded}" if loaded else ""
    )


def spacing_remark(response: OrderTrackedResponse, settings: Tracking) -> str:
    """Return a remark if rows are further apart than requested, else nothing."""
    every = settings.every
    share = crowded_share(response, every) if every else 0.0
    if every is None or not share:
        return ""
    asked = f"{every.step * RPM:g} rpm" if every.of == "speed" else f"{every.step:g} s"
    return (
        f"{share:.0%} of the rows are further apart than {asked}: closer rows of {settings.turns} turns would overlap "
        "and their errors would correlate; fewer --turns allow closer rows"
    )


def quality_lines(response: OrderTrackedResponse) -> list[str]:
    """Return the reasons for masked rows and the remarks on others, each with its number of rows and speed range."""
    lines = [f"slow roll: {remark}" for remark in response.slow_roll_remarks]
    remarks = [tuple(word.partition(": ")[0] for word in row) for row in response.remarks]
    for kind, rows in (("masked", response.reasons), ("remark", remarks)):
        speeds: dict[str, list[float]] = {}
        for omega, words in zip(response.omega, rows, strict=False):  # a table has no remarks
            for word in dict.fromkeys(words):
                speeds.setdefault(word, []).append(float(omega) * RPM)
        lines += [
            f"{kind}: {word} ({len(rpm)} row{'s' * (len(rpm) > 1)}, {min(rpm):.0f} to {max(rpm):.0f} rpm)"
            for word, rpm in speeds.items()
        ]
    return lines


def tracking_facts(response: OrderTrackedResponse) -> dict[str, Any]:
    """Return the facts of a tracked response as plain values; speeds in rpm, jitter in s, 1 sigma."""
    rows = [np.flatnonzero(response.run == i) for i in range(len(response.runs))]
    return {
        "rows": len(response.omega),
        "masked": int((~response.usable).any(axis=1).sum()),
        "reasons": sorted({word for row in response.reasons for word in row}),
        "remarks": sorted({word for row in response.remarks for word in row}),
        "probes": list(response.probes),
        "orders": list(response.orders),
        "method": response.method,
        "window": response.window,
        "turns": float(np.median(response.revolutions)),
        "jitter_s": float(np.median(response.jitter)) if response.jitter.size else None,
        "slow_roll_rpm": response.slow_roll_omega * RPM,
        "slow_roll_remarks": list(response.slow_roll_remarks),
        "runs": [
            {
                "name": run.name,
                "direction": run.direction,
                "rows": len(mine),
                "from_rpm": float(response.omega[mine[0]] * RPM) if len(mine) else None,
                "to_rpm": float(response.omega[mine[-1]] * RPM) if len(mine) else None,
                "trial_unbalance_kg_m": {disk: [u.real, u.imag] for disk, u in run.trial_unbalance.items()},
            }
            for run, mine in zip(response.runs, rows, strict=True)
        ],
    }
