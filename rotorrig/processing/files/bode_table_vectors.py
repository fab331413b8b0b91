"""Vectors of a Bode table in the README's convention: amplitudes, phases and units as the mapping says.

Velocities and accelerations become displacements: x = Re(z exp(j n theta)) has v = j n omega z and a = (j n omega)^2 z
at a speed that is steady over a turn.
"""

import math

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_csv import Table
from rotorrig.processing.files.bode_table_mapping import VIBRATIONS, TableMapping, VectorColumns, Vibration
from rotorrig.rig.config import RigConfig

LARGEST = 1.0  # m
PEAK = {"0-peak": 1.0, "peak-to-peak": 0.5, "rms": math.sqrt(2.0)}

Reals = NDArray[np.float64]
Complex = NDArray[np.complex128]


def read_vectors(
    table: Table, mapping: TableMapping, rig: RigConfig, orders: tuple[float, ...], omega: Reals
) -> Complex:
    """Return z (row, probe, order) m; NaN where the table has nothing, real where it has amplitudes alone."""
    names = [probe.name for probe in rig.probes]
    z = np.full((len(table.lines), len(names), len(orders)), np.nan, dtype=complex)
    for vector in mapping.vectors:
        z[:, names.index(vector.probe), orders.index(vector.order)] = _vector(table, vector, omega)
    return z


def displacement(unit: Vibration, omega: Reals, order: float) -> Complex:
    """Return the vector [m] of a vector 1 of that order and unit at the speeds `omega` (row,) [rad/s].

    >>> displacement((0.001, "velocity"), np.array([100.0]), 1.0)  # 1 mm/s at 100 rad/s: 10 um, 90 degrees later
    array([0.-1.e-05j])
    """
    scale, quantity = unit
    if quantity == "length":  # of the mean position too, which has no derivative
        return np.full(len(omega), scale + 0j)
    return np.asarray(scale * (-1j / (order * omega)) ** VIBRATIONS.index(quantity))


def absolute_sigma(mapping: TableMapping, orders: tuple[float, ...], omega: Reals) -> Reals:
    """Return the stated absolute uncertainty as one of a displacement, (row, order) m."""
    stated = mapping.uncertainty.absolute if mapping.uncertainty else None
    if stated is None:
        return np.zeros((len(omega), len(orders)))
    each = [np.abs(displacement(stated, omega, order)) for order in orders]
    return np.stack(each, axis=1)


def _vector(table: Table, vector: VectorColumns, omega: Reals) -> Complex:
    columns = [table.numbers(column) for column in vector.columns]
    one = PEAK[vector.amplitude_is] * displacement(vector.unit, omega, vector.order)  # m, of a 1 in the table
    lengths = 1 if vector.amplitude is not None else 2
    for values, column in list(zip(columns, vector.columns, strict=True))[:lengths]:
        _check_size(table, values, column, LARGEST / np.abs(one))
    if vector.amplitude is None:
        return np.asarray(one * (columns[0] + (-1j if vector.conjugated else 1j) * columns[1]))
    if (negative := np.flatnonzero(columns[0] < 0)).size:
        raise table.fault(
            int(negative[0]), vector.amplitude, f"got {columns[0][negative[0]]:g}, want an amplitude from 0 up"
        )
    if vector.phase_unit is None:
        return np.asarray(np.abs(one) * columns[0] + 0j)
    sign = -1.0 if vector.phase_is == "lag" else 1.0
    return np.asarray(one * columns[0] * np.exp(1j * sign * vector.phase_unit * columns[1]))


def _check_size(table: Table, values: Reals, column: str, limit: Reals) -> None:
    """Raise DataError for a value beyond `limit` (row,) or one for all, in the column's unit."""
    if (beyond := np.flatnonzero(np.abs(values) > limit)).size:
        wrong = f"got {values[beyond[0]]:g}, want a vibration of less than {LARGEST:g} m; is the unit right?"
        raise table.fault(int(beyond[0]), column, wrong)
