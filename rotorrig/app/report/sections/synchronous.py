"""Synchronous response (1X): Bode plot, polar plot and values per probe; tables of critical speeds and peaks."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from rotorrig.app.plot_data import (
    CriticalSpeed,
    Curve,
    Vectors,
    choose_resonances,
    critical_speeds,
    curves,
    model_vectors,
    predictions,
    slow_roll_known,
    sweeps,
    vectors,
)
from rotorrig.app.report.figures import bode, polar
from rotorrig.app.report.html import Section, details, paragraph, plot, section, table
from rotorrig.app.text import NO_RESONANCE, critical_speed_cells, critical_words, half_power_text, margin_text
from rotorrig.identify import Diagnosis, Fit, Identification
from rotorrig.processing import OrderTrackedResponse, SpeedWindow
from rotorrig.rig.config import RPM, UM

NUMBERS = 24  # speeds of a run in the table beside a plot


@dataclass(frozen=True, slots=True, kw_only=True)
class Models:
    """Predicted 1X vectors, (speed, probe) [m]; None if there is no such model."""

    fit: Fit | None
    base: Vectors | None
    extended: Vectors | None

    @property
    def best(self) -> Vectors | None:
        """Those of the extended model if there is one."""
        return self.base if self.extended is None else self.extended

    @property
    def before(self) -> Vectors | None:
        """Those of the base model if there is an extended one."""
        return None if self.extended is None else self.base


def synchronous_section(
    response: OrderTrackedResponse,
    identification: Identification | None,
    diagnosis: Diagnosis | None,
    *,
    operating: SpeedWindow | None = None,
) -> Section:
    """Return the section; `diagnosis` is the part for `response`, `operating` the speeds to keep clear of."""
    fit = identification.fits[0] if identification and identification.fits else None
    base, extended = predictions(response, fit, diagnosis)
    models = Models(fit=fit, base=base, extended=extended)
    found = critical_speeds(response, models.best, choose_resonances(fit, diagnosis))
    return section(
        "bode",
        "Synchronous response (1X) against speed",
        paragraph(compensation(response), _plot_key(models), _COLOURS, "" if response.amplitudes_alone else _POLAR),
        '<label class="toggle"><input type="checkbox" id="log-amplitude" disabled> logarithmic amplitude</label>',
        *(_probe(response, p, models, found) for p in range(len(response.probes))),
        _critical_speeds(found, operating),
        _peaks(response, models),
    )


def compensation(response: OrderTrackedResponse) -> str:
    """Return whether plots and tables are slow-roll compensated, and whether phases are known."""
    if response.amplitudes_alone:
        return f"The table has amplitudes alone: no phase is known. {_compensation(response)}"
    return _compensation(response)


def _compensation(response: OrderTrackedResponse) -> str:
    if np.isfinite(response.compensation_omega):
        rpm = response.compensation_omega * RPM
        return f"The table came slow-roll compensated, by a vector at {rpm:.0f} rpm that it does not tell."
    if not slow_roll_known(response):
        return "No slow roll was measured: the vectors are raw, runout and bow included."
    rpm = response.slow_roll_omega * RPM
    return f"Slow-roll compensated: the vector at {rpm:.0f} rpm is subtracted from measurement and model."


def _plot_key(models: Models) -> str:
    if models.extended is not None:
        return "Dots: measured; lines: extended model; thin grey lines: base model."
    if models.base is None:
        return "Dots: measured."
    return f"Dots: measured; lines: model fitted{f' to the {models.fit.name}' if models.fit else ''}."


def _probe(response: OrderTrackedResponse, probe: int, models: Models, found: Sequence[CriticalSpeed]) -> str:
    """Return the plots of one probe and, collapsed, their values."""
    name = response.probes[probe]
    mine = [each for each in found if each.probe == name]
    peaks = " ".join([peak_words(response, probe, models), *(critical_words(c.run, c.measured) for c in mine)])
    shown = "amplitude" if response.amplitudes_alone else "amplitude and phase lag"
    left = plot(
        f"bode-{probe}",
        bode(response, probe, prediction=models.best, before=models.before, resonances=mine),
        caption=f"Probe {name}",
        label=f"Bode plot of probe {name}, 1X {shown} against speed. {peaks}",
        share=1.0 if response.amplitudes_alone else 0.57,
    )
    if response.amplitudes_alone:
        return f'<div class="probe">{left}{_numbers(response, probe, models)}</div>'
    right = plot(
        f"polar-{probe}",
        polar(response, probe, prediction=models.best, before=models.before),
        caption=f"Probe {name}, polar",
        label=f"Polar plot of probe {name}, 1X vectors over speed. {peaks}",
        share=0.43,
    )
    return f'<div class="probe">{left}{right}{_numbers(response, probe, models)}</div>'


def _numbers(response: OrderTrackedResponse, probe: int, models: Models) -> str:
    main = curves(response, probe, prediction=models.best)
    before = curves(response, probe, prediction=models.before) if models.before is not None else main
    rows = [cells for one, base in zip(main, before, strict=True) for cells in _number_rows(one, base, models)]
    header = ["run", "rpm", "µm 0-peak", "± 1 σ, µm 0-peak", "phase lag"]
    header += ["model, µm 0-peak", "phase lag"] if models.best is not None else []
    header += ["base model, µm 0-peak", "phase lag"] if models.before is not None else []
    caption = f"Probe {response.probes[probe]}, 1X at {NUMBERS} speeds of each run, with the peak"
    return details(f"Probe {response.probes[probe]} values", table(caption, header, rows), on_paper=False)


def _number_rows(curve: Curve, base: Curve, models: Models) -> Iterator[list[str]]:
    for row in _spread(curve):
        cells = [curve.run, f"{curve.rpm[row]:.0f}", f"{curve.amplitude[row]:.2f}"]
        cells += [f"{curve.sigma[row]:.2f}", _degrees(curve.lag[row])]
        for model in (curve if models.best is not None else None, base if models.before is not None else None):
            if model is not None and model.model_amplitude is not None and model.model_lag is not None:
                cells += [f"{model.model_amplitude[row]:.2f}", _degrees(model.model_lag[row])]
        yield cells


def _degrees(lag: float) -> str:
    return "–" if math.isnan(lag) else f"{lag % 360:.1f}°"


def _spread(curve: Curve) -> list[int]:
    """Return rows evenly spread in speed, the row of the largest amplitude among them."""
    usable = np.flatnonzero(np.isfinite(curve.amplitude))
    if not usable.size:
        return []
    wanted = np.linspace(curve.rpm[usable].min(), curve.rpm[usable].max(), NUMBERS)
    rows = {int(usable[np.argmin(np.abs(curve.rpm[usable] - speed))]) for speed in wanted}
    rows.add(int(usable[np.argmax(curve.amplitude[usable])]))
    return sorted(rows, key=lambda row: float(curve.rpm[row]))


def _critical_speeds(found: Sequence[CriticalSpeed], operating: SpeedWindow | None) -> str:
    """Return the table, the model's below the measured ones; with separation margins to operating speeds."""
    if not found:
        return paragraph(NO_RESONANCE)
    header = ["probe, run", "critical speed, rpm", "AF", "ζ, %", "half-power speeds, rpm"]
    header += [_margin_heading(operating)] if operating else []
    rows = []
    for each in found:
        place = f"{each.probe}, {each.run}"
        named = {place: each.measured} | ({f"{place}, model": each.model} if each.model else {})
        for name, peak in named.items():
            margin = [margin_text(peak, operating)] if operating else []
            rows.append([name, *critical_speed_cells(peak), half_power_text(peak), *margin])
    return table("Critical speeds", header, rows) + paragraph(_DEFINITIONS)


def _margin_heading(operating: SpeedWindow) -> str:
    low, high = operating.low * RPM, operating.high * RPM
    return f"margin to {low:.0f} rpm" if low == high else f"margin to {low:.0f} to {high:.0f} rpm"


def _peaks(response: OrderTrackedResponse, models: Models) -> str:
    """Return the table of 1X peaks per probe and run, measured and modelled."""
    predicted = {"model": models.best, "base model": models.before}
    shown = {name: prediction for name, prediction in predicted.items() if prediction is not None}
    rows = []
    for p, name in enumerate(response.probes):
        for run in sweeps(response):
            peaks = [_peak(response, p, run), *(_peak(response, p, run, model) for model in shown.values())]
            cells = [cell for peak in peaks for cell in (peak or ("–",) * 3)]
            rows.append([f"{name}, {response.runs[run].name}", *cells])
    header = ["probe, run", "peak, µm 0-peak", "at rpm", "phase lag"]
    for name in shown:
        header += [f"{name}, µm 0-peak", "at rpm", "phase lag"]
    return table("1X peaks, measured" + (" and model" if shown else ""), header, rows) if rows else ""


def _peak(
    response: OrderTrackedResponse, probe: int, run: int, prediction: Vectors | None = None
) -> tuple[str, str, str] | None:
    """Return amplitude, speed and phase lag of the largest usable vector of a run as text; of the model if given."""
    z = vectors(response) if prediction is None else model_vectors(response, prediction)
    chosen = (response.run == run) & response.usable[:, probe] & np.isfinite(z[:, probe])
    if not chosen.any():
        return None
    rows = np.flatnonzero(chosen)
    row = rows[np.argmax(np.abs(z[rows, probe]))]
    lag = "–" if response.amplitudes_alone else f"{-math.degrees(np.angle(z[row, probe])) % 360:.0f}°"
    return f"{abs(z[row, probe]) * UM:.1f}", f"{response.omega[row] * RPM:.0f}", lag


def peak_words(response: OrderTrackedResponse, probe: int, models: Models) -> str:
    """Return the peaks of a probe as sentences, for screen readers."""
    sentences = []
    for run in sweeps(response):
        if top := _peak(response, probe, run):
            sentences.append(f"Run {response.runs[run].name}: peak {top[0]} µm 0-peak at {top[1]} rpm, lag {top[2]}.")
        if models.best is not None and (top := _peak(response, probe, run, models.best)):
            sentences.append(f"Model: {top[0]} µm 0-peak at {top[1]} rpm.")
    return " ".join(sentences)


_COLOURS = "Blue: run-up; orange: run-down. Long runs are thinned to the extremes of each stretch."
_POLAR = "Polar plots: µm 0-peak, 0° of phase lag at the probe, lag against rotation, speeds in rpm along the path."
_DEFINITIONS = (
    "Critical speed: where the 1X amplitude of the run peaks. AF, amplification factor: critical speed over the "
    "distance of the half-power speeds, at 0.707 of the peak; damping ratio ζ = 1 / (2 AF). All as API RP 684 defines "
    "them, on the curve as drawn: a run of changing speed shifts and flattens its peak. ± is one standard deviation: "
    "as measured that by the noise of the vectors alone, of the model, read off its curve, that by the uncertainty of "
    "all its parameters."
)
