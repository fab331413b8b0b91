"""Rows of the catalogue's tables, from what the steps of a recording came to."""

import math
import re
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import numpy as np

from rotorrig.app.lab.peaks import peaks_of
from rotorrig.app.lab.steps import FILES, Job, Outcome
from rotorrig.identify import Diagnosis, Estimate, Identification
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM, UM

_RECORDED = re.compile(r"recorded from (\d{4}-\d\d-\d\d \d\d:\d\d:\d\d) UTC$")  # as acquisition/sweep notes it

Row = dict[str, Any]


def rows_of(job: Job, outcome: Outcome) -> dict[str, list[Row]]:
    """Return the rows of every table; of a failure with what was done before it."""
    keys = {
        "run_id": job.recording.run_id,
        "key": job.key,
        "code_version": job.code_version,
        "made_at": datetime.now(UTC),
    }
    response, fit, diagnosis = outcome.response, outcome.identification, outcome.diagnosis
    tables: dict[str, list[Row]] = {
        "runs": [run_row(job, outcome)],
        "estimates": estimate_rows(fit) if fit else [],
        "causes": cause_rows(diagnosis) if diagnosis else [],
        "peaks": list(peaks_of(response)) if response else [],
        "events": [{"t_s": e.t_ns / 1e9, "kind": e.kind, "text": e.text} for e in outcome.events],
    }
    return {name: [keys | row for row in rows] for name, rows in tables.items()}


def run_row(job: Job, outcome: Outcome) -> Row:
    """Return the row of `runs`, without its keys."""
    diagnosis = outcome.diagnosis
    rig = outcome.response.rig if outcome.response else None
    files = {f"{name.partition('.')[0]}_file": outcome.files.get(step) for step, name in FILES.items()}
    return {
        "file": job.recording.file,
        "recorded_at": _recorded_at(job, outcome),
        "rig": rig.name if rig else "",
        "nameplate_hash": rig.nameplate_hash if rig else "",
        "config_hash": rig.hash if rig else "",
        "kind": job.recording.kind,
        **_describe_response(outcome.response, outcome.recorded_s),
        "status": "failed" if outcome.sentence else "done",
        "step": outcome.step,
        "sentence": outcome.sentence or (diagnosis.sentence if diagnosis else ""),
        "verdict": str(diagnosis.verdict) if diagnosis else "",
        **_describe_fit(outcome),
        **{f"seconds_{step}": outcome.seconds.get(step) for step in ("track", "identify", "diagnose")},
        **{name: job.lab.relative(path) if path else None for name, path in files.items()},
    }


def estimate_rows(identification: Identification) -> list[Row]:
    """Return the rows of `estimates`: every fit's, the whole sweep first."""
    return [_estimate_row(fit.name, estimate) for fit in identification.fits for estimate in fit.estimates]


def cause_rows(diagnosis: Diagnosis) -> list[Row]:
    """Return the rows of `causes`, as the diagnosis ranks them."""
    return [
        {
            "rank": rank,
            "label": cause.label,
            "effect": cause.effect,
            "place": cause.where,
            "chosen": cause.chosen,
            "evidence": finite(cause.evidence),
            "explained": explained_part(cause.lam, chi2=diagnosis.chi2, dof=diagnosis.dof),
            "words": cause.words,
        }
        for rank, cause in enumerate(diagnosis.causes, 1)
    ]


def explained_part(lam: float, *, chi2: float, dof: int) -> float | None:
    """Return which part of a misfit, 0 to 1, a cause explains that takes `lam` off chi2.

    The misfit is chi2 above dof, what noise alone would leave; None where that is within two of its standard
    deviations, sqrt(2 dof), so that there is no misfit to explain.

    >>> explained_part(300.0, chi2=1400.0, dof=800), explained_part(30.0, chi2=810.0, dof=800)
    (0.5, None)
    """
    misfit = chi2 - dof
    if not (math.isfinite(lam) and misfit > 2 * math.sqrt(2 * dof)):
        return None
    return min(max(lam / misfit, 0.0), 1.0)


def finite(value: float) -> float | None:
    """Return a number, None for one that is not known or not finite."""
    return value if math.isfinite(value) else None


def _estimate_row(fit: str, estimate: Estimate) -> Row:
    low, high = estimate.interval or (None, None)
    return {
        "fit": fit,
        "name": estimate.name,
        "value": estimate.value,
        "sigma": estimate.sigma,
        "low95": low,
        "high95": high,
        "unit": estimate.unit,
        "nameplate": finite(estimate.nameplate),
        "determined": estimate.determined,
    }


def _recorded_at(job: Job, outcome: Outcome) -> datetime | None:
    for event in outcome.events:
        if event.kind == "note" and (noted := _RECORDED.search(event.text)):
            return datetime.strptime(noted[1], "%Y-%m-%d %H:%M:%S").replace(tzinfo=UTC)
    try:
        return datetime.fromtimestamp((job.lab.root / job.recording.file).stat().st_mtime, UTC)
    except OSError:
        return None


def _describe_response(response: OrderTrackedResponse | None, recorded_s: float | None) -> Row:
    if response is None:
        none: Mapping[str, None] = dict.fromkeys(
            ("duration_s", "lowest_speed_rpm", "highest_speed_rpm", "rows", "probes", "noise_um")
        )
        return dict(none)
    times = response.t[np.isfinite(response.t)]
    duration = recorded_s if recorded_s is not None else float(np.ptp(times)) if times.size else None
    return {
        "duration_s": duration,
        "lowest_speed_rpm": float(response.omega.min() * RPM),
        "highest_speed_rpm": float(response.omega.max() * RPM),
        "rows": len(response.omega),
        "probes": len(response.probes),
        "noise_um": _noise_um(response),
    }


def _noise_um(response: OrderTrackedResponse) -> float | None:
    """Return the median standard deviation of a 1X component over usable rows and probes [µm]; None without 1X."""
    if 1.0 not in response.orders:
        return None
    variance = response.covariance[:, response.orders.index(1.0)].diagonal(axis1=1, axis2=2)
    both = variance.reshape(*response.usable.shape, 2)[response.usable]
    good = both[np.isfinite(both)]
    return float(np.median(np.sqrt(good)) * UM) if good.size else None


def _describe_fit(outcome: Outcome) -> Row:
    response, fit, diagnosis = outcome.response, outcome.identification, outcome.diagnosis
    chi2, residual = None, None
    if diagnosis and diagnosis.dof:
        chi2 = finite(diagnosis.chi2 / diagnosis.dof)
    if fit and response:
        whole = fit.fits[0]
        chi2 = whole.chi2 / whole.dof if whole.dof else None
        left = np.abs(response.order(1.0) - whole.prediction)[response.usable]
        left = left[np.isfinite(left)]
        residual = float(np.sqrt(np.mean(left**2)) * UM) if left.size else None
    return {"chi2_per_dof": chi2, "residual_um": residual}
