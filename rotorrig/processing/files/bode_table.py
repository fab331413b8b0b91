"""Import of order vectors tracked by others: a Bode table in CSV, read by a mapping (see `bode_table_mapping`).

Rows may stand in any order (`bode_table_rows`). Where the mapping says how fast the speed moved, times and keyphasor
pulses are derived (`bode_table_times`), so that the model can take the moving speed into account. Where the table says
nothing of its uncertainty it is estimated from the scatter of neighbouring rows (`bode_table_noise`). Vectors that were
slow-roll compensated are restored where what was subtracted is known; else the response says at which speed, and the
model subtracts its own.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_checks import load_mapping
from rotorrig.processing.files.bode_table_csv import read_csv
from rotorrig.processing.files.bode_table_mapping import (
    DIRECTIONS,
    SLOW_ROLL,
    StatedSlowRoll,
    TableMapping,
    TableRun,
)
from rotorrig.processing.files.bode_table_noise import estimate_covariance
from rotorrig.processing.files.bode_table_rows import TableRows, arrange_rows
from rotorrig.processing.files.bode_table_sign import sign_remark
from rotorrig.processing.files.bode_table_times import derive_times
from rotorrig.processing.files.bode_table_vectors import absolute_sigma, read_vectors
from rotorrig.processing.response import OrderTrackedResponse, Run
from rotorrig.processing.slow_roll import FirstOrder, chosen_rows, validity_remarks
from rotorrig.processing.slow_roll import vector as slow_roll
from rotorrig.rig import DataError, Provenance, code_version, file_hash
from rotorrig.rig.config import RigConfig, micrometres, trial_unbalance

LEFT = 5.0  # sigma of a slow roll in a compensated table: more was not subtracted


def read_table(csv_path: Path, mapping_path: Path, rig: RigConfig) -> OrderTrackedResponse:
    """Return the vectors of a Bode table.

    Probes of the rig that the table lacks are there as unusable rows. Raises ConfigError for the mapping and
    DataError for the table: file, row (line of the file), column, got, wanted.
    """
    mapping = load_mapping(mapping_path, rig)
    rows = arrange_rows(read_csv(csv_path, delimiter=mapping.delimiter, columns=mapping.columns), mapping, rig)
    orders = tuple(sorted({vector.order for vector in mapping.vectors}))
    z = read_vectors(rows.table, mapping, rig, orders, rows.omega)
    times = derive_times(rows.omega, rows.runs, rows.run)
    try:
        covariance = estimate_covariance(
            z,
            rows.run,
            mapping.uncertainty,
            absolute=absolute_sigma(mapping, orders, rows.omega),
            first=orders.index(1.0) if 1.0 in orders else None,
            amplitudes_alone=mapping.amplitudes_alone,
        )
        usable, reasons = _usable(z, covariance, rig, mapping)
        slow, compensation_omega = _slow_roll(z, covariance, rows, mapping, rig, orders)
    except DataError as error:
        raise DataError(f"{csv_path}: {error}") from error
    if mapping.compensated:
        z = z + np.nan_to_num(slow.z)
    response = OrderTrackedResponse(
        rig=rig,
        probes=tuple(probe.name for probe in rig.probes),
        orders=orders,
        runs=tuple(_run(table_run) for table_run in rows.runs),
        run=rows.run,
        t=times.t,
        omega=rows.omega,
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
        remarks=_join_remarks(times.remarks, rows.remarks),
        amplitudes_alone=mapping.amplitudes_alone,
        source=_describe_source(csv_path, rig),
    )
    return _add_remarks(response, slow)


def _describe_source(csv_path: Path, rig: RigConfig) -> Provenance:
    return Provenance(
        config_hash=rig.hash,
        code_version=code_version(),
        source=csv_path.name,
        source_hash=file_hash(csv_path),
    )


def _add_remarks(response: OrderTrackedResponse, slow: slow_roll.SlowRoll) -> OrderTrackedResponse:
    """Return the response with what speaks against the sign of its phases and against its slow roll."""
    if sign := sign_remark(response):
        response = replace(response, remarks=_join_remarks(response.remarks, ((sign,),) * len(response.omega)))
    first = FirstOrder.of(response, chosen_rows(response))
    return replace(response, slow_roll_remarks=slow.remarks + (validity_remarks(first, slow) if first else ()))


def _join_remarks(*each: tuple[tuple[str, ...], ...]) -> tuple[tuple[str, ...], ...]:
    """Return the remarks (row,) of all parts together; a part may be empty."""
    parts = [part for part in each if part]
    return tuple(tuple(word for words in row for word in words) for row in zip(*parts, strict=True))


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
    table_rows: TableRows,
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
    index = next((i for i, table_run in enumerate(table_rows.runs) if table_run.name == SLOW_ROLL), None)
    rows = table_rows.run == index
    if index is None or not rows.any():
        if mapping.compensated:
            raise DataError(f"has no row of the run '{SLOW_ROLL}', want some, or [slow_roll] in the mapping")
        return nothing, math.nan
    usable = np.isfinite(z[rows]).all(axis=2)
    slow = slow_roll.estimate(z[rows], covariance[rows], table_rows.omega[rows], usable=usable)
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
