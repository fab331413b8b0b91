"""Current readings in Markdown: speed, 1X, peak to peak and gap voltage of every probe."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import lag_degrees
from rotorrig.app.viewer.live.data import SlowRollSoFar, Waveform
from rotorrig.app.viewer.live.parts.orbits import first_order
from rotorrig.app.viewer.plots import displayable
from rotorrig.rig.config import RPM, UM, RigConfig


def readings(
    rig: RigConfig, waveform: Waveform | None, volts: NDArray[np.float64], slow_roll: SlowRollSoFar, *, note: str = ""
) -> str:
    """Return what is measured at this moment, in Markdown; `note` says what the rig is doing, if that is known."""
    speed = "no turn seen" if waveform is None else f"{waveform.omega * RPM:.0f} rpm"
    paragraphs = [" – ".join(words for words in (f"**{speed}**", displayable(note), slow_roll.words) if words)]
    rows = ["| probe | gap, V | p-p, µm | 1X raw, µm | less slow roll, µm |\n|---|---:|---:|---:|---:|"]
    z = first_order(waveform) if waveform else None
    for p, probe in enumerate(rig.probes):
        low, high = sorted(probe.linear_range)
        gap = f"{volts[p]:.2f}" + ("" if low <= volts[p] <= high else " **out of range**")
        if z is None or waveform is None:
            rows.append(f"| {probe.name} | {gap} | – | – | – |")
            continue
        x = waveform.last(1).x[:, p]
        compensated = _vector(z[p] - slow_roll.z[p]) if slow_roll.known else "–"
        rows.append(f"| {probe.name} | {gap} | {float(np.ptp(x)) * UM:.1f} | {_vector(z[p])} | {compensated} |")
    paragraphs.append("\n".join(rows))
    paragraphs.append("p-p: peak to peak over the last turn. 1X: 0-peak, at its phase lag.")
    return "\n\n".join(paragraphs)


def _vector(z: complex) -> str:
    """Return a vector [m] as amplitude in µm and phase lag in degrees."""
    return f"{abs(z) * UM:.1f} at {float(lag_degrees(np.array([z]))[0]):.0f}°"
