"""Write the convergence tables of docs/rotor-model.md: how many shaft elements each mass model needs.

Run as `python -m docs.make_convergence`; it replaces what stands between the two marks of that file. Errors are against
consistent elements of a hundredth of the shaft's length: critical speeds relative to their own, the response to
unbalance relative to its peak over the range.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from threadpoolctl import threadpool_limits

from rotorrig.rig.config import RPM, RigConfig, load
from rotorrig.sims.rotor.model import RotorModel, assemble
from rotorrig.sims.rotor.model.beam import Element
from rotorrig.sims.rotor.modes import critical_speeds
from rotorrig.sims.rotor.steady.harmonic_response import probe_response

ROOT = Path(__file__).parents[1]
DOCUMENT = ROOT / "docs" / "rotor-model.md"
BEGIN, END = "<!-- convergence: begin -->\n", "<!-- convergence: end -->\n"
REFERENCE = 100  # elements, at the least
LENGTHS = (1.0, 0.1, 0.05, 0.02, 0.01)  # m; the first leaves only the nodes that the parts need
SPEEDS = 60  # of the response
PLACES = 2  # significant digits


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A rotor, and how far up it is compared."""

    title: str
    config: Path
    response: tuple[float, float]  # rpm
    criticals: int  # lowest ones


CASES = (
    Case(title="RK4 (configs/rk4.toml)", config=ROOT / "configs/rk4.toml", response=(480, 3600), criticals=4),
    Case(
        title="Three disks of Lalanne and Ferraris (benchmarks/lalanne.toml)",
        config=ROOT / "benchmarks/lalanne.toml",
        response=(1000, 12_000),
        criticals=4,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """The errors of both mass models on one mesh, each a part of 1."""

    elements: int
    first: dict[str, float]  # mass model -> of the first critical speed
    worst: dict[str, float]  # .. of the worst of those compared
    response: dict[str, float]  # .. of the peak response


@threadpool_limits.wrap(limits=1, user_api="blas")
def rows(case: Case, lengths: tuple[float, ...] = LENGTHS) -> tuple[Row, ...]:
    """Return the table of a case, a row for each longest element [m]."""
    rig = load(case.config)
    exact = _figures(assemble(rig, max_element=rig.shaft.length / REFERENCE), rig, case)
    return tuple(_row(rig, case, length, exact) for length in lengths)


def text() -> str:
    """Return both tables in Markdown."""
    return "\n".join(_table(case, rows(case)) for case in CASES)


def main() -> None:
    """Put the tables into the document."""
    before, _, rest = DOCUMENT.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    DOCUMENT.write_text(f"{before}{BEGIN}{text()}{END}{after}", encoding="utf-8")
    print(f"{DOCUMENT}: written")


def _row(rig: RigConfig, case: Case, length: float, exact: tuple[np.ndarray, np.ndarray]) -> Row:
    elements, errors = 0, {}
    for element in get_args(Element):
        model = assemble(rig, element=element, max_element=length)
        elements = len(model.z) - 1
        criticals, z = _figures(model, rig, case)
        errors[element] = (np.abs(criticals / exact[0] - 1), np.abs(z - exact[1]).max() / np.abs(exact[1]).max())
    return Row(
        elements=elements,
        first={element: float(off[0]) for element, (off, _) in errors.items()},
        worst={element: float(off.max()) for element, (off, _) in errors.items()},
        response={element: float(off) for element, (_, off) in errors.items()},
    )


def _figures(model: RotorModel, rig: RigConfig, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest critical speeds and the response at the probes, (speed, probe)."""
    omega = np.linspace(*case.response, SPEEDS) / RPM
    criticals = critical_speeds(model, up_to=2 * omega[-1])[: case.criticals]
    return criticals, probe_response(model, omega, unbalance={rig.disks[0].name: 1e-5})


def _table(case: Case, table: tuple[Row, ...]) -> str:
    lines = [
        f"**{case.title}**: response {case.response[0]:.0f} to {case.response[1]:.0f} rpm, "
        f"{case.criticals} critical speeds",
        "",
        "| | consistent (Timoshenko) | | | lumped (the chapter's) | | |",
        "|---|---|---|---|---|---|---|",
        "| elements | first critical | worst critical | response | first critical | worst critical | response |",
    ]
    lines += [line(row) for row in table]
    return "\n".join(lines) + "\n"


def line(row: Row) -> str:
    """Return one row in Markdown."""
    errors = [part[element] for element in get_args(Element) for part in (row.first, row.worst, row.response)]
    return f"| {row.elements} | " + " | ".join(f"{error:.{PLACES - 1}e}" for error in errors) + " |"


if __name__ == "__main__":
    main()
