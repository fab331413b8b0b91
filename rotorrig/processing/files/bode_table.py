"""Import of order vectors tracked by others: a Bode table in CSV, read by a mapping (see `bode_table_mapping`).

Where the mapping says how fast the speed moved, times and keyphasor pulses are derived (`bode_table_times`), so that
the model can take the moving speed into account. Where the table says nothing of its uncertainty it is estimated
from the scatter of neighbouring rows (`bode_table_noise`). Vectors that were slow-roll compensated are restored where
what was subtracted is known; else the response says at which speed, and the model subtracts its own.
"""

import csv
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_mapping import (
    DIRECTIONS,
    SLOW_ROLL,
    StatedSlowRoll,
    TableMapping,
    TableRun,
    VectorColumns,
    load_mapping,
)
from rotorrig.processing.files.bode_table_noise import estimate_covariance
from rotorrig.processing.files.bode_table_sign import sign_remark
from rotorrig.processing.files.bode_table_times import derive_times
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.processing.slow_roll import FirstOrder, chosen_rows, validity_remarks
from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.rig import DataError, Provenance, code_version, file_hash
from rotorrig.rig.config import RigConfig, micrometres, trial_unbalance

BACKWARDS = 0.01  # of the speed: measured speeds of a run-up may fall back by so much, from noise
SPEEDS = (0.01, 1e6)  # rad/s, 0.1 rpm to ten million: beyond them the unit is wrong
LARGEST = 1.0  # m
LEFT = 5.0  # sigma of a slow roll in a compensated table: more was not subtracted
PEAK = {"0-peak": 1.0, "peak-to-peak": 0.5, "rms": math.sqrt(2.0)}


def read_table(csv_path: Path, mapping_path: Path, rig: RigConfig) -> OrderTrackedResponse:
    """Return the vectors of a Bode table.

    Probes of the rig that the table lacks are there as unusable rows. Raises ConfigError for the mapping and
    DataError for the table: file, row (line of the file), column, got, wanted.
    """
    mapping = load_mapping(mapping_path, rig)
    table = _read_csv(csv_path, mapping)
    run = _run_index(table, mapping)
    omega = _speeds(table, mapping, run)
    orders = tuple(sorted({vector.order for vector in mapping.vectors}))
    z = _vectors(table, mapping, rig, orders)
    times = derive_times(omega, mapping.runs, run)
    try:
        covariance = estimate_covariance(
            z, run, mapping.uncertainty, first=orders.index(1.0) if 1.0 in orders else None
        )
        usable, reasons = _usable(z, covariance, rig, mapping)
        slow, compensation_omega = _slow_roll(z, covariance, omega, run, mapping, rig, orders)
    except DataError as error:
        raise DataError(f"{csv_path}: {error}") from error
    if mapping.compensated:
        z = z + np.nan_to_num(slow.z)
    response = OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=orders,
        runs=tuple(_run(table_run) for table_run in mapping.runs),
        run=run,
        t=times.t,
        omega=omega,
        alpha=times.alpha,
        revolutions=times.revolutions,
        window=mapping.window,
        z=z,
        covariance=covariance,
        slow_roll=slow.z,
        slow_roll_covariance=slow.covariance,
        slow_roll_omega=slow.omega,
        usable=usable,
        reasons=reasons,
        keyphasor_t=times.pulses,
        compensation_omega=compensation_omega,
        derived_times=times.derived,
        remarks=times.remarks,
        source=Provenance(
            config_hash=rig.hash,
            code_version=code_version(),
            source=csv_path.name,
            source_hash=file_hash(csv_path),
        ),
    )
    if sign := sign_remark(response):
        response = replace(response, remarks=tuple((*row, sign) for row in response.remarks or ((),) * len(omega)))
    first = FirstOrder.of(response, chosen_rows(response))
    return replace(response, slow_roll_remarks=slow.remarks + (validity_remarks(first, slow) if first else ()))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Table:
    """CSV file as text cells, with the line each row stands in."""

    path: Path
    cells: dict[str, list[str]]
    lines: list[int]

    def numbers(self, column: str) -> NDArray[np.float64]:
        """Return a column (row,); blank and "nan" are NaN. Raises DataError for other text."""
        values = np.empty(len(self.lines))
        for i, cell in enumerate(self.cells[column]):
            try:
                values[i] = float(cell) if cell else np.nan
            except ValueError as error:
                raise self.fault(i, column, f"got '{cell:.60}', want a number") from error
            if math.isinf(values[i]):
                raise self.fault(i, column, f"got '{cell:.60}', want a finite number")
        return values

    def fault(self, row: int, column: str, words: str) -> DataError:
        return DataError(f"{self.path}: row {self.lines[row]}, column '{column}': {words}")


def _read_csv(path: Path, mapping: TableMapping) -> _Table:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, delimiter=mapping.delimiter)
            rows = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}), want a table in CSV") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{path}: is no CSV text ({error})") from error
    rows = [(line, row) for line, row in rows if any(row) and not row[0].startswith("#")]
    if len(rows) < 2:
        raise DataError(f"{path}: has {max(len(rows) - 1, 0)} rows below its header, want at least one")
    header = rows[0][1]
    for column in _columns(mapping):
        if header.count(column) != 1:
            got = "two columns of that name" if column in header else f"the columns {header}"
            raise DataError(f"{path}: want one column '{column}', got {got}")
    for line, row in rows[1:]:
        if len(row) != len(header):
            raise DataError(f"{path}: row {line}: got {len(row)} cells, want {len(header)} as in the header")
    cells = {name: [row[i] for _, row in rows[1:]] for i, name in enumerate(header)}
    return _Table(path=path, cells=cells, lines=[line for line, _ in rows[1:]])


def _columns(mapping: TableMapping) -> list[str]:
    named = [mapping.speed.column, *(column for vector in mapping.vectors for column in vector.columns)]
    return [*named, mapping.run_column] if mapping.run_column else named


def _run_index(table: _Table, mapping: TableMapping) -> NDArray[np.intp]:
    """Return the index of each row's run."""
    if mapping.run_column is None:
        return np.zeros(len(table.lines), dtype=np.intp)
    index = {run.value: i for i, run in enumerate(mapping.runs) if run.value is not None}
    run = np.empty(len(table.lines), dtype=np.intp)
    for i, cell in enumerate(table.cells[mapping.run_column]):
        if cell not in index:
            raise table.fault(i, mapping.run_column, f"got '{cell:.60}', want one of {sorted(index)}, the runs' values")
        run[i] = index[cell]
    return run


def _speeds(table: _Table, mapping: TableMapping, run: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return omega (row,), checked to be positive and to go the way of each run."""
    column = mapping.speed.column
    raw = table.numbers(column)
    for i, value in enumerate(raw):
        if not value > 0:
            raise table.fault(i, column, f"got '{table.cells[column][i]:.60}', want a speed above 0")
        if not SPEEDS[0] <= float(value) * mapping.speed.unit <= SPEEDS[1]:
            raise table.fault(i, column, f"got {value:g}, want the speed of a rotor; is the unit right?")
    for index, table_run in enumerate(mapping.runs):
        rows, direction = np.flatnonzero(run == index), DIRECTIONS[table_run.direction]
        furthest = np.maximum.accumulate(direction * raw[rows])
        back = furthest - direction * raw[rows] > BACKWARDS * raw[rows]
        if direction and back.any():
            k = int(np.argmax(back))
            raise table.fault(
                int(rows[k]),
                column,
                f"got {raw[rows[k]]:g} after {abs(furthest[k]):g}, want speeds that only "
                f"{'rise' if direction > 0 else 'fall'} in run '{table_run.name}'",
            )
    return raw * mapping.speed.unit


def _vectors(table: _Table, mapping: TableMapping, rig: RigConfig, orders: tuple[float, ...]) -> NDArray[np.complex128]:
    """Return z (row, probe, order) in the README's convention; NaN where the table has nothing."""
    names = [probe.name for probe in rig.probes]
    z = np.full((len(table.lines), len(names), len(orders)), np.nan, dtype=complex)
    for vector in mapping.vectors:
        z[:, names.index(vector.probe), orders.index(vector.order)] = _vector(table, vector)
    return z


def _vector(table: _Table, vector: VectorColumns) -> NDArray[np.complex128]:
    first, second = (table.numbers(column) for column in vector.columns)
    scale = vector.unit * PEAK[vector.amplitude_is]
    _check_size(table, first, vector.columns[0], LARGEST / scale)
    if vector.amplitude is None:
        _check_size(table, second, vector.columns[1], LARGEST / scale)
    if vector.amplitude is None or vector.phase_unit is None:
        return np.asarray(scale * (first + (-1j if vector.conjugated else 1j) * second))
    if (negative := np.flatnonzero(first < 0)).size:
        raise table.fault(
            int(negative[0]), vector.amplitude, f"got {first[negative[0]]:g}, want an amplitude from 0 up"
        )
    sign = -1.0 if vector.phase_is == "lag" else 1.0
    return scale * first * np.exp(1j * sign * vector.phase_unit * second)


def _check_size(table: _Table, values: NDArray[np.float64], column: str, limit: float) -> None:
    """Raise DataError for a value beyond `limit`, in the column's unit."""
    if (beyond := np.flatnonzero(np.abs(values) > limit)).size:
        wrong = f"got {values[beyond[0]]:g}, want a vibration of less than {LARGEST:g} m; is the unit right?"
        raise table.fault(int(beyond[0]), column, wrong)


def _usable(
    z: NDArray[np.complex128], covariance: NDArray[np.float64], rig: RigConfig, mapping: TableMapping
) -> tuple[NDArray[np.bool_], tuple[tuple[str, ...], ...]]:
    """Return usable (row, probe) and the reasons (row,): a probe needs all of its vectors, each with an uncertainty."""
    names = [probe.name for probe in rig.probes]
    mapped = {vector.probe for vector in mapping.vectors}
    present = np.asarray(np.isfinite(z).all(axis=2))
    certain = np.asarray((np.diagonal(covariance, axis1=2, axis2=3)[..., 0::2] <= 0).any(axis=1))
    words = {name: "no value" if name in mapped else "not in the table" for name in names}
    reasons = [
        tuple(
            f"{name}: {words[name] if not there else 'an amplitude of 0 without an absolute uncertainty'}"
            for name, there, sure in zip(names, *row, strict=True)
            if sure or not there
        )
        for row in zip(present, certain, strict=True)
    ]
    return present & ~certain, tuple(reasons)


def _slow_roll(
    z: NDArray[np.complex128],
    covariance: NDArray[np.float64],
    omega: NDArray[np.float64],
    run: NDArray[np.intp],
    mapping: TableMapping,
    rig: RigConfig,
    orders: tuple[float, ...],
) -> tuple[slow_roll.SlowRoll, float]:
    """Return the stated slow roll, or that of the run named "slow roll", or none.

    And the speed [rad/s] of one whose vector was subtracted and is not known; NaN: there is no such. Raises DataError
    if that speed is not known either.
    """
    nothing = slow_roll.none(probes=z.shape[1], orders=z.shape[2])
    if mapping.slow_roll is not None and mapping.slow_roll.vectors:
        return _convert_stated(mapping.slow_roll, nothing, covariance, rig, orders), math.nan
    if mapping.slow_roll is not None:
        return nothing, mapping.slow_roll.speed
    index = next((i for i, table_run in enumerate(mapping.runs) if table_run.name == SLOW_ROLL), None)
    rows = run == index
    if index is None or not rows.any():
        if mapping.compensated:
            raise DataError(f"has no row of the run '{SLOW_ROLL}', want some, or [slow_roll] in the mapping")
        return nothing, math.nan
    usable = np.isfinite(z[rows]).all(axis=2)
    slow = slow_roll.estimate(z[rows], covariance[rows], omega[rows], usable=usable)
    if not mapping.compensated:
        return slow, math.nan
    _check_nothing_left(slow, rig, orders)
    return nothing, slow.omega


def _check_nothing_left(slow: slow_roll.SlowRoll, rig: RigConfig, orders: tuple[float, ...]) -> None:
    """Raise DataError if a compensated table shows a slow roll that is not zero."""
    sigma = np.sqrt(np.diagonal(slow.covariance, axis1=1, axis2=2)[:, 0::2].T)  # (probe, order)
    for p, n in np.argwhere(np.abs(slow.z) > LEFT * sigma):
        raise DataError(
            f"the run '{SLOW_ROLL}' has {micrometres(abs(slow.z[p, n]))} um at probe '{rig.probes[p].name}', order "
            f"{orders[n]:g}, and a compensated table nothing there; if that is what was subtracted, want it in "
            "[slow_roll] of the mapping, else compensated = false"
        )


def _convert_stated(
    stated: StatedSlowRoll,
    nothing: slow_roll.SlowRoll,
    covariance: NDArray[np.float64],
    rig: RigConfig,
    orders: tuple[float, ...],
) -> slow_roll.SlowRoll:
    """Return the slow roll as stated; as uncertain as the median row."""
    names = [probe.name for probe in rig.probes]
    z = nothing.z.copy()
    for vector in stated.vectors:
        z[names.index(vector.probe), orders.index(vector.order)] = vector.amplitude * np.exp(1j * vector.phase)
    known = np.isfinite(covariance).any(axis=0)
    median = np.nanmedian(np.where(known, covariance, 0.0), axis=0)  # a row may lack a value, a probe all of them
    return replace(nothing, z=z, covariance=np.where(known, median, np.nan), omega=stated.speed)


def _run(table_run: TableRun) -> Run:
    direction = DIRECTIONS[table_run.direction]
    return Run(name=table_run.name, direction=direction, trial_unbalance=trial_unbalance(table_run.trial))
