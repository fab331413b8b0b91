"""Catalogues of labs that never were, in the files that `rotor lab run` keeps; and a real run put among them."""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from rotorrig.app.plot_data import curves
from rotorrig.identify import read_diagnosis, read_identification
from rotorrig.processing.files import read_response
from rotorrig.rig.config import UM

TEXT, NUMBER, COUNT, TIME = pa.string(), pa.float64(), pa.int64(), pa.timestamp("us", tz="UTC")
COMMON = {"run_id": TEXT, "key": TEXT, "code_version": TEXT, "made_at": TIME}
SCHEMAS: dict[str, dict[str, pa.DataType]] = {
    "runs": {
        **{"file": TEXT, "recorded_at": TIME},
        **dict.fromkeys(("rig", "nameplate_hash", "config_hash", "kind"), TEXT),
        **dict.fromkeys(("duration_s", "lowest_speed_rpm", "highest_speed_rpm"), NUMBER),
        **{"rows": COUNT, "probes": COUNT},
        **dict.fromkeys(("status", "step", "sentence", "verdict"), TEXT),
        **dict.fromkeys(("chi2_per_dof", "residual_um", "noise_um"), NUMBER),
        **dict.fromkeys(("seconds_track", "seconds_identify", "seconds_diagnose"), NUMBER),
        **dict.fromkeys(("response_file", "fit_file", "diagnosis_file", "report_file"), TEXT),
    },
    "estimates": {
        **{"fit": TEXT, "name": TEXT},
        **dict.fromkeys(("value", "sigma", "low95", "high95"), NUMBER),
        **{"unit": TEXT, "nameplate": NUMBER, "determined": pa.bool_()},
    },
    "causes": {
        "rank": COUNT,
        **dict.fromkeys(("label", "effect", "place"), TEXT),
        "chosen": pa.bool_(),
        **{"evidence": NUMBER, "explained": NUMBER, "words": TEXT},
    },
    "peaks": {
        **{"run": TEXT, "probe": TEXT},
        **dict.fromkeys(("critical_speed_rpm", "peak_um", "amplification_factor", "damping_ratio"), NUMBER),
    },
    "events": {"t_s": NUMBER, "kind": TEXT, "text": TEXT},
}
FIRST_DAY = datetime(2024, 3, 1, 9, 30, tzinfo=UTC)
DAYS = 730
RIGS = ("RK4 at the window", "RK4 in the cellar", "KFUPM kit")
STIFFNESS = 34_000.0  # N/m of the first rig on the first day ...
SOFTENS = 4_000.0  # ... and what it loses in two years; the others keep theirs
FAILURES = (
    "probe 2y: no voltage within -1.0 to -19.0 V in 8 s, want a probe that is connected",
    "keyphasor: 3 edges in 41 s, want one per turn",
    "run.mcap ends within a block, want what `rotor salvage` makes of it",
)


def hash_of(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:16]


def write_run(lab: Path, name: str, *, key: str = "first", made_at: datetime = FIRST_DAY, **tables: Any) -> str:
    """Write one task's part-files and return its run_id; `runs` overrides columns of a run that failed early.

    `estimates`, `causes`, `peaks` and `events` are lists of rows, of which a missing column is empty.
    """
    common = {"run_id": hash_of(name), "key": hash_of(name + key), "code_version": "0.1.0", "made_at": made_at}
    run = {"file": name, "recorded_at": made_at, "rig": RIGS[0], "kind": "run", "status": "failed", "step": "track"}
    rows = {"runs": [{**run, "verdict": "", "sentence": "", **tables.pop("runs", {})}], **tables}
    for table, its in rows.items():
        folder = lab / "lab" / "catalogue" / table
        folder.mkdir(parents=True, exist_ok=True)
        full = pa.Table.from_pylist([{**common, **row} for row in its], schema=pa.schema({**COMMON, **SCHEMAS[table]}))
        pa.parquet.write_table(full, folder / f"{common['run_id']}-{common['key']}.parquet")
    return str(common["run_id"])


def estimate(name: str, value: float, sigma: float, unit: str, nameplate: float, **more: Any) -> dict[str, Any]:
    """A row whose interval is two sigmas to either side."""
    ends = {"low95": value - 2 * sigma, "high95": value + 2 * sigma}
    row = {"fit": "whole sweep", "name": name, "value": value, "sigma": sigma, "unit": unit, "nameplate": nameplate}
    return {**row, **ends, "determined": True, **more}


def make_lab(lab: Path, *, runs: int = 1000, seed: int = 1, response: Path | None = None, responses: int = 0) -> None:
    """Write the catalogue of two years: three rigs, the first of which softens, one run in twelve failed.

    Of those that did not, the last `responses` have the file `response`, by links.
    """
    rng = np.random.default_rng(seed)
    for i in range(runs):
        rig = i % 7 % len(RIGS)
        when = FIRST_DAY + timedelta(days=DAYS * i / runs, hours=float(rng.uniform(0, 8)))
        name = f"{when:%Y-%m}/{('window', 'cellar', 'kit')[rig]}-{i:04d}/run.mcap"
        run: dict[str, Any] = {
            "recorded_at": when,
            "rig": RIGS[rig],
            "config_hash": hash_of(RIGS[rig]),
            "nameplate_hash": "0" * 16,
        }
        if rng.random() < 1 / 12:
            sentence = FAILURES[int(rng.integers(len(FAILURES)))]
            write_run(lab, name, made_at=when, runs={**run, "step": "track", "sentence": sentence})
            continue
        if response and i >= runs - responses:
            copy = lab / "lab" / "results" / hash_of(name) / "response.mcap"
            copy.parent.mkdir(parents=True)
            copy.hardlink_to(response)
            run["response_file"] = copy.relative_to(lab).as_posix()
        softer = SOFTENS * i / runs if rig == 0 else 0.0
        _write_finished_run(lab, name, run, kxx=STIFFNESS - softer - 1500 * rig, when=when, rng=rng)


def _write_finished_run(
    lab: Path, name: str, run: dict[str, Any], *, kxx: float, when: datetime, rng: np.random.Generator
) -> None:
    bowed = bool(rng.random() < 0.15)
    critical = 2230.0 * (kxx / STIFFNESS) ** 0.5
    cause = {"rank": 1, "label": "bow", "effect": "bow", "place": "shaft", "chosen": bowed, "evidence": 31.0 * bowed}
    peaks = [
        {"run": way, "probe": probe, "critical_speed_rpm": critical * shift, "peak_um": 180.0 * gain + rng.normal(0, 4)}
        | {"amplification_factor": 12.5 + rng.normal(0, 0.4), "damping_ratio": 0.04}
        for way, shift in (("up", 1.004), ("down", 0.997))
        for probe, gain in (("1x", 1.0), ("1y", 0.97), ("2x", 0.31), ("2y", 0.30))
    ]
    words = "The shaft is bowed by 21 ± 2 µm at the disk." if bowed else "The model is adequate."
    done = {"status": "done", "step": "report", "verdict": "named" if bowed else "adequate", "sentence": words}
    values = {"duration_s": 173.6, "lowest_speed_rpm": 480.0, "highest_speed_rpm": 3600.0, "rows": 632, "probes": 4}
    fitted = {"chi2_per_dof": 1.0, "residual_um": 0.15 + abs(rng.normal(0, 0.02)) + 0.4 * bowed, "noise_um": 0.14}
    write_run(
        lab,
        name,
        made_at=when,
        runs={**run, **done, **values, **fitted},
        estimates=[
            estimate("kxx", kxx + rng.normal(0, 300), 300.0, "N/m", 33_900.0),
            estimate("kyy", kxx + 600 + rng.normal(0, 300), 300.0, "N/m", 34_600.0),
            estimate("cxx", 15.0 + rng.normal(0, 0.6), 0.6, "N s/m", 15.0),
            estimate("cyy", 15.0 + rng.normal(0, 0.6), 0.6, "N s/m", 15.0),
            estimate("u", 1.5e-5 + rng.normal(0, 2e-7), 2e-7, "kg m", 1.5e-5),
            estimate("phase", rng.normal(0.7, 0.01), 0.01, "rad", 0.0),
        ],
        causes=[{**cause, "words": "the shaft is bowed by 21 µm", "explained": 0.9 * bowed}],
        peaks=peaks,
    )


def add_real_run(lab: Path, results: Path, *, when: datetime, name: str) -> str:
    """Put a run among them from the response.mcap, fit.json, diagnosis.json and report.html that stand in `results`.

    Their paths in the catalogue are relative to the lab, which `results` is a folder of. Returns the run_id.
    """
    response = read_response(results / "response.mcap")
    fit = read_identification(results / "fit.json").fits[0]
    diagnosis = read_diagnosis(results / "diagnosis.json")
    files = {f"{kind}_file": _within(lab, results / path) for kind, path in _FILES.items()}
    residual = diagnosis.residual[:, :, response.orders.index(1.0)][response.usable]
    run = {
        **{"rig": response.rig.name, "config_hash": response.rig.hash, "nameplate_hash": response.rig.hash},
        **{"status": "done", "step": "report", "recorded_at": when, "kind": "run"},
        **{"verdict": str(diagnosis.verdict), "sentence": diagnosis.sentence, "chi2_per_dof": fit.chi2 / fit.dof},
        "residual_um": float(np.sqrt(np.nanmean(np.abs(residual) ** 2))) * UM,
        "noise_um": diagnosis.noise_floor * UM,
        **{"duration_s": float(np.ptp(response.t)), "rows": len(response.t), "probes": len(response.probes)},
    }
    estimates = [
        estimate(e.name, e.value, e.sigma, e.unit, e.nameplate, determined=e.determined)
        | ({"low95": e.interval[0], "high95": e.interval[1]} if e.interval else {})
        for e in fit.estimates
    ]
    causes = [
        {"rank": i, "label": c.label, "effect": c.effect, "place": c.where, "chosen": c.chosen, "words": c.words}
        for i, c in enumerate(diagnosis.causes, start=1)
    ]
    peaks = [
        {"run": curve.run, "probe": probe, **_peak(curve.rpm, curve.amplitude)}
        for p, probe in enumerate(response.probes)
        for curve in curves(response, p)
    ]
    return write_run(lab, name, made_at=when, runs={**run, **files}, estimates=estimates, causes=causes, peaks=peaks)


_FILES = {"response": "response.mcap", "fit": "fit.json", "diagnosis": "diagnosis.json", "report": "report.html"}


def _within(lab: Path, path: Path) -> str | None:
    return path.relative_to(lab).as_posix() if path.exists() else None


def _peak(rpm: Sequence[float], amplitude: Sequence[float]) -> dict[str, float]:
    top = int(np.nanargmax(amplitude))
    above = np.asarray(rpm)[np.asarray(amplitude) > amplitude[top] / np.sqrt(2)]
    width = float(np.ptp(above))
    return {"critical_speed_rpm": float(rpm[top]), "peak_um": float(amplitude[top])} | (
        {"amplification_factor": float(rpm[top]) / width} if width > 0 else {}
    )
