"""Write `balance.json`, a `Balance`, and `rotor predict`'s JSON, a `Prediction`. SI; amplitudes 0-peak."""

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.balancing.balance import Balance
from rotorrig.balancing.correction import Correction
from rotorrig.balancing.determinacy import Combination
from rotorrig.balancing.prediction import Comparison, Prediction
from rotorrig.identify.result_files import (
    BALANCE,
    PREDICTION,
    complex_out,
    finite,
    numbers_out,
    write_table,
)
from rotorrig.rig import Provenance

ANGLES = "angles from the keyphasor mark, in the sense of rotation"


def write_balance(path: Path, balance: Balance) -> None:
    """Write balance.json. Raises DataError if the file cannot be written."""
    arrays = {"prediction": _prediction_out(balance.prediction, by=balance.by)}
    if balance.comparison:
        compared = _prediction_out(balance.comparison.prediction, by=balance.by)
        measured = complex_out(balance.comparison.measured)
        arrays["after"] = {**compared, "measured": measured, "distance": numbers_out(balance.comparison.distance)}
    write_table(path, BALANCE, {**balance_table(balance), **arrays}, balance.source)


def write_prediction(path: Path, prediction: Prediction, masses: dict[str, complex], source: Provenance) -> None:
    """Write a prediction as JSON. Raises DataError if the file cannot be written."""
    body = {
        "angles": ANGLES,
        "masses": [_mass(plane, u) for plane, u in masses.items()],
        "prediction": _prediction_out(prediction, by="fitted model"),
    }
    write_table(path, PREDICTION, body, source)


def balance_table(balance: Balance) -> dict[str, Any]:
    """Return what balance.json holds, less its arrays and its provenance."""
    determinacy = balance.determinacy
    table = {
        "angles": ANGLES,
        "planes": balance.planes,
        "radii": balance.radii,
        "conditions": balance.conditions,
        "dof": balance.dof,
        "slow_roll_subtracted": balance.compensated,
        "corrections": [_correction_out(c) for c in balance.corrections],
        "disagreement": balance.disagreement,
        "chosen": _correction_out(balance.chosen),
        "determinacy": {
            "condition": determinacy.condition,
            "nearly_alike": determinacy.alike,
            "worst_is_needed": determinacy.needed,
            "left_out": balance.left_out,
            "best": _combination_out(determinacy.best, balance.planes),
            "worst": _combination_out(determinacy.worst, balance.planes),
        },
        "min_max": None if balance.min_max is None else _masses(balance.planes, balance.min_max),
        "holes": None if balance.placing is None else _holes_out(balance),
        "mounted": _masses(balance.planes, balance.mounted),
        "grade": {
            "residual": balance.grade.unbalance,
            "rotor_mass": balance.grade.mass,
            "top_speed": balance.grade.top_speed,
            "product_mm_s": balance.grade.product,
            "grade": balance.grade.grade,
        },
        "comparison": _comparison_out(balance.comparison) if balance.comparison else None,
    }
    return {name: finite(value) for name, value in table.items()}


def _correction_out(correction: Correction) -> dict[str, Any]:
    return {
        "by": correction.by,
        "dof": correction.dof,
        "planes": [
            {**_mass(plane, w), "amount_half_width_95": amount, "angle_half_width_95": angle, "reach_95": float(reach)}
            for plane, w, (amount, angle), reach in zip(
                correction.planes, correction.W, correction.half_widths, correction.reach, strict=True
            )
        ],
        "covariance": correction.covariance.tolist(),
    }


def _combination_out(combination: Combination, planes: tuple[str, ...]) -> dict[str, Any]:
    return {
        "weights": [
            {"plane": plane, "weight": abs(w), "angle": float(np.angle(w))}
            for plane, w in zip(planes, combination.weights.tolist(), strict=True)
        ],
        "amount": abs(combination.amount),
        "angle": float(np.angle(combination.amount)),
        "sigma": combination.sigma,
        "effect": combination.effect,
    }


def _holes_out(balance: Balance) -> list[dict[str, Any]]:
    assert balance.placing
    placing = balance.placing
    return [
        {
            **_mass(plane, w),
            **asdict(holes),
            "filled": [{"hole": hole, "mass": mass} for hole, mass in filled],
        }
        for plane, holes, filled, w in zip(
            balance.planes, placing.holes, placing.filled, placing.W.tolist(), strict=True
        )
    ]


def _comparison_out(comparison: Comparison) -> dict[str, Any]:
    by_probe = {}
    for i, name in enumerate(comparison.prediction.probes):
        mine = comparison.prediction.probe == i
        if mine.any():
            by_probe[name] = {
                "inside": int(comparison.inside[mine].sum()),
                "of": int(mine.sum()),
                "largest_measured": float(np.abs(comparison.measured[mine]).max()),
                "furthest": float(comparison.distance[mine].max()),
            }
    return {"share_inside": comparison.share, "probes": by_probe}


def _masses(planes: tuple[str, ...], W: NDArray[np.complex128]) -> list[dict[str, Any]]:
    return [_mass(plane, w) for plane, w in zip(planes, W.tolist(), strict=True)]


def _mass(plane: str, w: complex) -> dict[str, Any]:
    return {"plane": plane, "amount": abs(w), "angle": float(np.angle(w)) % math.tau}


def _prediction_out(prediction: Prediction, *, by: str) -> dict[str, Any]:
    low, high = prediction.band
    return {
        "by": by,
        "probe": [prediction.probes[i] for i in prediction.probe],
        "direction": prediction.direction.tolist(),
        "omega": numbers_out(prediction.omega),
        "before": complex_out(prediction.before),
        "after": complex_out(prediction.after),
        "amplitude_low_95": numbers_out(low),
        "amplitude_high_95": numbers_out(high),
        "covariance": numbers_out(prediction.covariance),
    }
