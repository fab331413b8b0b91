"""Current readings in Markdown: speed, 1X, peak to peak and gap voltage of every probe."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import lag_degrees
from rotorrig.app.text import AmplitudeUnit
from rotorrig.app.viewer.live.data import SlowRollSoFar, Waveform
from rotorrig.app.viewer.live.parts.orbits import first_order
from rotorrig.app.viewer.plots import displayable
from rotorrig.rig.config import RPM, RigConfig


def readings(
    rig: RigConfig,
    waveform: Waveform | None,
    volts: NDArray[np.float64],
    slow_roll: SlowRollSoFar,
    *,
    unit: AmplitudeUnit,
    note: str = "",
) -> str:
    """Return what is measured at this moment, in Markdown; `note` says what the rig is doing, if that is known.

    Amplitudes are in `unit`, but for those from peak to peak, which are in its unit of length.
    """
    speed = "no turn seen" if waveform is None else f"{waveform.omega * RPM:.0f} rpm"
    paragraphs = [" – ".join(words for words in (f"**{speed}**", displayable(note), slow_roll.words) if words)]
    head = ("probe", "gap, V", *(f"{name}, {unit.length}" for name in ("p-p", "1X raw", "less slow roll")))
    rows = [f"| {' | '.join(head)} |\n|---|---:|---:|---:|---:|"]
    z = first_order(waveform) if waveform else None
    for p, probe in enumerate(rig.probes):
        low, high = sorted(probe.linear_range)
        gap = f"{volts[p]:.2f}" + ("" if low <= volts[p] <= high else " **out of range**")
        if z is None or waveform is None:
            rows.append(f"| {probe.name} | {gap} | – | – | – |")
            continue
        swing = _figure(float(np.ptp(waveform.last(1).x[:, p])) * unit.by_length, unit)
        compensated = _vector(z[p] - slow_roll.z[p], unit) if slow_roll.known else "–"
        rows.append(f"| {probe.name} | {gap} | {swing} | {_vector(z[p], unit)} | {compensated} |")
    paragraphs.append("\n".join(rows))
    paragraphs.append(f"p-p: peak to peak over the last turn. 1X: {unit.way}, at its phase lag.")
    return "\n\n".join(paragraphs)


def _vector(z: complex, unit: AmplitudeUnit) -> str:
    """Return a vector [m, 0-peak] as amplitude in `unit` and phase lag in degrees."""
    return f"{_figure(abs(z) * unit.by, unit)} at {float(lag_degrees(np.array([z]))[0]):.0f}°"


def _figure(value: float, unit: AmplitudeUnit) -> str:
    """Return a value to about a tenth of a micrometre, or a hundredth of a mil."""
    return f"{value:.{2 if unit.length == 'mil' else 1}f}"
