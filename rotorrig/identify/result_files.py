"""`fit.json` and `diagnosis.json`: plain JSON in SI, complex arrays as {"re": ..., "im": ...}, null for "not known".

Their keys are documented in docs/results.md and stable: readers may count on them.
"""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.adequacy import Misfit
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.identification import Direction, Estimate, Fit, Identification, Optimum, SearchTrace, Stage
from rotorrig.identify.verdict import Cause, Gain, HiddenEffect, NextRun, ParameterValue, Shift
from rotorrig.rig import DataError, Provenance, write_whole_text

_FIT = "rotorrig fit"
_DIAGNOSIS = "rotorrig diagnosis"
VERSIONS = {_FIT: 1, _DIAGNOSIS: 2}
_ESTIMATE = "name value sigma unit nameplate determined bounds interval interval_by"
_CAUSE = "label where title words chosen plausible evidence lam heldout_before heldout_after theta sigmas given_up"
_FIRST_UNKNOWNS = ("kxx", "kyy", "cxx", "cyy", "u")  # of files that do not name them
CONVENTIONS = "SI units; amplitudes 0-peak; z = 2 mean(x exp(-j theta)), theta = 0 at the keyphasor edge; lag = -arg z"


def write_identification(path: Path, identification: Identification) -> None:
    """Write fit.json. Raises DataError if the file cannot be written."""
    table = identification_table(identification)
    for of_file, fit in zip(table["fits"], identification.fits, strict=True):
        of_file["prediction"] = _complex_out(fit.prediction)
        of_file["search"] |= {"heads": _numbers_out(fit.trace.heads), "points": _numbers_out(fit.trace.points)}
    _write(path, _FIT, table, identification.source)


def identification_table(identification: Identification) -> dict[str, Any]:
    """Return what fit.json holds, less its arrays and its provenance."""
    fits = [
        {
            "name": fit.name,
            "band": list(fit.band),
            "estimates": [_plain(e, _ESTIMATE) for e in fit.estimates],
            "nuisances": [_plain(e, _ESTIMATE) for e in fit.nuisances],
            "unknowns": list(fit.unknowns),
            "optima": [{"theta": list(o.theta), "cost": o.cost} for o in fit.optima],
            "directions": [_plain(d, "weights sigma sigma_of_noise") for d in fit.directions],
            "budget": fit.budget,
            "words": list(fit.words),
            "search": _trace_out(fit.trace),
            **_plain(fit, "objective evaluations stop seed chi2 dof"),
        }
        for fit in identification.fits
    ]
    return {**_plain(identification, "effects responses wall_s"), "fits": fits}


def read_identification(path: Path) -> Identification:
    """Read fit.json. Raises DataError naming the file if it is not one."""
    table = _read(path, _FIT)
    try:
        fits = tuple(
            Fit(
                name=f["name"],
                band=(float(f["band"][0]), float(f["band"][1])),
                estimates=tuple(_estimate(e) for e in f["estimates"]),
                nuisances=tuple(_estimate(e) for e in f["nuisances"]),
                unknowns=tuple(f.get("unknowns", _FIRST_UNKNOWNS)),
                optima=tuple(Optimum(theta=tuple(o["theta"]), cost=float(o["cost"])) for o in f["optima"]),
                objective=f["objective"],
                evaluations=int(f["evaluations"]),
                stop=f["stop"],
                seed=int(f["seed"]),
                chi2=float(f["chi2"]),
                dof=int(f["dof"]),
                prediction=_complex_in(f["prediction"]),
                directions=tuple(_direction(d) for d in f.get("directions", ())),
                budget=f.get("budget", {}),
                trace=_trace_in(f["search"]) if "search" in f else SearchTrace(),
                words=tuple(f["words"]),
            )
            for f in table["fits"]
        )
        source = Provenance(**table["source"])
        return Identification(
            fits=fits,
            effects=tuple(table["effects"]),
            responses=tuple((str(of), int(rows)) for of, rows in table.get("responses", ())),
            wall_s=float(table["wall_s"]),
            source=source,
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DataError(
            f"{path}: is damaged or of another version ({error!r}); make it anew by rotor identify"
        ) from error


def write_diagnosis(path: Path, diagnosis: Diagnosis) -> None:
    """Write diagnosis.json. Raises DataError if the file cannot be written."""
    extended = diagnosis.extended_residual
    arrays = {
        "residual": _complex_out(diagnosis.residual),
        "sigmas": _numbers_out(diagnosis.sigmas),
        "extended_residual": None if extended is None else _complex_out(extended),
    }
    _write(path, _DIAGNOSIS, {**diagnosis_table(diagnosis), **arrays}, diagnosis.source)


def diagnosis_table(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return what diagnosis.json holds, less its arrays and its provenance."""
    misfit = "run probe order speed_from speed_to sigma residual relative phase backward other_run sentence"
    return {
        "verdict": str(diagnosis.verdict),
        **_plain(diagnosis, "sentence model false_alarm_rate noise_floor"),
        "base": {**_plain(diagnosis, "chi2 dof p"), "worst": [_plain(m, misfit) for m in diagnosis.worst]},
        "causes": [_cause_out(cause) for cause in diagnosis.causes],
        **_plain(diagnosis, "tied"),
        "next_run": {} if diagnosis.next_run is None else _plain(diagnosis.next_run, "kind words lam separates"),
        "gain": {} if diagnosis.gain is None else _gain_out(diagnosis.gain),
        "hidden": [_plain(effect, "effect smallest unit missing") for effect in diagnosis.hidden],
        **_plain(diagnosis, "character responses"),
    }


def read_diagnosis(path: Path) -> Diagnosis:
    """Read diagnosis.json. Raises DataError naming the file if it is not one."""
    table = _read(path, _DIAGNOSIS)
    try:
        base = table["base"]
        worst = tuple(
            Misfit(**{**m, **{key: _number(m.get(key)) for key in ("relative", "phase", "backward")}})
            for m in base["worst"]
        )
        return Diagnosis(
            verdict=Verdict(table["verdict"]),
            sentence=table["sentence"],
            model=table["model"],
            false_alarm_rate=_number(table["false_alarm_rate"]),
            noise_floor=_number(table["noise_floor"]),
            chi2=_number(base["chi2"]),
            dof=int(base["dof"]),
            p=_number(base["p"]),
            worst=worst,
            residual=_complex_in(table["residual"]),
            sigmas=_numbers_in(table["sigmas"]),
            causes=tuple(_cause(cause) for cause in table["causes"]),
            tied=tuple(tuple(t) for t in table["tied"]),
            next_run=_next_run(table["next_run"]) if table["next_run"] else None,
            gain=_gain(table["gain"]) if table["gain"] else None,
            hidden=tuple(_hidden(effect) for effect in table["hidden"]),
            character=table["character"],
            extended_residual=None if (after := table["extended_residual"]) is None else _complex_in(after),
            responses=tuple((str(source), int(rows)) for source, rows in table["responses"]),
            source=Provenance(**table["source"]),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DataError(
            f"{path}: is damaged or of another version ({error!r}); make it anew by rotor diagnose"
        ) from error


def _cause_out(cause: Cause) -> dict[str, Any]:
    parameters = {name: _plain(figure, "value unit sigma") for name, figure in cause.parameters.items()}
    return {"name": cause.effect, **_plain(cause, _CAUSE), "parameters": parameters}


def _cause(table: dict[str, Any]) -> Cause:
    parameters = {
        name: ParameterValue(value=_number(f["value"]), unit=f["unit"], sigma=_infinite(f["sigma"]))
        for name, f in table["parameters"].items()
    }
    return Cause(
        effect=table["name"],
        label=table["label"],
        where=table["where"],
        title=table["title"],
        words=table["words"],
        chosen=bool(table["chosen"]),
        plausible=bool(table["plausible"]),
        evidence=_number(table["evidence"]),
        lam=_number(table["lam"]),
        heldout_before=_number(table["heldout_before"]),
        heldout_after=_number(table["heldout_after"]),
        parameters=parameters,
        theta={name: float(value) for name, value in table["theta"].items()},
        sigmas={name: _infinite(value) for name, value in table["sigmas"].items()},
        given_up=bool(table.get("given_up", False)),
    )


def _gain_out(gain: Gain) -> dict[str, Any]:
    base = {name: _plain(shift, "before after sigma unit") for name, shift in gain.base.items()}
    return {**_plain(gain, "heldout_before heldout_after noise_floor over_noise_floor on"), "base": base}


def _gain(table: dict[str, Any]) -> Gain:
    return Gain(
        heldout_before=_number(table["heldout_before"]),
        heldout_after=_number(table["heldout_after"]),
        noise_floor=_number(table["noise_floor"]),
        on=table["on"],
        base={name: _shift(shift) for name, shift in table["base"].items()},
    )


def _shift(table: dict[str, Any]) -> Shift:
    before, after = (_number(table[key]) for key in ("before", "after"))
    return Shift(before=before, after=after, sigma=_infinite(table["sigma"]), unit=table["unit"])


def _next_run(table: dict[str, Any]) -> NextRun:
    separates = tuple(table["separates"])
    return NextRun(kind=table["kind"], words=table["words"], lam=_number(table["lam"]), separates=separates)


def _hidden(table: dict[str, Any]) -> HiddenEffect:
    smallest = _infinite(table["smallest"])
    return HiddenEffect(effect=table["effect"], smallest=smallest, unit=table["unit"], missing=table["missing"])


def _estimate(table: dict[str, Any]) -> Estimate:
    return Estimate(
        name=table["name"],
        value=float(table["value"]),
        sigma=_infinite(table["sigma"]),
        unit=table["unit"],
        nameplate=_number(table["nameplate"]),
        determined=bool(table["determined"]),
        bounds=_pair(table.get("bounds")),
        interval=_pair(table.get("interval")),
        interval_by=table.get("interval_by", ""),
    )


def _direction(table: dict[str, Any]) -> Direction:
    return Direction(
        weights=table["weights"],
        sigma=_infinite(table["sigma"]),
        sigma_of_noise=_infinite(table["sigma_of_noise"]),
    )


def _pair(value: list[float] | None) -> tuple[float, float] | None:
    return (float(value[0]), float(value[1])) if value else None


def _infinite(value: float | None) -> float:
    return math.inf if value is None else float(value)


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _finite(value: Any) -> Any:
    """Return `value` as strict JSON holds it, tables and lists throughout."""
    if isinstance(value, Mapping):
        return {str(name): _finite(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(part) for part in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _trace_out(trace: SearchTrace) -> dict[str, Any]:
    return {
        "method": trace.method,
        "stages": [_plain(stage, "name steps evaluations") for stage in trace.stages],
        "clusters": len(trace.heads),
        "reduced": trace.reduced,
    }


def _trace_in(table: dict[str, Any]) -> SearchTrace:
    return SearchTrace(
        method=table["method"],
        stages=tuple(Stage(**stage) for stage in table["stages"]),
        reduced=int(table["reduced"]),
        heads=_numbers_in(table["heads"]),
        points=_numbers_in(table["points"]),
    )


def _plain(thing: object, names: str) -> dict[str, Any]:
    return {name: _finite(getattr(thing, name)) for name in names.split()}


def _numbers_out(values: NDArray[np.float64]) -> dict[str, Any]:
    """Return shape and flat list: seven digits are a thousandth of the noise."""
    return {"shape": list(values.shape), "values": [_finite(float(f"{v:.7g}")) for v in values.ravel()]}


def _numbers_in(table: dict[str, Any]) -> NDArray[np.float64]:
    return np.array([_number(v) for v in table["values"]]).reshape(table["shape"])


def _complex_out(z: NDArray[np.complex128]) -> dict[str, Any]:
    return {"re": _numbers_out(z.real), "im": _numbers_out(z.imag)}


def _complex_in(table: dict[str, Any]) -> NDArray[np.complex128]:
    return _numbers_in(table["re"]) + 1j * _numbers_in(table["im"])


def _write(path: Path, kind: str, body: dict[str, Any], source: Provenance) -> None:
    made = {name: getattr(source, name) for name in ("config_hash", "code_version", "source", "source_hash")}
    table = {"kind": kind, "version": VERSIONS[kind], "conventions": CONVENTIONS, **body, "source": made}
    write_whole_text(path, json.dumps(table, allow_nan=False) + "\n")


def _read(path: Path, kind: str) -> dict[str, Any]:
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, RecursionError) as error:
        raise DataError(f"{path}: is no JSON, want a {kind} file") from error
    if not isinstance(table, dict) or table.get("kind") != kind:
        raise DataError(f"{path}: is no {kind} file")
    if table.get("version") != VERSIONS[kind]:
        raise DataError(
            f"{path}: has version {table.get('version')!r}, this program reads {VERSIONS[kind]}; make it anew"
        )
    return table
