"""One self-contained HTML file that says what a run shows: the verdict first, then the evidence.

Everything is inside the file (plots included), nothing is fetched, and every quoted word is escaped.
"""

from collections.abc import Mapping
from datetime import datetime
from html import escape
from importlib import resources
from pathlib import Path
from string import Template

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from rotorrig.app import figures, report_causes, report_tables
from rotorrig.app.centreline_paths import centreline_paths, centreline_words
from rotorrig.app.curves import slow_roll_known
from rotorrig.app.diagnosis_part import Vectors, part_of, predictions
from rotorrig.app.orbit_drawing import orbit_pictures
from rotorrig.app.report_verdict import banner
from rotorrig.app.rig_drawing import end_view, side_view
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.identification import Fit, Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError
from rotorrig.rig.units import RPM


def write_report(
    path: Path,
    *,
    response: OrderTrackedResponse,
    identification: Identification | None = None,
    diagnosis: Diagnosis | None = None,
    truth: Mapping[str, float] | None = None,
) -> None:
    """Write the report of a response, with the fit and the verdict on it where there are any.

    `truth` maps names of estimates to the simulated rig's own values in SI, for a column beside the estimates.
    Raises DataError where the parts are not of one run, or the file cannot be written.
    """
    _check(response, identification)
    diagnosis = part_of(diagnosis, response) if diagnosis else None
    sections = [
        banner(identification, diagnosis),
        _causes(diagnosis),
        _identified(identification, diagnosis, truth),
        _bode(response, identification, diagnosis),
        _residuals(response, diagnosis),
        _orders(response),
        _orbits(response),
        _centreline(response),
        _untold(identification, diagnosis),
        _rig(response),
        _provenance(response, identification),
        _conventions(response),
    ]
    page = Template(_asset("report.html")).substitute(
        title=escape(f"{response.rig.name}: rotor report"),
        heading=escape(response.rig.name),
        style=_asset("report.css"),
        plotly=get_plotlyjs(),
        script=_asset("report.js"),
        body="\n".join(section for section in sections if section),
        written=f"{datetime.now().astimezone():%Y-%m-%d %H:%M %Z}",
    )
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise DataError(f"{path}: the report cannot be written ({error.strerror})") from error


def _check(response: OrderTrackedResponse, identification: Identification | None) -> None:
    rows = response.z.shape[:2]
    for fit in identification.fits if identification else ():
        if fit.prediction.shape != rows:
            raise DataError(
                f"fit '{fit.name}': predicts (speed, probe) = {fit.prediction.shape}, the response has {rows}; "
                "want the fit of this very response"
            )


def _causes(diagnosis: Diagnosis | None) -> str:
    if diagnosis is None:
        return ""
    parts = [report_causes.causes(diagnosis), report_causes.gain(diagnosis)]
    return _section("causes", "Causes", *parts) if any(parts) else ""


def _identified(
    identification: Identification | None,
    diagnosis: Diagnosis | None,
    truth: Mapping[str, float] | None,
) -> str:
    if identification is None:
        return ""
    wrong = diagnosis is not None and diagnosis.verdict not in (Verdict.ADEQUATE, Verdict.CANNOT_TELL)
    warning = f'<p class="warning">{_WRONG_MODEL}</p>' if wrong else ""
    tables = [report_tables.estimates(fit, truth=truth) for fit in identification.fits]
    nuisances = [report_tables.nuisances(fit) for fit in identification.fits[:1] if fit.nuisances]
    note = (
        "<p>± is one standard deviation of this data and this model; it says nothing of what the model leaves out.</p>"
    )
    limits = [report_tables.limits(fit) for fit in identification.fits[:1] if fit.budget]
    return _section("identified", "Identified values", warning, *tables, note, *limits, *nuisances)


def _bode(response: OrderTrackedResponse, identification: Identification | None, diagnosis: Diagnosis | None) -> str:
    fit = identification.fits[0] if identification and identification.fits else None
    base, extended = predictions(response, fit, diagnosis)
    said = [_compensation(response), _drawn(fit, base, extended), "Blue: speed rises; orange: it falls."]
    plots = [
        _figure(
            f"bode-{p}",
            figures.bode(
                response,
                p,
                prediction=base if extended is None else extended,
                before=None if extended is None else base,
            ),
            caption=f"Probe {name}",
            label=report_tables.peak_words(response, p, fit),
        )
        for p, name in enumerate(response.probes)
    ]
    toggle = '<label class="toggle"><input type="checkbox" id="log-amplitude"> logarithmic amplitude</label>'
    return _section(
        "bode",
        "Synchronous response (1X) against speed",
        f"<p>{escape(' '.join(said))}</p>",
        toggle,
        f'<div class="grid">{"".join(plots)}</div>',
        report_tables.peaks(response, fit),
    )


def _drawn(fit: Fit | None, base: Vectors | None, extended: Vectors | None) -> str:
    if extended is not None:
        return "Dots are measured, lines the extended model, thin grey lines the base model."
    if base is None:
        return "Dots are measured."
    return f"Dots are measured, lines the model fitted{f' to the {fit.name}' if fit else ''}."


def _compensation(response: OrderTrackedResponse) -> str:
    if not slow_roll_known(response):
        return "No slow roll was measured: the vectors are raw, runout and bow included."
    rpm = response.slow_roll_omega * RPM
    return f"Slow-roll compensated: the vector at {rpm:.0f} rpm is subtracted from measurement and model alike."


def _residuals(response: OrderTrackedResponse, diagnosis: Diagnosis | None) -> str:
    if diagnosis is None:
        return ""
    present = [order for order in response.orders if order and _any_finite(diagnosis, response.orders.index(order))]
    model = "model" if diagnosis.extended_residual is None else "base model"
    plots = [
        _figure(
            f"residual-{order:g}".replace(".", "_"),
            figures.residual_map(response, diagnosis.sigmas, order=order),
            caption=f"Residual at {order:g}X, measured less {model}, in standard deviations of the noise",
            label=f"Map of the {order:g}X residual over speed, a row per probe and run; the table below has its worst.",
        )
        for order in present
    ]
    if (turning := figures.whirl_map(response, diagnosis.residual)) is not None:
        plots.insert(
            1,
            _figure(
                "whirl",
                turning,
                caption="The same in µm 0-peak, split into forward and backward whirl",
                label="Map of the forward and backward whirl of the 1X residual over speed, a row per plane and run.",
            ),
        )
    said = "<p>Grey is noise (below 2 σ); yellow, orange and red are what the model does not describe.</p>"
    return _section("residuals", "Where model and measurement part", said, *plots, report_tables.misfits(diagnosis))


def _any_finite(diagnosis: Diagnosis, place: int) -> bool:
    return bool((diagnosis.sigmas[:, :, place] == diagnosis.sigmas[:, :, place]).any())


def _orders(response: OrderTrackedResponse) -> str:
    others = [order for order in response.orders if order not in (0.0, 1.0)]
    if not others:
        return ""
    plots = [
        _figure(
            f"order-{order:g}".replace(".", "_").replace("-", "m", 0),
            figures.order_amplitudes(response, order),
            caption=f"{order:g}X amplitude against speed, with the noise of one vector",
            label=report_tables.order_words(response, order),
        )
        for order in others
    ]
    return _section("orders", "Other orders", f"<p>{escape(_ORDERS_NOTE)}</p>", *plots)


_WRONG_MODEL = (
    "These are the values with which a model that does not describe the run comes nearest to it: "
    "they may be off by far more than their standard deviations say."
)
_ORDERS_NOTE = (
    "An unbalanced linear rotor answers at 1X alone. A peak here at a critical speed divided by the order "
    "means a force at that order: misalignment, a loose or nonlinear support, a shaft of uneven stiffness."
)


def _orbits(response: OrderTrackedResponse) -> str:
    lines = [
        f'<h3>{escape(plane.name)}</h3><div class="orbits">{"".join(pictures)}</div>'
        for plane, pictures in orbit_pictures(response)
        if pictures
    ]
    if not lines:
        return ""
    said = f"{_compensation(response)} The dot is the shaft at the keyphasor edge, the arrow its way round."
    return _section("orbits", "Orbits at 1X", f"<p>{escape(said)}</p>", *lines)


def _centreline(response: OrderTrackedResponse) -> str:
    paths = centreline_paths(response)
    if not paths:
        return ""
    plot = _figure(
        "mean-position",
        figures.centreline(paths),
        caption="Mean position against that of the slowest rows of the run",
        label=f"Mean position of the shaft, a panel per plane of probes. {centreline_words(paths)}",
    )
    said = f"<p>{escape(_CENTRELINE_NOTE)} {escape(centreline_words(paths))}</p>"
    return _section("centreline", "Shaft centreline", said, plot)


_CENTRELINE_NOTE = (
    "A linear rotor vibrates about one place at every speed. Where its mean position follows the speed, a support "
    "gives way on one side or the stiffness turns with the shaft; where it drifts with time, a probe warms up. Part of "
    "it may be the probes': they see a round shaft recede as it moves aside."
)


def _untold(identification: Identification | None, diagnosis: Diagnosis | None) -> str:
    fits = identification.fits if identification else ()
    words = [f"{fit.name}: {word}" if len(fits) > 1 else word for fit in fits for word in fit.words]
    words += report_causes.untold(diagnosis) if diagnosis else []
    items = "".join(f"<li>{escape(word)}</li>" for word in words)
    return _section("untold", "What this data cannot tell", f"<ul>{items}</ul>") if words else ""


def _rig(response: OrderTrackedResponse) -> str:
    notes = f"<p>{escape(response.rig.notes)}</p>" if response.rig.notes else ""
    drawing = f'<figure class="wide">{side_view(response.rig)}<figcaption>Side view, to scale</figcaption></figure>'
    end = f'<figure class="end">{end_view(response.rig)}<figcaption>End view, axes and probes</figcaption></figure>'
    return _section(
        "rig", "The rig", notes, f'<div class="rig">{drawing}{end}</div>', report_tables.nameplate(response.rig)
    )


def _provenance(response: OrderTrackedResponse, identification: Identification | None) -> str:
    return _section("provenance", "Where this comes from", report_tables.provenance(response, identification))


def _conventions(response: OrderTrackedResponse) -> str:
    return _section("conventions", "Conventions", report_tables.conventions(response))


def _section(name: str, heading: str, *parts: str) -> str:
    inside = "\n".join(part for part in parts if part)
    return (
        f'<section id="{name}" aria-labelledby="h-{name}"><h2 id="h-{name}">{escape(heading)}</h2>\n{inside}</section>'
    )


def _figure(name: str, figure: go.Figure, *, caption: str, label: str) -> str:
    """Return a plot's place on the page and its data; report.js draws it, `label` is what a screen reader says."""
    data = figure.to_json().replace("</", "<\\/")  # so that no text in the data can end the script element
    return (
        f'<figure class="plot"><figcaption>{escape(caption)}</figcaption>'
        f'<div id="{name}" class="canvas" role="img" aria-label="{escape(label)}" '
        f'style="min-height:{figure.layout.height}px"></div>'
        f'<script type="application/json" data-figure="{name}">{data}</script></figure>'
    )


def _asset(name: str) -> str:
    return resources.files("rotorrig.app").joinpath("assets", name).read_text(encoding="utf-8")
