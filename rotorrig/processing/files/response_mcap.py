"""Response file `response.mcap`: an `OrderTrackedResponse`, exact for this program and readable for every other.

Topics `/response` and `/response/array` restore it bit by bit. The others hold the same as plain numbers with their
unit in the name (response_topics.py) and as a scene with a log (response_scene.py), which Rerun, Foxglove and the
official `mcap` reader show. See docs/response-file.md.
"""

import json
import math
from itertools import chain
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.files import Contents, FileKind, FileWriter, message_type, read_file
from rotorrig.processing.files import response_scene, response_topics
from rotorrig.processing.response import MainsHum, Method, OrderTrackedResponse, Run, Window
from rotorrig.rig import DataError

KIND = FileKind(name="response", version=1, remedy="make it anew with `rotor track`")
PIECE = 8 * 2**20  # bytes of an array in one message
LARGEST = 1e30  # of any unit: beyond it squares overflow

TABLE = message_type(
    "Response",
    {
        "probes": "repeated string",
        "orders": "repeated double",
        "window": "string",
        "slow_roll_omega_rad_s": "double",
        "runs_json": "string",  # [{name, direction, trial_unbalance: {disk: [re, im] kg m}}]
        "reasons_json": "string",  # [[...], ...] per row
        "method": "string",  # and what follows: empty in files of before they were known
        "remarks_json": "string",  # [[...], ...] per row, or []
        "slow_roll_remarks": "repeated string",
        "compensation_omega_rad_s": "double",  # 0: the vectors are raw
        "derived_times": "bool",
        "mains_json": "string",  # [{frequency_hz, t_s: [...], stray_rad: [...], sigma_rad: [...], shares: [[re, im]]}]
        "amplitudes_alone": "bool",  # the vectors' phases are not known, their imaginary parts 0
    },
)
ARRAY = message_type(
    "ResponseArray",
    {"name": "string", "dtype": "string", "shape": "repeated int64", "offset": "int64", "data": "bytes"},
)
#: arrays of the response and their type in the file, little endian
ARRAYS: dict[str, str] = {
    "run": "<i8",
    "t": "<f8",
    "omega": "<f8",
    "alpha": "<f8",
    "revolutions": "<f8",
    "z": "<c16",
    "covariance": "<f8",
    "slow_roll": "<c16",
    "slow_roll_covariance": "<f8",
    "usable": "|b1",
    "keyphasor_t": "<f8",
    "omega_sigma": "<f8",
    "alpha_sigma": "<f8",
    "jitter": "<f8",
    "slow_roll_waveform": "<f8",
}
LATER = ("omega_sigma", "alpha_sigma", "jitter", "slow_roll_waveform")  # not in older files: unknown
CONVENTION = {
    "amplitude": "0-peak",
    "vector": "z = 2 mean(x exp(-j theta)), x = Re(z exp(j theta)), theta = 0 at the keyphasor edge",
    "phase_lag": "-arg z",
    "displacement": "towards the probe",
    "axes": "speed, probe, order",
    "time": "middle of the row on the recording's clock; one second per row where the response has no times",
}


def write_response(path: Path, response: OrderTrackedResponse) -> None:
    """Write `response` to `path`. Raises DataError if it cannot be written."""
    with FileWriter(path, kind=KIND, rig=response.rig, source=response.source) as file:
        file.add_metadata("convention", CONVENTION)
        file.write("/response", TABLE, 0, **_table(response))
        for name, dtype in ARRAYS.items():
            array = np.ascontiguousarray(getattr(response, name), dtype=dtype)
            data = array.tobytes()
            for offset in range(0, max(len(data), 1), PIECE):
                piece = {"shape": list(array.shape), "offset": offset, "data": data[offset : offset + PIECE]}
                file.write("/response/array", ARRAY, 0, name=name, dtype=dtype, **piece)
        for topic, kind, t_ns, values in chain(response_scene.messages(response), response_topics.messages(response)):
            file.write(topic, kind, t_ns, **values)


def read_response(path: Path) -> OrderTrackedResponse:
    """Return the response in `path`, as it was written. Raises DataError for any other file."""
    contents = read_file(path, kind=KIND, types=(TABLE, ARRAY))
    tables = [m.values for m in contents.messages if m.topic == "/response"]
    if len(tables) != 1:
        raise DataError(f"{path}: has {len(tables)} messages on /response, want one; {KIND.remedy}")
    table, arrays = tables[0], _arrays(path, contents)
    try:
        runs = tuple(_run(run) for run in json.loads(table.runs_json))
        reasons = _words(table.reasons_json)
        remarks = _words(table.remarks_json or "[]")
        mains = tuple(_mains(values) for values in json.loads(table.mains_json or "[]"))
    except (ValueError, TypeError, KeyError) as error:
        raise DataError(f"{path}: its runs, reasons or hum cannot be read ({error})") from error
    if table.window not in get_args(Window):
        raise DataError(f"{path}: has window {table.window[:40]!r}, want one of {', '.join(get_args(Window))}")
    method: Any = table.method or "unknown"
    if method not in get_args(Method):
        raise DataError(f"{path}: has method {method[:40]!r}, want one of {', '.join(get_args(Method))}")
    response = OrderTrackedResponse(
        rig=contents.rig,
        probes=tuple(table.probes),
        orders=tuple(table.orders),
        runs=runs,
        window=table.window,
        method=method,
        slow_roll_omega=table.slow_roll_omega_rad_s,
        slow_roll_remarks=tuple(table.slow_roll_remarks),
        compensation_omega=table.compensation_omega_rad_s or math.nan,
        derived_times=bool(table.derived_times),
        amplitudes_alone=bool(table.amplitudes_alone),
        mains=mains,
        reasons=reasons,
        remarks=remarks,
        source=contents.source,
        **arrays,
    )
    _check_shapes(path, response)
    _check_values(path, response)
    return response


def _table(response: OrderTrackedResponse) -> dict[str, Any]:
    runs = [
        {
            "name": run.name,
            "direction": run.direction,
            "trial_unbalance": {disk: [u.real, u.imag] for disk, u in run.trial_unbalance.items()},
        }
        for run in response.runs
    ]
    return {
        "probes": response.probes,
        "orders": response.orders,
        "window": response.window,
        "slow_roll_omega_rad_s": response.slow_roll_omega,
        "runs_json": json.dumps(runs),
        "reasons_json": json.dumps(response.reasons),
        "method": response.method,
        "remarks_json": json.dumps(response.remarks),
        "slow_roll_remarks": response.slow_roll_remarks,
        "compensation_omega_rad_s": float(np.nan_to_num(response.compensation_omega)),
        "derived_times": response.derived_times,
        "amplitudes_alone": response.amplitudes_alone,
        "mains_json": json.dumps(
            [
                {
                    "frequency_hz": m.frequency,
                    "t_s": list(m.t),
                    "stray_rad": list(m.stray),
                    "sigma_rad": list(m.sigma),
                    "shares": [[share.real, share.imag] for share in m.shares],
                }
                for m in response.mains
            ]
        ),
    }


def _words(text: str) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(str(word) for word in row) for row in json.loads(text))


def _mains(values: dict[str, Any]) -> MainsHum:
    t, stray, sigma = (np.array(values.get(key, []), dtype=float) for key in ("t_s", "stray_rad", "sigma_rad"))
    shares = np.array([complex(re, im) for re, im in values.get("shares", [])], dtype=complex)
    return MainsHum(frequency=float(values["frequency_hz"]), t=t, stray=stray, sigma=sigma, shares=shares)


def _run(values: dict[str, Any]) -> Run:
    trial = {str(disk): complex(re, im) for disk, (re, im) in values["trial_unbalance"].items()}
    return Run(name=str(values["name"]), direction=int(values["direction"]), trial_unbalance=trial)


def _arrays(path: Path, contents: Contents) -> dict[str, NDArray[Any]]:
    """Return the arrays put together from their pieces, each of the type and size the file says."""
    pieces: dict[str, list[Any]] = {}
    for message in contents.messages:
        if message.topic == "/response/array":
            pieces.setdefault(message.values.name, []).append(message.values)
    arrays: dict[str, NDArray[Any]] = {}
    for name, dtype in ARRAYS.items():
        mine = sorted(pieces.get(name, []), key=lambda piece: piece.offset)
        if not mine and name in LATER:
            arrays[name] = np.empty((0,) * (2 if name == "slow_roll_waveform" else 1))
            continue
        if not mine:
            raise DataError(f"{path}: lacks the array '{name}'; {KIND.remedy}")
        shape, data = tuple(mine[0].shape), b"".join(piece.data for piece in mine)
        if (
            mine[0].dtype != dtype
            or min(shape, default=0) < 0
            or math.prod(shape) * np.dtype(dtype).itemsize != len(data)
        ):
            raise DataError(
                f"{path}: array '{name}' has {len(data)} bytes of {mine[0].dtype or 'nothing'} for shape {shape}, "
                f"want {dtype}; {KIND.remedy}"
            )
        arrays[name] = np.frombuffer(data, dtype=dtype).reshape(shape).astype(np.dtype(dtype).newbyteorder("="))
    return arrays


def _check_shapes(path: Path, response: OrderTrackedResponse) -> None:
    if unknown := [name for name in response.probes if name not in {probe.name for probe in response.rig.probes}]:
        raise DataError(f"{path}: has a probe '{unknown[0]}' that its config does not know; {KIND.remedy}")
    rows, probes, orders = len(response.omega), len(response.probes), len(response.orders)
    want = {
        "run": (rows,),
        "t": (rows,),
        "alpha": (rows,),
        "revolutions": (rows,),
        "z": (rows, probes, orders),
        "covariance": (rows, orders, 2 * probes, 2 * probes),
        "slow_roll": (probes, orders),
        "slow_roll_covariance": (orders, 2 * probes, 2 * probes),
        "usable": (rows, probes),
    }
    for name, shape in want.items():
        if getattr(response, name).shape != shape:
            raise DataError(f"{path}: '{name}' has shape {getattr(response, name).shape}, want {shape}; {KIND.remedy}")
    for name in ("omega_sigma", "alpha_sigma", "jitter"):
        if getattr(response, name).shape not in ((0,), (rows,)):
            raise DataError(
                f"{path}: '{name}' has shape {getattr(response, name).shape}, want {(rows,)}; {KIND.remedy}"
            )
    waveform = response.slow_roll_waveform
    if waveform.ndim != 2 or (waveform.size and len(waveform) != probes):
        raise DataError(f"{path}: 'slow_roll_waveform' has shape {waveform.shape}, want {probes} rows; {KIND.remedy}")
    if (
        len(response.reasons) != rows
        or len(response.remarks) not in (0, rows)
        or (rows and not 0 <= response.run.min() <= response.run.max() < len(response.runs))
    ):
        raise DataError(f"{path}: its rows, reasons and runs do not belong together; {KIND.remedy}")


def _check_values(path: Path, response: OrderTrackedResponse) -> None:
    """Raise DataError for numbers that no measurement has; NaN and infinite ones stand for what is not known."""
    for name in ("omega", "alpha", "z", "covariance", "slow_roll", "slow_roll_covariance"):
        array = np.abs(getattr(response, name))
        if (array[np.isfinite(array)] > LARGEST).any():
            raise DataError(f"{path}: '{name}' has a number beyond {LARGEST:g}; {KIND.remedy}")
    for name in ("covariance", "slow_roll_covariance"):
        if (np.diagonal(getattr(response, name), axis1=-2, axis2=-1) < 0).any():
            raise DataError(f"{path}: '{name}' has a variance below zero; {KIND.remedy}")
