"""Residual maps of base and extended model, and the table of the largest misfits."""

import math

import numpy as np

from rotorrig.app.report.figures import residual_map, whirl_map
from rotorrig.app.report.html import Section, details, name_of_order, paragraph, plot, section, table
from rotorrig.identify import Diagnosis, Verdict
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM, UM

LISTED = 12


def residuals_section(response: OrderTrackedResponse, diagnosis: Diagnosis | None) -> Section | None:
    """Return the section; `diagnosis` is the part for `response`, None gives no section."""
    if diagnosis is None:
        return None
    available = [order for order in response.orders if order and _has_residual(response, diagnosis, order)]
    loud = {misfit.order for misfit in diagnosis.worst} if diagnosis.verdict is not Verdict.ADEQUATE else set()
    shown = [order for order in available if order == 1.0 or order in loud]
    calm = [order for order in available if order not in shown]
    maps = {order: _maps(response, diagnosis, order=order) for order in available}
    return section(
        "residuals",
        "Misfit between model and measurement",
        paragraph(_COLOURS),
        *(part for order in sorted(shown, key=lambda order: order != 1.0) for part in maps[order]),
        *(_whirl(response, diagnosis) if 1.0 in shown else ()),
        misfits(diagnosis),
        details(
            f"Residuals at {', '.join(f'{order:g}X' for order in calm)}",
            *(part for order in calm for part in maps[order]),
            on_paper=False,
        )
        if calm
        else "",
    )


def _has_residual(response: OrderTrackedResponse, diagnosis: Diagnosis, order: float) -> bool:
    return bool(np.isfinite(diagnosis.sigmas[:, :, response.orders.index(order)]).any())


def _maps(response: OrderTrackedResponse, diagnosis: Diagnosis, *, order: float) -> list[str]:
    """Return the map of the base model at an order and, where there is one, that of the extended model."""
    after = diagnosis.extended_sigmas
    models = {"": ("model" if diagnosis.extended_residual is None else "base model", diagnosis.sigmas)}
    if after is not None and np.isfinite(after[:, :, response.orders.index(order)]).any():
        models["-after"] = ("extended model", after)
    return [
        plot(
            f"residual-{name_of_order(order)}{suffix}",
            residual_map(response, sigmas, order=order),
            caption=f"Residual at {order:g}X, measured minus {model}, in standard deviations of the noise",
            label=f"Map of the {order:g}X residual of the {model} over speed, a row per probe and run. "
            f"{_map_words(response, sigmas, order)}",
        )
        for suffix, (model, sigmas) in models.items()
    ]


def _map_words(response: OrderTrackedResponse, sigmas: np.ndarray, order: float) -> str:
    """Return the RMS of a map and its largest value."""
    residual = sigmas[:, :, response.orders.index(order)]
    row, probe = np.unravel_index(np.nanargmax(residual), residual.shape)
    return (
        f"RMS {np.sqrt(np.nanmean(residual**2)):.2g} standard deviations; largest {residual[row, probe]:.2g} "
        f"at probe {response.probes[probe]}, {response.omega[row] * RPM:.0f} rpm."
    )


def _whirl(response: OrderTrackedResponse, diagnosis: Diagnosis) -> list[str]:
    figure = whirl_map(response, diagnosis.residual, noise=diagnosis.noise_floor)
    if figure is None:
        return []
    model = "model" if diagnosis.extended_residual is None else "base model"
    caption = f"Residual at 1X of the {model} in µm 0-peak, split into forward and backward whirl"
    label = "Map of the forward and backward whirl of the 1X residual over speed, a row per plane and run."
    return [plot("whirl", figure, caption=caption, label=label)]


def misfits(diagnosis: Diagnosis) -> str:
    """Return the table of misfits, most serious first."""
    if not diagnosis.worst:
        return ""
    rows = [
        [
            f"{m.probe}, {m.order:g}X, {m.run}",
            f"{m.speed_from * RPM:.0f} to {m.speed_to * RPM:.0f}",
            f"{m.sigma:.3g}",
            f"{m.residual * UM:.3g}" + ("" if m.order else " µm of shift"),
            "–" if math.isnan(m.relative) else f"{100 * m.relative:+.1f} %",
            "–" if math.isnan(m.phase) else f"{math.degrees(m.phase):+.1f}°",
            "–" if math.isnan(m.backward) else f"{100 * m.backward:.0f} %",
            m.other_run or "–",
        ]
        for m in diagnosis.worst[:LISTED]
    ]
    header = ["where", "rpm", "σ, rms", "largest, µm 0-peak", "amplitude error", "phase error (− lags)"]
    header += ["backward whirl", "other direction"]
    fine = diagnosis.verdict is Verdict.ADEQUATE and all(m.order for m in diagnosis.worst)
    return table("Largest residuals, all within noise" if fine else "Misfits, most serious first", header, rows)


_COLOURS = "Grey is noise (below 2 σ); yellow, orange and red are misfit of the model."
