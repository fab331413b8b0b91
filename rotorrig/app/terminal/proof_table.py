"""Terminal table of a proof test: the times of each protection's stop, and what was asked of it."""

import math

from rich import box
from rich.table import Table

from rotorrig.acquisition.proof_test import Certificate, Proof, Verdict
from rotorrig.rig.config import RPM

_STYLES = {Verdict.PASSED: "", Verdict.FAILED: "bold red"}


def proof_table(certificate: Certificate) -> Table:
    """Return the protections with their times, s since they were provoked, and the most that was allowed."""
    table = Table(
        title=f"Proof test at {certificate.speed * RPM:.0f} rpm: seconds after each was provoked (and allowed)",
        box=box.SIMPLE_HEAD,
        title_justify="left",
    )
    table.add_column("protection", no_wrap=True)
    for heading in ("stop decided", "slower", "at rest"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for proof in certificate.proofs:
        table.add_row(proof.name, *_times(proof), proof.verdict.value, style=_STYLES.get(proof.verdict, "dim"))
    return table


def _times(proof: Proof) -> tuple[str, str, str]:
    return (
        _time(proof.decided_after, proof.decided_within),
        _time(proof.slowing_after, proof.slowing_within),
        _time(proof.rest_after, proof.rest_within),
    )


def _time(seen: float, allowed: float) -> str:
    if math.isnan(seen):
        return "-"
    return f"{seen:.2f}" if math.isnan(allowed) else f"{seen:.2f} ({allowed:.3g})"
