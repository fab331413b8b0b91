"""Full spectrum of forward and backward whirl; amplitude of the other orders against speed."""

import numpy as np

from rotorrig.app.plot_data import OrderSpectrum, order_spectra, sweeps, vectors
from rotorrig.app.report.figures import full_spectrum_map, order_amplitudes
from rotorrig.app.report.html import Section, name_of_order, paragraph, plot, section, table
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM, UM


def full_spectrum_section(response: OrderTrackedResponse) -> Section | None:
    """Return the amplitude of +nX and -nX over speed and at the peaks; None without a plane of two probes."""
    spectra = list(order_spectra(response))
    if not spectra:
        return None
    first = [one for one in spectra if one.run == spectra[0].run]
    plots = [
        plot(
            f"full-{i}",
            full_spectrum_map(one),
            caption=f"{one.plane.name}, {one.run}: amplitude of every order over speed, µm 0-peak, logarithmic",
            label=f"Map of forward and backward whirl by order over speed, probes {one.plane.name}. {_words(one)}",
        )
        for i, one in enumerate(first)
    ]
    header = ["plane, run", "at rpm", *(f"{order:+g}X" for order in first[0].orders)]
    rows = [
        [f"{one.plane.name}, {one.run}", f"{one.peak_rpm:.0f}", *(f"{size:.3g}" for size in one.at_peak)]
        for one in spectra
    ]
    caption = "Full spectrum at the largest 1X, µm 0-peak"
    largest = table(caption, header, rows, amplitudes=range(2, len(header)))
    return section("full-spectrum", "Full spectrum", paragraph(_FULL), *plots, largest)


def _words(one: OrderSpectrum) -> str:
    sizes = (f"{order:+g}X {size:.3g}" for order, size in zip(one.orders, one.at_peak, strict=True))
    return f"At {one.peak_rpm:.0f} rpm, in µm: {', '.join(sizes)}."


def other_orders_section(response: OrderTrackedResponse) -> Section | None:
    """Return the amplitude of every other order against speed; None if there is none."""
    others = [order for order in response.orders if order not in (0.0, 1.0)]
    if not others:
        return None
    plots = [
        plot(
            f"order-{name_of_order(order)}",
            order_amplitudes(response, order),
            caption=f"{order:g}X amplitude against speed, with the noise of one vector",
            label=f"{order:g}X amplitude against speed, a panel per probe; the table below lists the largest.",
        )
        for order in others
    ]
    rows = [row for order in others for row in _largest(response, order)]
    header = ["order, probe", "largest, µm 0-peak", "in σ of one vector", "at rpm", "run"]
    return section("orders", "Other orders", paragraph(_OTHERS), *plots, table("Largest of each order", header, rows))


def _largest(response: OrderTrackedResponse, order: float) -> list[list[str]]:
    """Return where each probe's amplitude at `order` is largest."""
    z = np.where(response.usable, vectors(response, order), np.nan)
    variance = np.diagonal(response.covariance[:, response.orders.index(order)], axis1=1, axis2=2)[:, ::2]
    moving = np.isin(response.run, sweeps(response))
    rows = []
    for p, name in enumerate(response.probes):
        size = np.where(moving, np.abs(z[:, p]), np.nan)
        if np.isfinite(size).any():
            row = int(np.nanargmax(size))
            sigmas = size[row] / np.sqrt(variance[row, p]) if variance[row, p] > 0 else np.nan
            run = response.runs[response.run[row]].name
            cells = [f"{size[row] * UM:.2g}", f"{sigmas:.0f}", f"{response.omega[row] * RPM:.0f}", run]
            rows.append([f"{order:g}X, {name}", *cells])
    return rows


_FULL = (
    "Two probes in a plane resolve every order into forward whirl (+nX, with the rotation) and backward whirl (−nX). "
    "Equal parts are a straight line; −1X indicates anisotropic supports or a rub, +0.5X oil whirl or looseness, 2X "
    "misalignment or an asymmetric shaft."
)
_OTHERS = (
    "An unbalanced linear rotor responds at 1X only. A peak at a critical speed divided by the order means a force at "
    "that order: misalignment, a loose or nonlinear support, an asymmetric shaft."
)
