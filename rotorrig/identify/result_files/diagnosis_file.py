"""`diagnosis.json`: a `Diagnosis` and back."""

from pathlib import Path
from typing import Any

from rotorrig.identify.adequacy import Misfit
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.result_files.missing_table import missing_in, missing_out
from rotorrig.identify.result_files.nameplate_table import nameplate_in, nameplate_out
from rotorrig.identify.result_files.plain_json import (
    DIAGNOSIS,
    complex_in,
    complex_out,
    fields_of,
    infinite,
    number,
    numbers_in,
    numbers_out,
    read_table,
    write_table,
)
from rotorrig.identify.result_files.resonance_table import resonances_in, resonances_out
from rotorrig.identify.verdict import Cause, Gain, HiddenEffect, NextRun, ParameterValue, Shift
from rotorrig.rig import DataError, Provenance

_CAUSE = (
    "label where title words chosen plausible evidence lam heldout_before heldout_after theta sigmas nameplate given_up"
)


def write_diagnosis(path: Path, diagnosis: Diagnosis) -> None:
    """Write diagnosis.json. Raises DataError if the file cannot be written."""
    extended, extended_sigmas = diagnosis.extended_residual, diagnosis.extended_sigmas
    arrays = {
        "residual": complex_out(diagnosis.residual),
        "sigmas": numbers_out(diagnosis.sigmas),
        "extended_residual": None if extended is None else complex_out(extended),
        "extended_sigmas": None if extended_sigmas is None else numbers_out(extended_sigmas),
    }
    write_table(path, DIAGNOSIS, {**diagnosis_table(diagnosis), **arrays}, diagnosis.source)


_NEXT_RUN = "kind words lam separates top ramp speeds minutes trial share_of_limit"


def diagnosis_table(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return what diagnosis.json holds, less its arrays and its provenance."""
    misfit = "run probe order speed_from speed_to sigma residual relative phase backward other_run sentence"
    return {
        "verdict": str(diagnosis.verdict),
        **fields_of(diagnosis, "sentence model false_alarm_rate noise_floor"),
        "base": {**fields_of(diagnosis, "chi2 dof p"), "worst": [fields_of(m, misfit) for m in diagnosis.worst]},
        "causes": [_cause_out(cause) for cause in diagnosis.causes],
        **fields_of(diagnosis, "tied"),
        "nameplate": nameplate_out(diagnosis.nameplate),
        "next_run": {} if diagnosis.next_run is None else fields_of(diagnosis.next_run, _NEXT_RUN),
        "gain": {} if diagnosis.gain is None else _gain_out(diagnosis.gain),
        "hidden": [fields_of(effect, "effect smallest unit missing") for effect in diagnosis.hidden],
        "resonances": resonances_out(diagnosis.resonances),
        "missing": {} if diagnosis.missing is None else missing_out(diagnosis.missing),
        **fields_of(diagnosis, "character cut_short responses"),
    }


def read_diagnosis(path: Path) -> Diagnosis:
    """Read diagnosis.json. Raises DataError naming the file if it is not one."""
    table = read_table(path, DIAGNOSIS)
    try:
        base = table["base"]
        worst = tuple(
            Misfit(**{**m, **{key: number(m.get(key)) for key in ("relative", "phase", "backward")}})
            for m in base["worst"]
        )
        return Diagnosis(
            verdict=Verdict(table["verdict"]),
            sentence=table["sentence"],
            model=table["model"],
            false_alarm_rate=number(table["false_alarm_rate"]),
            noise_floor=number(table["noise_floor"]),
            chi2=number(base["chi2"]),
            dof=int(base["dof"]),
            p=number(base["p"]),
            worst=worst,
            residual=complex_in(table["residual"]),
            sigmas=numbers_in(table["sigmas"]),
            causes=tuple(_cause(cause) for cause in table["causes"]),
            tied=tuple(tuple(t) for t in table["tied"]),
            next_run=_next_run(table["next_run"]) if table["next_run"] else None,
            gain=_gain(table["gain"]) if table["gain"] else None,
            nameplate=nameplate_in(table.get("nameplate", {})),
            hidden=tuple(_hidden(effect) for effect in table["hidden"]),
            missing=missing_in(table["missing"]) if table.get("missing") else None,
            character=table["character"],
            cut_short=bool(table.get("cut_short", False)),
            extended_residual=None if (after := table["extended_residual"]) is None else complex_in(after),
            extended_sigmas=None if (after := table.get("extended_sigmas")) is None else numbers_in(after),
            resonances=resonances_in(table.get("resonances", ())),
            responses=tuple((str(source), int(rows)) for source, rows in table["responses"]),
            source=Provenance(**table["source"]),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise DataError(
            f"{path}: is damaged or of another version ({error!r}); make it anew by rotor diagnose"
        ) from error


def _cause_out(cause: Cause) -> dict[str, Any]:
    parameters = {name: fields_of(figure, "value unit sigma") for name, figure in cause.parameters.items()}
    return {"name": cause.effect, **fields_of(cause, _CAUSE), "parameters": parameters}


def _cause(table: dict[str, Any]) -> Cause:
    parameters = {
        name: ParameterValue(value=number(f["value"]), unit=f["unit"], sigma=infinite(f["sigma"]))
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
        evidence=number(table["evidence"]),
        lam=number(table["lam"]),
        heldout_before=number(table["heldout_before"]),
        heldout_after=number(table["heldout_after"]),
        parameters=parameters,
        theta={name: float(value) for name, value in table["theta"].items()},
        sigmas={name: infinite(value) for name, value in table["sigmas"].items()},
        nameplate=bool(table.get("nameplate", False)),
        given_up=bool(table.get("given_up", False)),
    )


def _gain_out(gain: Gain) -> dict[str, Any]:
    base = {name: fields_of(shift, "before after sigma unit") for name, shift in gain.base.items()}
    return {**fields_of(gain, "heldout_before heldout_after noise_floor over_noise_floor on"), "base": base}


def _gain(table: dict[str, Any]) -> Gain:
    return Gain(
        heldout_before=number(table["heldout_before"]),
        heldout_after=number(table["heldout_after"]),
        noise_floor=number(table["noise_floor"]),
        on=table["on"],
        base={name: _shift(shift) for name, shift in table["base"].items()},
    )


def _shift(table: dict[str, Any]) -> Shift:
    before, after = (number(table[key]) for key in ("before", "after"))
    return Shift(before=before, after=after, sigma=infinite(table["sigma"]), unit=table["unit"])


def _next_run(table: dict[str, Any]) -> NextRun:
    """Return the next run; an older file has its words alone."""
    numbers = {key: number(table[key]) for key in ("top", "ramp", "minutes", "share_of_limit") if key in table}
    return NextRun(
        kind=table["kind"],
        words=table["words"],
        lam=number(table["lam"]),
        separates=tuple(table["separates"]),
        trial=tuple(table.get("trial", ())),
        speeds=tuple(number(speed) for speed in table.get("speeds", ())),
        **numbers,
    )


def _hidden(table: dict[str, Any]) -> HiddenEffect:
    smallest = infinite(table["smallest"])
    return HiddenEffect(effect=table["effect"], smallest=smallest, unit=table["unit"], missing=table["missing"])
