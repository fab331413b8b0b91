"""The report's tables as HTML, and the sentences that stand for a plot where it cannot be seen."""

import math
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from rotorrig.app.curves import model_vectors, sweeps, vectors
from rotorrig.app.wording import (
    UNDETERMINED,
    at_bound,
    bearing_coefficients,
    change,
    determined,
    in_sigmas,
    interval,
    long,
    plus_minus,
    shown,
)
from rotorrig.identify.diagnosis import Diagnosis, Verdict
from rotorrig.identify.identification import Estimate, Fit, Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.description import RigConfig
from rotorrig.rig.units import RPM, UM

LISTED_MISFITS = 12


def table(
    caption: str,
    header: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    marked: Iterable[int] = (),
    mark: str = "marked",
) -> str:
    """Return a table; every cell is escaped, the first of a row heads it.

    Rows whose index is in `marked` stand out in the way of the class `mark` of report.css.
    """
    marks = set(marked)
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in header)
    body = ""
    for i, (first, *rest) in enumerate(rows):
        cells = "".join(f"<td>{escape(cell)}</td>" for cell in rest)
        body += f'<tr{f" class={mark}" if i in marks else ""}><th scope="row">{escape(first)}</th>{cells}</tr>'
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{escape(caption)}"><table>'
        f"<caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def pairs(caption: str, values: Mapping[str, Any]) -> str:
    """Return a table of names and values."""
    rows = "".join(
        f'<tr><th scope="row">{escape(str(name))}</th><td>{escape(_plain(value))}</td></tr>'
        for name, value in values.items()
    )
    inside = f"<caption>{escape(caption)}</caption><tbody>{rows}</tbody>"
    return f'<div class="scroll"><table class="pairs">{inside}</table></div>'


def estimates(fit: Fit, *, truth: Mapping[str, float] | None) -> str:
    """Return the identified values of a fit beside the nameplate, and beside the simulated rig's own if given."""
    header = ["parameter", "identified ± 1 σ", "95 %", "nameplate", "difference"]
    header += ["simulated rig", "error", "error in σ"] if truth else []
    rows = [_estimate_row(e, truth) for e in fit.estimates]
    low, high = (speed * RPM for speed in fit.band)
    caption = f"Fit, {fit.name}: {low:.0f} to {high:.0f} rpm"
    marked = [i for i, e in enumerate(fit.estimates) if not determined(e)]
    return table(caption, [*header, "remark"], rows, marked=marked)


def _estimate_row(estimate: Estimate, truth: Mapping[str, float] | None) -> list[str]:
    cells = [long(estimate.name), plus_minus(estimate), interval(estimate) or "–"]
    cells += [shown(estimate.nameplate, estimate.unit), change(estimate, estimate.nameplate)]
    if truth:
        actual = truth.get(estimate.name, math.nan)
        cells += [shown(actual, estimate.unit), change(estimate, actual), in_sigmas(estimate, actual)]
    return [*cells, at_bound(estimate) or ("" if determined(estimate) else "hardly restricts the fit")]


def nuisances(fit: Fit) -> str:
    """Return what the fit may adjust within the nameplate's tolerance: never a discovery."""
    rows = [[long(e.name), plus_minus(e)] for e in fit.nuisances]
    inside = table(
        "Deviations from the nameplate, adjusted within its tolerance", ["quantity", "deviation ± 1 σ"], rows
    )
    return f"<details><summary>Nameplate deviations adjusted by the fit ({len(rows)})</summary>{inside}</details>"


def limits(fit: Fit) -> str:
    """Return where the uncertainty of each estimate comes from."""
    causes = list(next(iter(fit.budget.values())))
    rows = [[name, *(f"{100 * shares[cause]:.0f} %" for cause in causes)] for name, shares in fit.budget.items()]
    inside = table("Shares of each variance", ["parameter", *causes], rows)
    return f"<details><summary>What limits each value, noise or the nameplate's tolerances</summary>{inside}</details>"


def misfits(diagnosis: Diagnosis) -> str:
    """Return where model and measurement part, most serious first."""
    if not diagnosis.worst:
        return ""
    rows = [
        [
            f"{m.probe}, {m.order:g}X, {m.run}",
            f"{m.speed_from * RPM:.0f} to {m.speed_to * RPM:.0f}",
            f"{m.sigma:.3g}",
            f"{m.residual * UM:.3g}",
            "–" if math.isnan(m.relative) else f"{100 * m.relative:+.1f} %",
            "–" if math.isnan(m.phase) else f"{math.degrees(m.phase):+.1f}°",
            "–" if math.isnan(m.backward) else f"{100 * m.backward:.0f} %",
            m.other_run or "–",
        ]
        for m in diagnosis.worst[:LISTED_MISFITS]
    ]
    header = ["where", "rpm", "σ, rms", "largest, µm 0-peak", "amplitude off", "phase off (− late)"]
    header += ["backward whirl", "other direction"]
    fine = diagnosis.verdict is Verdict.ADEQUATE and all(m.order for m in diagnosis.worst)
    return table("Largest residuals, all within the noise" if fine else "Misfits, most serious first", header, rows)


def peaks(response: OrderTrackedResponse, fit: Fit | None) -> str:
    """Return the 1X peaks per probe and run, measured and modelled: the Bode plots in numbers."""
    rows = []
    for p, name in enumerate(response.probes):
        for run in sweeps(response):
            measured, modelled = _peak(response, p, run), _peak(response, p, run, fit)
            cells = [f"{name}, {response.runs[run].name}", *(measured or ("–",) * 3)]
            rows.append([*cells, *(modelled or ("–",) * 3)] if fit else cells)
    header = ["probe, run", "peak, µm 0-peak", "at rpm", "phase lag"]
    header += ["model, µm 0-peak", "at rpm", "phase lag"] if fit else []
    return table("1X peaks, measured" + (" and model" if fit else ""), header, rows) if rows else ""


def _peak(response: OrderTrackedResponse, probe: int, run: int, fit: Fit | None = None) -> tuple[str, str, str] | None:
    """Return amplitude, speed and phase lag of the largest usable vector of a run as text; of the model if given."""
    z = vectors(response) if fit is None else model_vectors(response, fit.prediction)
    chosen = (response.run == run) & response.usable[:, probe] & np.isfinite(z[:, probe])
    if not chosen.any():
        return None
    rows = np.flatnonzero(chosen)
    row = rows[np.argmax(np.abs(z[rows, probe]))]
    lag = -math.degrees(np.angle(z[row, probe])) % 360
    return f"{abs(z[row, probe]) * UM:.1f}", f"{response.omega[row] * RPM:.0f}", f"{lag:.0f}°"


def peak_words(response: OrderTrackedResponse, probe: int, fit: Fit | None) -> str:
    """Return what the Bode plot of a probe shows, for those who hear it."""
    said = [f"Bode plot of probe {response.probes[probe]}, 1X amplitude and phase lag against speed."]
    for run in sweeps(response):
        if found := _peak(response, probe, run):
            said.append(f"Run {response.runs[run].name}: peak {found[0]} µm 0-peak at {found[1]} rpm, lag {found[2]}.")
        if fit and (found := _peak(response, probe, run, fit)):
            said.append(f"Model: {found[0]} µm at {found[1]} rpm.")
    return " ".join(said)


def order_words(response: OrderTrackedResponse, order: float) -> str:
    """Return where each probe's amplitude at `order` is largest."""
    z = np.where(response.usable, vectors(response, order), np.nan)
    moving = np.isin(response.run, sweeps(response))
    said = [f"{order:g}X amplitude against speed."]
    for p, name in enumerate(response.probes):
        size = np.where(moving, np.abs(z[:, p]), np.nan)
        if np.isfinite(size).any():
            row = int(np.nanargmax(size))
            said.append(f"Probe {name}: largest {size[row] * UM:.2g} µm at {response.omega[row] * RPM:.0f} rpm.")
    return " ".join(said)


def nameplate(rig: RigConfig) -> str:
    """Return disks, bearings and probes as the config has them."""
    rows = [
        [
            f"disk {d.name}",
            f"{d.position * 1e3:g}",
            f"{d.mass:.4g} kg, Ip {d.polar_inertia:.4g}, It {d.transverse_inertia:.4g} kg m²",
        ]
        for d in rig.disks
    ]
    rows += [
        [
            f"bearing {b.name}",
            f"{b.position * 1e3:g}",
            bearing_coefficients(b),
        ]
        for b in rig.bearings
    ]
    rows += [
        [f"probe {p.name}", f"{p.position * 1e3:g}", f"at {math.degrees(p.angle):g}°, {p.sensitivity / 1e3:.4g} mV/µm"]
        for p in rig.probes
    ]
    inside = table("Nameplate", ["part", "mm from the coupling", "values"], rows)
    return f"<details><summary>Nameplate values</summary>{inside}</details>"


def provenance(response: OrderTrackedResponse, identification: Identification | None) -> str:
    """Return what this report was made from."""
    source = response.source
    values = {
        "recording": source.source or "unknown",
        "its sha256 (first 16 digits)": source.source_hash or "none: a live rig",
        "config hash": source.config_hash,
        "tracked by code version": source.code_version,
        "vectors": f"{len(response.omega)} rows of {_turns(response)}, {response.window} window; "
        f"{1 - response.usable.mean():.1%} not usable",
    }
    if identification:
        values["identified by code version"] = identification.source.code_version
        values["effects in the model"] = ", ".join(identification.effects) or "none: the base model"
        values["wall time of the fits"] = f"{identification.wall_s:.1f} s"
        for fit in identification.fits:
            values[f"search, {fit.name}"] = (
                f"objective {fit.objective}, {fit.evaluations} evaluations, seed {fit.seed}, stopped: {fit.stop}, "
                f"{len(fit.optima)} optima found"
            )
    return pairs("Provenance", values)


def _turns(response: OrderTrackedResponse) -> str:
    turns = np.unique(response.revolutions[np.isfinite(response.revolutions)])
    return f"{turns[0]:g} turns" if len(turns) == 1 else "varying length"


def conventions(response: OrderTrackedResponse) -> str:
    """Return how to read every number of the report."""
    rig = response.rig
    edge = f"the {rig.keyphasor.edge} keyphasor edge" if rig.keyphasor else "the keyphasor edge"
    first, second = rig.rotation.split("-to-")
    return pairs(
        "How to read the numbers",
        {
            "amplitude": "0-peak, in µm (peak-to-peak is twice as much)",
            "phase": f"phase lag in degrees after {edge}: z = 2 mean(x e^(−jθ)), lag = −arg z, θ = 0 at that edge",
            "axes": "z along the shaft from the coupling; x and y across it; angles from +x towards +y",
            "sense of rotation": f"from {first} to {second}",
            "probe": "reads x cos a + y sin a at its angle a, positive towards the probe",
            "unbalance angle": "from the keyphasor mark, in the sense of rotation",
            "gravity": {"none": "not considered"}.get(rig.gravity, f"along {rig.gravity}"),
            "±": f"one standard deviation; infinite is said as “{UNDETERMINED}”",
            "95 %": "an interval that holds the true value in 95 of 100 cases if the model is right",
        },
    )


def _plain(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, (list, tuple)):
        return ", ".join(_plain(item) for item in value)
    return str(value)
