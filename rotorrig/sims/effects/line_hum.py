"""Mains hum in the probes' signals, and how much of it a row's window lets through at each order.

The hum is alike at all probes, or shared among them as the context says, of another phase in every recording, and does
not turn with the shaft; where n Omega passes its frequency it falls into the tracking filter for a moment. From the
keyphasor's times the leak follows exactly, phase and all; of mains that stray, if the context says how. Source: Harris,
On the use of windows for harmonic analysis, Proc. IEEE 66 (1978) 51-83.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from rotorrig.rig.config import RigConfig
from rotorrig.sims.effects.base import EVERY, Complex, Effect, ReadingContext, Theta, pair, phasor
from rotorrig.sims.rotor.swept import TURN, Timeline, window_weights

MAINS = (50.0, 60.0)  # Hz
HARMONICS = (1, 2)  # of the mains that are looked for: a rectifier leaves the second
POINTS = 24  # of the average, per turn: the beat of hum and order turns far less
LEAST_PULSES = 4  # that a time line needs


@dataclass(frozen=True, kw_only=True)
class LineHum(Effect):
    """The phasor "hum" [m] of Re(a e^{j 2 pi f t}), t as in the recording, or of the mains' own phase.

    With a phasor for each of several recordings, "hum 2" and so on, it is none in any other one.
    """

    name = "line_hum"
    title = "mains hum"
    orders = EVERY
    linear = True
    as_nuisance = True
    frequency: float  # Hz

    def of_recordings(self, count: int) -> "LineHum":
        """Return the hum with a phasor in each of so many recordings."""
        (real, imaginary) = self.parameters
        stems = [_stem(number) for number in range(count)]
        each = [replace(p, name=f"{stem}{end}") for stem in stems for p, end in ((real, " re"), (imaginary, " im"))]
        return replace(self, parameters=tuple(each))

    def change_readings(self, z: Complex, context: ReadingContext, theta: Theta) -> Complex:
        """Return the vectors with its leak; unchanged where a row's time is not known."""
        own = _stem(context.recording) if len(self.parameters) > 2 else "hum"
        hum = phasor(theta, own) if f"{own} re" in theta else 0
        if not hum or len(context.keyphasor_t) < LEAST_PULSES:
            return z
        known = np.flatnonzero(np.isfinite(context.t))
        result = z.copy()
        if self.frequency not in context.leaks:
            context.leaks[self.frequency] = leak(context, known, self.frequency)
        result[known] += hum * context.leaks[self.frequency]
        return result

    def words(self, theta: Theta) -> str:
        """Say how large it is and at which frequency."""
        most = max(abs(phasor(theta, name.removesuffix(" re"))) for name in theta if name.endswith(" re"))
        return f"the probes pick up mains hum of {1e6 * most:.2f} um 0-peak at {self.where}"


def _stem(recording: int) -> str:
    return f"hum {recording + 1}" if recording else "hum"


def leak(context: ReadingContext, rows: NDArray[np.intp], frequency: float) -> Complex:
    """Return the vectors (row, probe) that a hum e^{j 2 pi f t} leaves: 2 mean(Re(e^{j 2 pi f t}) e^{-j n theta}).

    Where the speed is below zero, so is the shaft's angle.
    """
    timeline = Timeline(context.keyphasor_t)
    count = int(np.ceil(POINTS * context.revolutions[rows].max(initial=1.0)))
    x = (np.arange(count) + 0.5) / count - 0.5  # of the window, in shaft angle
    weight = window_weights(2 * x, context.window)
    turn = timeline.theta(context.t[rows])[:, None] / TURN + context.revolutions[rows, None] * x
    t = CubicSpline(np.arange(len(timeline.t)), timeline.t)(turn)
    phase = TURN * frequency * t
    if frequency in context.strays:
        phase += np.interp(t, *context.strays[frequency])
    signal = 2 * np.cos(phase)
    turn = turn * np.sign(context.omega[rows, None])
    alike = (signal * np.exp(-1j * TURN * context.order * turn)) @ (weight / weight.sum())
    return alike[:, None] * context.shares.get(frequency, np.ones(len(context.probes)))


def effects(rig: RigConfig) -> tuple[LineHum, ...]:
    """Return one for every usual mains frequency and its double."""
    unknown = pair("hum", "m", most=10e-6, size=1e-6)
    return tuple(
        LineHum(where=f"{n * f:.0f} Hz", frequency=n * f, parameters=unknown) for n in HARMONICS for f in MAINS
    )
