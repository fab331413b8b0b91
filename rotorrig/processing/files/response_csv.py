"""Export of order vectors as CSV; the conventions stand in its first lines."""

import csv
import io
from pathlib import Path

import numpy as np

from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.tracking import WhirlVectors, whirl_vectors
from rotorrig.rig import write_whole_file
from rotorrig.rig.config import RPM, UM

_HEAD = (
    "# order vectors, raw; amplitude um 0-peak; phase lag deg = -arg z, z = 2 mean(x exp(-j theta)),",
    "# theta = 0 at the keyphasor edge; sigma um = one standard deviation of re or im;",
    "# slow-roll columns: the vector to subtract for compensation; config {config}, recording {recording}",
    "# +nX, -nX of a plane of two probes: f and b of x + j y = f exp(j n theta) + conj(b) exp(-j n theta), {sense};",
    "# f turns forward, with the rotor, b backward; amplitude um = radius of the circle; raw, no slow roll taken off",
    "# a row is the mean of its vector over {turns} turns under the weights '{window}'; method {method}",
)
_SENSE = {"x-to-y": "rotation from x to y", "y-to-x": "with -j y for j y, as the rotor turns from y to x"}
_VECTOR = ("amplitude [um]", "phase lag [deg]", "sigma [um]")
_SLOW_ROLL = ("slow-roll re [um]", "slow-roll im [um]")


def write_csv(path: Path, response: OrderTrackedResponse) -> int:
    """Write every row, blank where it is not usable, and return their number. Raises DataError if that fails."""
    turning = [order for order in response.orders if order != 0]
    whirls = [w for order in turning if order > 0 for w in whirl_vectors(response, order=order)]
    probes = [(p, response.orders.index(order)) for p in range(len(response.probes)) for order in turning]
    columns = [
        f"{response.probes[p]} {response.orders[n]:g}X {what}" for p, n in probes for what in _VECTOR + _SLOW_ROLL
    ]
    columns += [
        f"{'/'.join(w.plane.probes)} {sign}{w.order:g}X {what}" for w in whirls for sign in "+-" for what in _VECTOR
    ]
    text = io.StringIO(newline="")
    text.write("\n".join(_head(response)) + "\n")
    writer = csv.writer(text)
    writer.writerow(["run", "time [s]", "speed [rpm]", "acceleration [rpm/s]", *columns, "reasons", "remarks"])
    for row in range(len(response.omega)):
        cells = _place(response, row)
        cells += [cell for p, n in probes for cell in _vector(response, row, p, n)]
        cells += [cell for whirl in whirls for cell in _whirl(whirl, row)]
        remarks = response.remarks[row] if response.remarks else ()
        writer.writerow([*cells, "; ".join(response.reasons[row]), "; ".join(remarks)])
    with write_whole_file(path) as file:
        file.write(text.getvalue().encode())
    return len(response.omega)


def _head(response: OrderTrackedResponse) -> list[str]:
    source, turns = response.source, np.unique(response.revolutions[np.isfinite(response.revolutions)])
    lines = [
        line.format(
            config=source.config_hash,
            recording=source.source_hash or source.source,
            sense=_SENSE[response.rig.rotation],
            turns=" to ".join(f"{n:g}" for n in turns[[0, -1][: len(turns)]]) or "unknown",
            window=response.window,
            method=response.method,
        )
        for line in _HEAD
    ]
    if response.amplitudes_alone:
        lines.append("# amplitudes alone: the table they came from had no phases; sigma um is that of an amplitude")
    if np.isfinite(response.compensation_omega):
        rpm = response.compensation_omega * RPM
        lines.append(f"# not raw: the table they came from was slow-roll compensated by vectors of {rpm:.0f} rpm")
    return lines + [f"# slow roll: {remark}" for remark in response.slow_roll_remarks]


def _place(response: OrderTrackedResponse, row: int) -> list[str]:
    return [
        response.runs[response.run[row]].name,
        f"{response.t[row]:.6f}",
        f"{response.omega[row] * RPM:.3f}",
        f"{response.alpha[row] * RPM:.4f}",
    ]


def _vector(response: OrderTrackedResponse, row: int, probe: int, n: int) -> list[str]:
    if not response.usable[row, probe]:
        return [""] * len(_VECTOR + _SLOW_ROLL)
    slow = response.slow_roll[probe, n] * UM
    variance = np.diag(response.covariance[row, n])[2 * probe : 2 * probe + 2]
    amplitude, lag, sigma = _polar(response.z[row, probe, n], np.sqrt(variance.mean()))
    if response.amplitudes_alone:
        lag = np.float64(np.nan)
    return _numbers([amplitude, lag, sigma, slow.real, slow.imag])


def _whirl(whirl: WhirlVectors, row: int) -> list[str]:
    if not whirl.usable[row]:
        return [""] * 2 * len(_VECTOR)
    forward, backward = whirl.sigma[row]
    return _numbers([*_polar(whirl.forward[row], forward), *_polar(whirl.backward[row], backward)])


def _polar(z: np.complex128, sigma: np.float64) -> list[np.float64]:
    """Return amplitude [um], phase lag [deg] and sigma [um] of z [m]."""
    return [abs(z) * UM, -np.degrees(np.angle(z)), sigma * UM]


def _numbers(values: list[np.float64]) -> list[str]:
    return [f"{value:.8g}" if np.isfinite(value) else "" for value in values]
