"""Write the figures of docs/measured-run-up.md and its picture: what a moving speed does to a measured run-up.

`python -m docs.make_measured_run_up` takes about a minute and replaces what stands between the marks of that file.
"""

import textwrap
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from docs.origin import origin
from docs.svg_plot import COLOURS, INK, Figure
from rotorrig.identify import Diagnosis, base_fit, diagnose
from rotorrig.identify.base_fit import AssessedFit
from rotorrig.identify.extended_model import Recording
from rotorrig.identify.verdict.cross_validation import Prediction, cross_validate
from rotorrig.processing import OrderTrackedResponse
from rotorrig.processing.files import read_table
from rotorrig.rig.config import RPM, load

ROOT = Path(__file__).parents[1]
DATA = ROOT / "tests/data/kfupm-rk4"
DOCUMENT = ROOT / "docs/measured-run-up.md"
PICTURE = ROOT / "docs/img/measured-run-up.svg"
COMMAND = "python -m docs.make_measured_run_up"
BEGIN, END = "<!-- figures: begin -->\n", "<!-- figures: end -->\n"
UM = 1e6


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """The base model fitted to the run-up, with the speed taken as steady or as it moved."""

    name: str
    fit: AssessedFit
    unseen: Prediction  # of revolutions in blocks, each predicted by a fit to the others

    @property
    def estimates(self) -> dict[str, float]:
        """Bearing coefficients, SI."""
        names = self.fit.problem.parameters.base
        return dict(zip(names.space.names, names.values(self.fit.polished.p[: len(names)]), strict=True))


def measured() -> OrderTrackedResponse:
    """Return the run-up as `rotor import` reads it."""
    rig = load(ROOT / "configs/kfupm-rk4.toml")
    return read_table(DATA / "runup_bode_1037_2610rpm.csv", DATA / "mapping.toml", rig)


def models(response: OrderTrackedResponse) -> tuple[Model, Model]:
    """Return the quasi-static and the swept base model."""
    fits = [base_fit.fit_base([Recording(response, swept=swept)]) for swept in (False, True)]
    still, swept = (cross_validate(fit.problem, fit.polished.p) for fit in fits)
    return (
        Model(name="quasi-static", fit=fits[0], unseen=still),
        Model(name="swept", fit=fits[1], unseen=swept),
    )


def main() -> None:
    """Put the figures into the document and draw the picture."""
    response = measured()
    both, found = models(response), diagnose([response], model="quasi-static")
    before, _, rest = DOCUMENT.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    DOCUMENT.write_text(f"{before}{BEGIN}{text(both, found)}{END}{after}", encoding="utf-8")
    print(f"{DOCUMENT}: written")
    picture(response, both, found).save(PICTURE, origin=origin(COMMAND, response.rig.hash))


def text(both: tuple[Model, Model], found: Diagnosis) -> str:
    """Return the sentence of the diagnosis and the table, in Markdown."""
    chosen = [cause.label for cause in found.causes if cause.chosen]
    lines = [
        *textwrap.wrap(found.sentence, 118, initial_indent="> ", subsequent_indent="> "),
        "",
        "| model | 1X residuals over their scatter | worst stretch | error on unseen data, 0-peak "
        "| times the noise floor |",
        "|---|---|---|---|---|",
        *(_row(model) for model in both),
    ]
    if found.gain:
        error, over = f"{found.gain.heldout_after * UM:.3g} um", f"{found.gain.over_noise_floor:.2g}"
        lines.append(f"| swept, with {'; '.join(chosen)} | | | {error} | {over} |")
    lines += ["", "| model | kxx [kN/m] | kyy [kN/m] | cxx [N s/m] | cyy [N s/m] |", "|---|---|---|---|---|"]
    lines += [f"| {model.name} | {' | '.join(_coefficients(model))} |" for model in both]
    if found.tied:
        lines += ["", "Tied, for all this data can tell:", ""]
        lines += [f"- {'; '.join(group)}" for group in found.tied]
    lines += ["", *textwrap.wrap(found.character, 120)] if found.character else []
    return "\n".join(lines) + "\n"


def _row(model: Model) -> str:
    adequacy, unseen = model.fit.adequacy, model.unseen
    fit = f"{adequacy.scatter_ratio:.3g} | {adequacy.worst_sigma:.2g} sigma"
    return f"| {model.name} | {fit} | {unseen.error * UM:.3g} um | {unseen.over_floor:.2g} |"


def _coefficients(model: Model) -> list[str]:
    return [f"{value / (1e3 if name.startswith('k') else 1):.3g}" for name, value in model.estimates.items()]


def picture(response: OrderTrackedResponse, both: tuple[Model, Model], found: Diagnosis) -> Figure:
    """Draw the amplitude above, what each model leaves of it below."""
    figure = Figure(width=720, height=560)
    rpm, z = response.omega * RPM, response.order(1.0)[:, 0]
    left = [model.fit.adequacy.residual[:, 0, 0] for model in both]
    ends = (float(rpm.min()), float(rpm.max()))
    above = figure.panel((70, 30, 620, 240), x=ends, y=(0, 1.15 * UM * np.abs(z).max()), ylabel="1X [um 0-peak]")
    above.points(np.column_stack([rpm, UM * np.abs(z)]), colour=INK)
    for part, colour in zip(left, COLOURS, strict=False):
        above.line(rpm, UM * np.abs(z - part), colour=colour)
    loudest = max(float(np.nanmax(np.abs(part))) for part in left)
    below = figure.panel(
        (70, 310, 620, 200), x=ends, y=(0, 1.1 * UM * loudest), xlabel="speed [rpm]", ylabel="measured less model [um]"
    )
    for part, colour in zip([*left, *_extended(found)], COLOURS, strict=False):
        below.line(rpm, UM * np.abs(part), colour=colour)
    entries = [
        (INK, "measured, one row per revolution"),
        *zip(COLOURS, [f"{m.name} model" for m in both], strict=False),
    ]
    if _extended(found):
        entries.append((COLOURS[2], "swept model, with the causes (below only)"))
    figure.key(390, 56, entries)
    return figure


def _extended(found: Diagnosis) -> list[NDArray[np.complex128]]:
    return [] if found.extended_residual is None else [found.extended_residual[:, 0, 0]]


if __name__ == "__main__":
    main()
