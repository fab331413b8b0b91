"""`fit.json`: an `Identification` and back."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from rotorrig.identify.identification import (
    Direction,
    Estimate,
    Fit,
    Identification,
    Optimum,
    SearchTrace,
    Stage,
    TrialAngles,
)
from rotorrig.identify.result_files.nameplate_table import nameplate_in, nameplate_out
from rotorrig.identify.result_files.plain_json import (
    FIT,
    complex_in,
    complex_out,
    fields_of,
    finite,
    infinite,
    number,
    numbers_in,
    numbers_out,
    pair,
    read_table,
    write_table,
)
from rotorrig.identify.result_files.resonance_table import resonances_in, resonances_out
from rotorrig.rig import DataError, Provenance

_ESTIMATE = "name value sigma unit nameplate pull determined bounds interval interval_by"
_FIRST_UNKNOWNS = ("kxx", "kyy", "cxx", "cyy", "u")  # of files that do not name them


def write_identification(path: Path, identification: Identification) -> None:
    """Write fit.json. Raises DataError if the file cannot be written."""
    table = identification_table(identification)
    for of_file, fit in zip(table["fits"], identification.fits, strict=True):
        of_file["prediction"] = complex_out(fit.prediction)
        of_file["search"] |= {"heads": numbers_out(fit.trace.heads), "points": numbers_out(fit.trace.points)}
    write_table(path, FIT, table, identification.source)


def identification_table(identification: Identification) -> dict[str, Any]:
    """Return what fit.json holds, less its arrays and its provenance."""
    fits = [
        {
            "name": fit.name,
            "band": list(fit.band),
            "estimates": [fields_of(e, _ESTIMATE) for e in fit.estimates],
            "nuisances": [fields_of(e, _ESTIMATE) for e in fit.nuisances],
            "unknowns": list(fit.unknowns),
            "optima": [{"theta": list(o.theta), "cost": o.cost} for o in fit.optima],
            "directions": [fields_of(d, "weights sigma sigma_of_noise") for d in fit.directions],
            "budget": fit.budget,
            "words": list(fit.words),
            "nameplate": nameplate_out(fit.nameplate),
            "resonances": resonances_out(fit.resonances),
            "search": _trace_out(fit.trace),
            **fields_of(fit, "objective evaluations stop seed chi2 dof p scatter_ratio adequate"),
        }
        for fit in identification.fits
    ]
    angles = identification.trial_angles
    told = {"trial_angles": finite(asdict(angles)) if angles else None}
    return {**fields_of(identification, "effects responses wall_s"), **told, "fits": fits}


def read_identification(path: Path) -> Identification:
    """Read fit.json. Raises DataError naming the file if it is not one."""
    table = read_table(path, FIT)
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
                p=number(f.get("p")),
                scatter_ratio=number(f.get("scatter_ratio")),
                adequate=bool(f.get("adequate", True)),
                prediction=complex_in(f["prediction"]),
                directions=tuple(_direction(d) for d in f.get("directions", ())),
                budget=f.get("budget", {}),
                trace=_trace_in(f["search"]) if "search" in f else SearchTrace(),
                words=tuple(f["words"]),
                nameplate=nameplate_in(f.get("nameplate", {})),
                resonances=resonances_in(f.get("resonances", ())),
            )
            for f in table["fits"]
        )
        source = Provenance(**table["source"])
        return Identification(
            fits=fits,
            trial_angles=TrialAngles(**table["trial_angles"]) if table.get("trial_angles") else None,
            effects=tuple(table["effects"]),
            responses=tuple((str(of), int(rows)) for of, rows in table.get("responses", ())),
            wall_s=float(table["wall_s"]),
            source=source,
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DataError(
            f"{path}: is damaged or of another version ({error!r}); make it anew by rotor identify"
        ) from error


def _estimate(table: dict[str, Any]) -> Estimate:
    return Estimate(
        name=table["name"],
        value=float(table["value"]),
        sigma=infinite(table["sigma"]),
        unit=table["unit"],
        nameplate=number(table["nameplate"]),
        pull=number(table.get("pull")),
        determined=bool(table["determined"]),
        bounds=pair(table.get("bounds")),
        interval=pair(table.get("interval")),
        interval_by=table.get("interval_by", ""),
    )


def _direction(table: dict[str, Any]) -> Direction:
    return Direction(
        weights=table["weights"],
        sigma=infinite(table["sigma"]),
        sigma_of_noise=infinite(table["sigma_of_noise"]),
    )


def _trace_out(trace: SearchTrace) -> dict[str, Any]:
    return {
        "method": trace.method,
        "stages": [fields_of(stage, "name steps evaluations") for stage in trace.stages],
        "clusters": len(trace.heads),
        "reduced": trace.reduced,
    }


def _trace_in(table: dict[str, Any]) -> SearchTrace:
    return SearchTrace(
        method=table["method"],
        stages=tuple(Stage(**stage) for stage in table["stages"]),
        reduced=int(table["reduced"]),
        heads=numbers_in(table["heads"]),
        points=numbers_in(table["points"]),
    )
