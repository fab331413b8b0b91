"""Rows of a Bode table as runs over speed: which run each is of, which trial masses were on, in which order they stand.

A table may list its rows in any order, several runs among each other. They are gathered by run, and a run whose speeds
do not go its way, up or down, is sorted by speed. Rows that are consecutive revolutions tell the times by their order,
and stay in it. Trial masses that stand in columns divide a run of the mapping into one for each set that was on.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rotorrig.processing.files.bode_table_csv import Table
from rotorrig.processing.files.bode_table_mapping import DIRECTIONS, SLOW_ROLL, TableMapping, TableRun
from rotorrig.rig import DataError
from rotorrig.rig.config import RigConfig, TrialMass, validate_table

BACKWARDS = 0.01  # of the speed: measured speeds of a run-up may fall back by so much, from noise
SPEEDS = (0.01, 1e6)  # rad/s, 0.1 rpm to ten million: beyond them the unit is wrong
_SORTED = (
    "rows of the run '{name}' were not in the order of speed, and were sorted; where the speed went up and down, want "
    "a run for each"
)

Masses = tuple[TrialMass, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class TableRows:
    """The rows in the order in which they are used."""

    table: Table
    runs: tuple[TableRun, ...]
    run: NDArray[np.intp]  # (row,) index into `runs`
    omega: NDArray[np.float64]  # (row,) rad/s
    remarks: tuple[tuple[str, ...], ...]  # (row,) what was done to their order; empty: nothing


def arrange_rows(table: Table, mapping: TableMapping, rig: RigConfig) -> TableRows:
    """Sort the rows by run and speed. Raises DataError for a cell: file, row, column, got, wanted."""
    runs, run = _divide_by_masses(table, mapping, rig, _run_index(table, mapping))
    omega = _speeds(table, mapping)
    place = np.zeros(len(run))  # by which rows are sorted within their run; those alike stay as they are
    remarks: list[tuple[str, ...]] = [()] * len(run)
    for i, each in enumerate(runs):
        rows = np.flatnonzero(run == i)
        if _goes_its_way(omega[rows], each):
            continue
        if each.rows:
            raise _order_fault(table, mapping, rows, each)
        place[rows] = omega[rows] * (DIRECTIONS[each.direction] or 1)
        for row in rows:
            remarks[row] = (_SORTED.format(name=each.name),)
    order = np.lexsort((place, run))
    return TableRows(
        table=table.rows(order),
        runs=runs,
        run=run[order],
        omega=omega[order],
        remarks=tuple(remarks[i] for i in order) if any(remarks) else (),
    )


def _run_index(table: Table, mapping: TableMapping) -> NDArray[np.intp]:
    """Return the index of each row's run in the mapping."""
    if mapping.run_column is None:
        return np.zeros(len(table.lines), dtype=np.intp)
    index = {run.value: i for i, run in enumerate(mapping.runs) if run.value is not None}
    run = np.empty(len(table.lines), dtype=np.intp)
    for i, cell in enumerate(table.cells[mapping.run_column]):
        if cell not in index:
            raise table.fault(i, mapping.run_column, f"got '{cell:.60}', want one of {sorted(index)}, the runs' values")
        run[i] = index[cell]
    return run


def _divide_by_masses(
    table: Table, mapping: TableMapping, rig: RigConfig, run: NDArray[np.intp]
) -> tuple[tuple[TableRun, ...], NDArray[np.intp]]:
    """Return the runs with the masses that stand in the table, and each row's; those of one run by first appearance."""
    if not mapping.trial_columns:
        return mapping.runs, run
    masses = _masses(table, mapping, rig)
    runs: list[TableRun] = []
    index: dict[tuple[int, Masses], int] = {}
    for i, whole in enumerate(mapping.runs):
        rows = np.flatnonzero(run == i)
        sets = list(dict.fromkeys(masses[row] for row in rows))
        if whole.name == SLOW_ROLL and len(sets) > 1:
            row = next(int(row) for row in rows if masses[row] != sets[0])
            words = f"got other trial masses than above, want the same in all rows of '{SLOW_ROLL}'"
            raise table.fault(row, mapping.trial_columns[0].amount, words)
        for each in sets or [()]:
            index[i, each] = len(runs)
            name = f"{whole.name}, {_describe(each)}" if len(sets) > 1 else whole.name
            runs.append(whole.model_copy(update={"name": name, "trial": each}))
    return tuple(runs), np.array([index[int(i), mass] for i, mass in zip(run, masses, strict=True)], dtype=np.intp)


def _masses(table: Table, mapping: TableMapping, rig: RigConfig) -> list[Masses]:
    """Return the masses of every row, in the order of the mapping."""
    each: list[list[TrialMass]] = [[] for _ in table.lines]
    for trial in mapping.trial_columns:
        amounts = np.nan_to_num(table.numbers(trial.amount))
        angles = table.numbers(trial.angle)
        for row in np.flatnonzero(amounts):
            if amounts[row] < 0:
                raise table.fault(int(row), trial.amount, f"got {amounts[row]:g}, want an amount from 0 up")
            if np.isnan(angles[row]):
                raise table.fault(int(row), trial.angle, "got nothing beside an amount, want an angle")
            plane = trial.plane or table.cells[trial.plane_column or ""][row]
            if plane not in rig.unbalance_planes:
                want = f"want a disk or plane of the config, one of {list(rig.unbalance_planes)}"
                raise table.fault(int(row), trial.plane_column or "", f"got '{plane:.60}', {want}")
            amount, angle = float(amounts[row] * trial.amount_unit), float(angles[row] * trial.angle_unit)
            mass = {"disk": plane, "amount": amount, "angle": angle}
            where = f"{table.path}: row {table.lines[row]}"
            each[row].append(validate_table(TrialMass, mass, where=where, context={"si": True}))
    return [tuple(masses) for masses in each]


def _describe(masses: Masses) -> str:
    """Return "disk: 12 g mm at 90 deg"."""
    each = [f"{m.disk}: {m.amount * 1e6:.4g} g mm at {np.degrees(m.angle):.4g} deg" for m in masses]
    return " and ".join(each) or "no trial mass"


def _speeds(table: Table, mapping: TableMapping) -> NDArray[np.float64]:
    """Return omega (row,), checked to be that of a rotor."""
    column = mapping.speed.column
    raw = table.numbers(column)
    for i, value in enumerate(raw):
        if not value > 0:
            raise table.fault(i, column, f"got '{table.cells[column][i]:.60}', want a speed above 0")
        if not SPEEDS[0] <= float(value) * mapping.speed.unit <= SPEEDS[1]:
            raise table.fault(i, column, f"got {value:g}, want the speed of a rotor; is the unit right?")
    return np.asarray(raw * mapping.speed.unit)


def _goes_its_way(omega: NDArray[np.float64], run: TableRun) -> bool:
    """Say whether the speeds of a run (row,) go the way it says, of a dwell either way; noise does not count."""
    if run.direction == "dwell" and run.rows:
        return True
    directions = [DIRECTIONS[run.direction]] if DIRECTIONS[run.direction] else [1, -1]
    return any(not _backwards(way * omega).any() for way in directions)


def _backwards(rising: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Say which of the speeds (row,), negative where they should fall, lie behind one before them."""
    return np.asarray(np.maximum.accumulate(rising) - rising > BACKWARDS * np.abs(rising))


def _order_fault(table: Table, mapping: TableMapping, rows: NDArray[np.intp], run: TableRun) -> DataError:
    raw = DIRECTIONS[run.direction] * table.numbers(mapping.speed.column)[rows]
    k = int(np.argmax(_backwards(raw)))
    return table.fault(
        int(rows[k]),
        mapping.speed.column,
        f"got {abs(raw[k]):g} after {abs(raw[:k].max()):g}, want speeds that only "
        f"{'rise' if run.direction == 'up' else 'fall'} in run '{run.name}', whose rows are consecutive revolutions",
    )
