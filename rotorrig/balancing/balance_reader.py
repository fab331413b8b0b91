"""Read `balance.json` as the `Balance` it was written from, to seven digits."""

import cmath
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.balance import Balance
from rotorrig.balancing.correction import Correction
from rotorrig.balancing.determinacy import Combination, Determinacy
from rotorrig.balancing.discrete import Holes, Placing
from rotorrig.balancing.grade import Grade
from rotorrig.balancing.prediction import Comparison, Prediction
from rotorrig.identify.result_files import BALANCE, complex_in, infinite, number, numbers_in, read_table
from rotorrig.rig import DataError, Provenance

Table = dict[str, Any]


def read_balance(path: Path) -> Balance:
    """Read balance.json. Raises DataError naming the file if it is none, or something in it is missing or wrong."""
    table = read_table(path, BALANCE)
    try:
        return _balance(table)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise DataError(f"{path}: a part is missing or wrong ({error}), want a file of `rotor balance`") from error


def _balance(table: Table) -> Balance:
    dof = infinite(table["dof"])
    predicted, determinacy, grade = table["prediction"], table["determinacy"], table["grade"]
    return Balance(
        planes=tuple(table["planes"]),
        radii={plane: float(radius) for plane, radius in table["radii"].items()},
        conditions=tuple(table["conditions"]),
        dof=dof,
        compensated=bool(table["slow_roll_subtracted"]),
        corrections=tuple(_correction(each) for each in table["corrections"]),
        disagreement=number(table["disagreement"]),
        chosen=_correction(table["chosen"]),
        determinacy=Determinacy(
            condition=infinite(determinacy["condition"]),
            best=_combination(determinacy["best"]),
            worst=_combination(determinacy["worst"]),
            alike=bool(determinacy["nearly_alike"]),
            needed=bool(determinacy["worst_is_needed"]),
        ),
        left_out=bool(determinacy["left_out"]),
        min_max=_masses(table["min_max"]) if table["min_max"] else None,
        placing=_placing(table["holes"]) if table["holes"] else None,
        mounted=_masses(table["mounted"]),
        by=str(predicted["by"]),
        prediction=_prediction(predicted, dof),
        grade=Grade(
            unbalance=float(grade["residual"]),
            mass=float(grade["rotor_mass"]),
            top_speed=float(grade["top_speed"]),
        ),
        comparison=_comparison(table["after"], dof) if "after" in table else None,
        source=Provenance(**table["source"]),
    )


def _correction(table: Table) -> Correction:
    return Correction(
        by=str(table["by"]),
        planes=tuple(each["plane"] for each in table["planes"]),
        W=_masses(table["planes"]),
        covariance=np.array(table["covariance"], dtype=float),
        dof=infinite(table["dof"]),
    )


def _combination(table: Table) -> Combination:
    return Combination(
        weights=np.array([cmath.rect(each["weight"], each["angle"]) for each in table["weights"]]),
        amount=cmath.rect(table["amount"], table["angle"]),
        sigma=float(table["sigma"]),
        effect=float(table["effect"]),
    )


def _masses(tables: Sequence[Table]) -> NDArray[np.complex128]:
    """Return masses (plane,) [kg m]."""
    return np.array([cmath.rect(each["amount"], each["angle"]) for each in tables], dtype=complex)


def _placing(tables: Sequence[Table]) -> Placing:
    return Placing(
        holes=tuple(
            Holes(
                count=int(each["count"]),
                masses=tuple(each["masses"]),
                radius=float(each["radius"]),
                first=float(each["first"]),
                most=int(each["most"]),
            )
            for each in tables
        ),
        filled=tuple(tuple((int(f["hole"]), float(f["mass"])) for f in each["filled"]) for each in tables),
        W=_masses(tables),
    )


def _prediction(table: Table, dof: float) -> Prediction:
    probes = tuple(dict.fromkeys(table["probe"]))
    return Prediction(
        probes=probes,
        probe=np.array([probes.index(name) for name in table["probe"]], dtype=np.intp),
        omega=numbers_in(table["omega"]),
        direction=np.array(table["direction"], dtype=np.intp),
        before=complex_in(table["before"]),
        after=complex_in(table["after"]),
        covariance=numbers_in(table["covariance"]),
        dof=dof,
    )


def _comparison(table: Table, dof: float) -> Comparison:
    return Comparison(
        prediction=_prediction(table, dof),
        measured=complex_in(table["measured"]),
        distance=numbers_in(table["distance"]),
    )
