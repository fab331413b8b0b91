"""Pulls and findings about the config, as fit.json and diagnosis.json both have them."""

from typing import Any

from rotorrig.identify.identification import Deviation, NameplateCheck, NameplateFinding, Pull
from rotorrig.identify.result_files.plain_json import fields_of, infinite, number

_DEVIATION = "label kind where title words value sigma unit nameplate nameplate_unit pull evidence nuisances parameter"


def nameplate_out(check: NameplateCheck) -> dict[str, Any]:
    """Return the table of a check."""
    return {
        "pulls": [
            {**fields_of(pull, "group sigmas"), "deviations": [fields_of(d, _DEVIATION) for d in pull.deviations]}
            for pull in check.pulls
        ],
        "findings": [
            {
                **fields_of(finding, "group sigmas words"),
                "deviation": fields_of(finding.deviation, _DEVIATION),
                "alternatives": [fields_of(d, _DEVIATION) for d in finding.alternatives],
            }
            for finding in check.findings
        ],
    }


def nameplate_in(table: dict[str, Any]) -> NameplateCheck:
    """Return the check in a file; an older one has none."""
    return NameplateCheck(
        pulls=tuple(
            Pull(group=p["group"], sigmas=float(p["sigmas"]), deviations=tuple(map(_deviation, p["deviations"])))
            for p in table.get("pulls", ())
        ),
        findings=tuple(
            NameplateFinding(
                group=f["group"],
                sigmas=float(f["sigmas"]),
                deviation=_deviation(f["deviation"]),
                alternatives=tuple(map(_deviation, f["alternatives"])),
            )
            for f in table.get("findings", ())
        ),
    )


def _deviation(table: dict[str, Any]) -> Deviation:
    given = {name: value for name, value in table.items() if name != "label"}
    given |= {"sigma": infinite(table["sigma"]), "nameplate": number(table["nameplate"])}
    return Deviation(**{**given, "nuisances": tuple(table["nuisances"])})
