"""Certificate of a proof test: a JSON file, bound to a config by its hash. Its keys are listed in docs/files.md."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import Any

from rotorrig.rig import DataError, write_whole_text

KIND = "rotorrig proof test"
VERSION = 1


class Verdict(StrEnum):
    """Outcome of one part."""

    PASSED = "passed"
    FAILED = "failed"
    NOT_AVAILABLE = "not available"  # the rig has none
    NOT_TESTED = "not tested"  # the test ended before


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """What became of one protection; times in s since it was provoked, NaN: not seen."""

    name: str
    provocation: str
    verdict: Verdict
    why: str = ""  # of a verdict other than passed
    remark: str = ""  # what the drive said afterwards
    at_rest: bool = True  # the rotor, at the end; False: the operator has left it
    decided_after: float = math.nan  # the program's stop; NaN: the drive had to act by itself
    slowing_after: float = math.nan
    rest_after: float = math.nan
    decided_within: float = math.nan  # asked for
    slowing_within: float = math.nan
    rest_within: float = math.nan
    resolution: float = math.nan  # of times seen: a turn


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate:
    """Outcome of a proof test."""

    date: datetime  # UTC
    rig: str
    config_hash: str
    code_version: str
    simulated: bool
    drive: str  # model
    drive_link: str
    drive_watchdog: float | None  # s; None: it has none
    daq: str  # model and serial number
    speed: float  # rad/s, at which protections were provoked
    proofs: tuple[Proof, ...]

    @property
    def passed(self) -> bool:
        """Whether every protection that the rig has stopped the rotor in time."""
        return all(proof.verdict in (Verdict.PASSED, Verdict.NOT_AVAILABLE) for proof in self.proofs)

    @property
    def failed(self) -> tuple[str, ...]:
        """Names of the protections that failed, and of those that were not tested."""
        return tuple(proof.name for proof in self.proofs if proof.verdict in (Verdict.FAILED, Verdict.NOT_TESTED))


def certificate_file(config: Path) -> Path:
    """Return where the certificate of a config stands: beside it; of a bundled one, given by its name, here.

    >>> certificate_file(Path("rigs/lab.toml")).as_posix(), certificate_file(Path("rk4")).as_posix()
    ('rigs/lab.proof.json', 'rk4.proof.json')
    """
    return config.with_name(f"{config.name.removesuffix('.toml')}.proof.json")


def certificate_facts(certificate: Certificate) -> dict[str, Any]:
    """Return a certificate as plain values, as they stand in its file."""
    return {
        "kind": KIND,
        "version": VERSION,
        "date": certificate.date.astimezone(UTC).isoformat(timespec="seconds"),
        "passed": certificate.passed,
        "rig": certificate.rig,
        "config_hash": certificate.config_hash,
        "code_version": certificate.code_version,
        "simulated": certificate.simulated,
        "drive": {
            "model": certificate.drive,
            "link": certificate.drive_link,
            "watchdog_s": certificate.drive_watchdog,
        },
        "daq": certificate.daq,
        "speed_rad_s": certificate.speed,
        "protections": [_proof_facts(proof) for proof in certificate.proofs],
    }


def write_certificate(path: Path, certificate: Certificate) -> None:
    """Write a certificate, whole or not at all. Raises DataError."""
    write_whole_text(path, json.dumps(certificate_facts(certificate), indent=2) + "\n")


def read_certificate(path: Path) -> Certificate:
    """Read a certificate. Raises DataError."""
    try:
        table = json.loads(path.read_bytes())
        if table["kind"] != KIND or table["version"] != VERSION:
            raise ValueError(f"kind {table['kind']!r}, version {table['version']!r}")
        return _certificate(table)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror})") from error
    except (KeyError, TypeError, ValueError, RecursionError) as error:
        raise DataError(
            f"{path}: is no certificate of version {VERSION} ({error}), want one of rotor check --proof-test"
        ) from error


_TIMES = (
    "decided_after",
    "slowing_after",
    "rest_after",
    "decided_within",
    "slowing_within",
    "rest_within",
    "resolution",
)


def _proof_facts(proof: Proof) -> dict[str, Any]:
    facts = asdict(proof)
    times = {f"{name}_s": facts.pop(name) for name in _TIMES}
    return facts | {name: None if math.isnan(value) else round(value, 4) for name, value in times.items()}


def _certificate(table: Mapping[str, Any]) -> Certificate:
    drive = table["drive"]
    return Certificate(
        date=datetime.fromisoformat(table["date"]),
        rig=str(table["rig"]),
        config_hash=str(table["config_hash"]),
        code_version=str(table["code_version"]),
        simulated=bool(table["simulated"]),
        drive=str(drive["model"]),
        drive_link=str(drive["link"]),
        drive_watchdog=drive["watchdog_s"],
        daq=str(table["daq"]),
        speed=float(table["speed_rad_s"]),
        proofs=tuple(_proof(part) for part in table["protections"]),
    )


def _proof(part: Mapping[str, Any]) -> Proof:
    texts: Any = {name: str(part[name]) for name in ("name", "provocation", "why", "remark")}
    times: Any = {name: math.nan if (value := part[f"{name}_s"]) is None else float(value) for name in _TIMES}
    return Proof(verdict=Verdict(part["verdict"]), at_rest=bool(part["at_rest"]), **texts, **times)
