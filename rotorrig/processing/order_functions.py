"""Order vectors as a universal file: a data set 58 of type 27, order function over rpm, of each run, probe and order.

Complex, metres 0-peak, raw; x = Re(z exp(j theta)), so the phase lag is -arg z. The identification lines say so, and
the slow-roll vector to subtract for compensation. Rows that are not usable are left out.
"""

from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.exporters.uff import direction
from rotorrig.acquisition.exporters.uff58 import (
    DISPLACEMENT,
    ORDER,
    ORDER_FUNCTION,
    RPM,
    Axis,
    Function,
    ascii_function,
    units_in_si,
)
from rotorrig.acquisition.exporters.whole_file import whole_file
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig import units

_CONVENTION = "m 0-peak, z = 2 mean(x e^-j theta), x = Re(z e^j theta); phase lag = -arg z"


def write_uff(path: Path, response: OrderTrackedResponse) -> int:
    """Write every run, probe and turning order and return the number of data sets. Raises DataError."""
    written = 0
    with whole_file(path) as file:
        file.write(units_in_si())
        indices = (range(len(names)) for names in (response.runs, response.probes, response.orders))
        for run, probe, order in product(*indices):
            rows = np.flatnonzero((response.run == run) & response.usable[:, probe])
            if len(rows) and response.orders[order]:
                file.write(ascii_function(_function(response, rows, probe, order)))
                written += 1
    return written


def _function(response: OrderTrackedResponse, rows: NDArray[np.intp], probe: int, order: int) -> Function:
    name, factor = response.probes[probe], response.orders[order]
    rig, source = response.rig, response.source
    run = response.runs[response.run[rows[0]]]
    planes = sorted({p.position for p in rig.probes})
    lines = (
        f"{name} {factor:g}X, run {run.name}",
        _CONVENTION,
        _slow_roll(response, probe, order),
        f"theta = 0 at the keyphasor edge; rotation {rig.rotation}; x towards the probe",
        f"recording {source.source} {source.source_hash}, config {source.config_hash}",
    )
    return Function(
        kind=ORDER_FUNCTION,
        lines=lines,
        name=name,
        node=1 + planes.index(rig.probe(name).position),
        direction=direction(rig, name),
        abscissa=Axis(RPM, "speed", "rpm"),
        ordinate=Axis(DISPLACEMENT, "0-peak", "m"),
        z_axis=Axis(ORDER, "order"),
        z_value=factor,
        x=response.omega[rows] * units.RPM,
        values=response.z[rows, probe, order],
    )


def _slow_roll(response: OrderTrackedResponse, probe: int, order: int) -> str:
    z = response.slow_roll[probe, order]
    if not np.isfinite(z):
        return "raw; no slow roll"
    return f"raw; slow roll {z.real:.6e} {z.imag:+.6e}j m at {response.slow_roll_omega * units.RPM:.1f} rpm"
