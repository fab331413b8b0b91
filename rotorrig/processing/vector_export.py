"""Order vectors as CSV, for people and programs that read nothing else; the conventions stand in its first lines."""

import csv
import io
from pathlib import Path

import numpy as np

from rotorrig.acquisition.exporters.whole_file import whole_file
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.units import RPM

_HEAD = (
    "# order vectors, raw; amplitude um 0-peak; phase lag deg = -arg z, z = 2 mean(x exp(-j theta)),",
    "# theta = 0 at the keyphasor edge; sigma um = one standard deviation of re or im;",
    "# slow-roll columns: the vector to subtract for compensation; config {config}, recording {recording}",
)


def write_csv(path: Path, response: OrderTrackedResponse) -> int:
    """Write every row, blank where it is not usable, and return their number. Raises DataError if that fails."""
    source = response.source
    head = [line.format(config=source.config_hash, recording=source.source_hash or source.source) for line in _HEAD]
    turning = [(n, order) for n, order in enumerate(response.orders) if order != 0]
    columns = [
        f"{probe} {order:g}X {what}"
        for probe in response.probes
        for _, order in turning
        for what in ("amplitude [um]", "phase lag [deg]", "sigma [um]", "slow-roll re [um]", "slow-roll im [um]")
    ]
    text = io.StringIO(newline="")
    text.write("\n".join(head) + "\n")
    writer = csv.writer(text)
    writer.writerow(["run", "time [s]", "speed [rpm]", "acceleration [rpm/s]", *columns])
    for row in range(len(response.omega)):
        writer.writerow(_line(response, row, [n for n, _ in turning]))
    with whole_file(path) as file:
        file.write(text.getvalue().encode())
    return len(response.omega)


def _line(response: OrderTrackedResponse, row: int, orders: list[int]) -> list[str]:
    cells = [
        response.runs[response.run[row]].name,
        f"{response.t[row]:.6f}",
        f"{response.omega[row] * RPM:.3f}",
        f"{response.alpha[row] * RPM:.4f}",
    ]
    for probe in range(len(response.probes)):
        for n in orders:
            cells += _vector(response, row, probe, n) if response.usable[row, probe] else [""] * 5
    return cells


def _vector(response: OrderTrackedResponse, row: int, probe: int, n: int) -> list[str]:
    z, slow = response.z[row, probe, n] * 1e6, response.slow_roll[probe, n] * 1e6
    variance = np.diag(response.covariance[row, n])[2 * probe : 2 * probe + 2]
    lag = -np.degrees(np.angle(z))
    sigma = 1e6 * np.sqrt(variance.mean())
    return [f"{value:.8g}" if np.isfinite(value) else "" for value in (abs(z), lag, sigma, slow.real, slow.imag)]
