"""Export of order vectors as a universal file: a data set 58 of type 27, order function over rpm, each.

Complex, metres 0-peak, raw; x = Re(z exp(j theta)), so the phase lag is -arg z. The identification lines say so, and
the slow-roll vector to subtract for compensation. Two probes in a plane make two more data sets for each order: its
forward and backward whirl, of orders n and -n, the radii of two circles. Rows that are not usable are left out.
"""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.exporters import (
    DISPLACEMENT,
    ORDER,
    ORDER_FUNCTION,
    RPM,
    Axis,
    Function,
    ascii_function,
    direction,
    units_in_si,
)
from rotorrig.processing.probe_planes import whirl
from rotorrig.processing.response import OrderTrackedResponse, require_phases
from rotorrig.processing.tracking import whirl_vectors
from rotorrig.rig import write_whole_file
from rotorrig.rig.config import units

_CONVENTION = "m 0-peak, z = 2 mean(x e^-j theta), x = Re(z e^j theta); phase lag = -arg z"
_WHIRL = {  # f forward, b backward
    "x-to-y": "m radius, x + jy = f e^jn theta + b* e^-jn theta; phase lag = -arg",
    "y-to-x": "m radius, x - jy = f e^jn theta + b* e^-jn theta; phase lag = -arg",
}


def write_uff(path: Path, response: OrderTrackedResponse) -> int:
    """Write every run, probe, plane and turning order and return the number of data sets. Raises DataError."""
    require_phases([response], "a universal file")
    turning = [n for n, order in enumerate(response.orders) if order]
    written = 0
    with write_whole_file(path) as file:
        file.write(units_in_si())
        for run in range(len(response.runs)):
            for function in (*_of_probes(response, run, turning), *_of_planes(response, run, turning)):
                file.write(ascii_function(function))
                written += 1
    return written


def _of_probes(response: OrderTrackedResponse, run: int, turning: list[int]) -> Iterator[Function]:
    for probe, n in product(range(len(response.probes)), turning):
        rows = np.flatnonzero((response.run == run) & response.usable[:, probe])
        name, order = response.probes[probe], response.orders[n]
        if len(rows):
            yield _function(
                response,
                rows,
                response.z[rows, probe, n],
                title=f"{name} {order:g}X",
                convention=_CONVENTION,
                slow=complex(response.slow_roll[probe, n]),
                name=name,
                position=response.rig.probe(name).position,
                direction=direction(response.rig, name),
                order=order,
            )


def _of_planes(response: OrderTrackedResponse, run: int, turning: list[int]) -> Iterator[Function]:
    for n in turning:
        order = response.orders[n]
        for vectors in whirl_vectors(response, order=order) if order > 0 else ():
            rows = np.flatnonzero((response.run == run) & vectors.usable)
            places = [response.probes.index(name) for name in vectors.plane.probes]
            slow = whirl(vectors.plane, response.slow_roll[places, n], rotation=response.rig.rotation)
            name = "/".join(vectors.plane.probes)
            for sign, way, z, vector in (
                (1, "forward", vectors.forward, slow[0]),
                (-1, "backward", vectors.backward, slow[1]),
            ):
                if len(rows):
                    yield _function(
                        response,
                        rows,
                        z[rows],
                        title=f"{name} {sign * order:+g}X {way}",
                        convention=_WHIRL[response.rig.rotation],
                        slow=complex(vector),
                        name=name,
                        position=vectors.plane.position,
                        direction=0,
                        order=sign * order,
                    )


def _function(
    response: OrderTrackedResponse,
    rows: NDArray[np.intp],
    values: NDArray[np.complex128],
    *,
    title: str,
    convention: str,
    slow: complex,
    name: str,
    position: float,
    direction: int,
    order: float,
) -> Function:
    rig, source = response.rig, response.source
    run = response.runs[response.run[rows[0]]]
    planes = sorted({p.position for p in rig.probes})
    lines = (
        f"{title}, run {run.name}",
        convention,
        _slow_roll(slow, response.slow_roll_omega),
        f"theta = 0 at keyphasor edge; rotor {rig.rotation}; x to probe; {_window(response, rows)}",
        f"recording {source.source} {source.source_hash}, config {source.config_hash}",
    )
    return Function(
        kind=ORDER_FUNCTION,
        lines=lines,
        name=name,
        node=1 + planes.index(position),
        direction=direction,
        abscissa=Axis(RPM, "speed", "rpm"),
        ordinate=Axis(DISPLACEMENT, "0-peak", "m"),
        z_axis=Axis(ORDER, "order"),
        z_value=order,
        x=response.omega[rows] * units.RPM,
        values=values,
    )


def _window(response: OrderTrackedResponse, rows: NDArray[np.intp]) -> str:
    """Return the window a row's vector is the mean under; all rows of a run are of one length."""
    turns = response.revolutions[rows[0]]
    return f"{response.window} {turns:.4g} turns" if np.isfinite(turns) else response.window


def _slow_roll(z: complex, omega: float) -> str:
    if not np.isfinite(z):
        return "raw; no slow roll"
    return f"raw; slow roll {z.real:.6e} {z.imag:+.6e}j m at {omega * units.RPM:.1f} rpm"
