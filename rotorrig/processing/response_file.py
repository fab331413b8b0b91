"""`response.mcap`: an `OrderTrackedResponse` in a file, twice: exact for this program, readable for everyone else.

Topics `/response` and `/response/array` restore it bit by bit. Topics `/bode/<probe>/<order>` and `/gap/<probe>` hold
the same as plain numbers with their unit in the name, which Rerun, Foxglove and the official `mcap` reader show.
See docs/response-file.md.
"""

import json
import math
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.mcap_file import Contents, FileKind, FileWriter, read_file
from rotorrig.acquisition.schemas import message_type
from rotorrig.processing.response import OrderTrackedResponse, Run, Window
from rotorrig.rig.errors import DataError
from rotorrig.rig.units import RPM

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
    },
)
ARRAY = message_type(
    "ResponseArray",
    {"name": "string", "dtype": "string", "shape": "repeated int64", "offset": "int64", "data": "bytes"},
)
# Of a message, Rerun plots the first four doubles: the speed, thousands beside hundreds, stands behind them.
VECTOR = message_type(
    "OrderVector",
    {
        "speed_rpm": "int64",  # rounded, for a speed axis
        "amplitude_um": "double",  # 0-peak, raw
        "phase_lag_deg": "double",  # 0 to 360
        "compensated_amplitude_um": "double",  # slow-roll vector subtracted; NaN without one
        "compensated_phase_lag_deg": "double",
        "sigma_um": "double",  # 1 sigma of the real or imaginary part
        "exact_speed_rpm": "double",
        "run": "string",
        "usable": "bool",
        "reasons": "string",
    },
)
GAP = message_type(
    "Gap",
    {
        "speed_rpm": "int64",
        "gap_um": "double",  # mean position towards the probe, 0 at its gap voltage
        "sigma_um": "double",
        "exact_speed_rpm": "double",
        "run": "string",
        "usable": "bool",
        "reasons": "string",
    },
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
}
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
        file.metadata("convention", CONVENTION)
        file.write("/response", TABLE, 0, **_table(response))
        for name, dtype in ARRAYS.items():
            array = np.ascontiguousarray(getattr(response, name), dtype=dtype)
            data = array.tobytes()
            for offset in range(0, max(len(data), 1), PIECE):
                piece = {"shape": list(array.shape), "offset": offset, "data": data[offset : offset + PIECE]}
                file.write("/response/array", ARRAY, 0, name=name, dtype=dtype, **piece)
        for i, t_ns in enumerate(_times(response)):
            for topic, kind, values in _rows(response, i):
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
        reasons = tuple(tuple(str(word) for word in row) for row in json.loads(table.reasons_json))
    except (ValueError, TypeError, KeyError) as error:
        raise DataError(f"{path}: its runs or reasons cannot be read ({error})") from error
    if table.window not in get_args(Window):
        raise DataError(f"{path}: has window {table.window[:40]!r}, want one of {', '.join(get_args(Window))}")
    response = OrderTrackedResponse(
        rig=contents.rig,
        probes=tuple(table.probes),
        orders=tuple(table.orders),
        runs=runs,
        window=table.window,
        slow_roll_omega=table.slow_roll_omega_rad_s,
        reasons=reasons,
        source=contents.source,
        **arrays,
    )
    _check_shapes(path, response)
    _check_values(path, response)
    return response


def order_name(order: float) -> str:
    """Return the name of an order as vibration people write it.

    >>> [order_name(order) for order in (1.0, 0.5, 2.0)]
    ['1X', '0.5X', '2X']
    """
    return f"{order:g}X"


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
    }


def _run(values: dict[str, Any]) -> Run:
    trial = {str(disk): complex(re, im) for disk, (re, im) in values["trial_unbalance"].items()}
    return Run(name=str(values["name"]), direction=int(values["direction"]), trial_unbalance=trial)


def _times(response: OrderTrackedResponse) -> list[int]:
    t = response.t if np.isfinite(response.t).all() else np.arange(len(response.t), dtype=float)
    return [max(0, round(seconds * 1e9)) for seconds in t]


def _rows(response: OrderTrackedResponse, i: int) -> Iterator[tuple[str, Any, dict[str, Any]]]:
    """Yield topic, message type and fields of every probe and order of row `i`."""
    rpm = float(response.omega[i]) * RPM
    for (p, probe), (n, order) in product(enumerate(response.probes), enumerate(response.orders)):
        variance = response.covariance[i, n, 2 * p : 2 * p + 2, 2 * p : 2 * p + 2]
        common = {
            "speed_rpm": round(rpm),
            "exact_speed_rpm": rpm,
            "sigma_um": math.sqrt(np.trace(variance) / 2) * 1e6,
            "run": response.runs[response.run[i]].name,
            "usable": bool(response.usable[i, p]),
            "reasons": "; ".join(response.reasons[i]),
        }
        z = complex(response.z[i, p, n])
        if order == 0:
            yield f"/gap/{probe}", GAP, {**common, "gap_um": z.real * 1e6}
        else:
            amplitude, lag = _polar(z)
            compensated_amplitude, compensated_lag = _polar(z - complex(response.slow_roll[p, n]))
            yield (
                f"/bode/{probe}/{order_name(order)}",
                VECTOR,
                {
                    **common,
                    "amplitude_um": amplitude,
                    "phase_lag_deg": lag,
                    "compensated_amplitude_um": compensated_amplitude,
                    "compensated_phase_lag_deg": compensated_lag,
                },
            )


def _polar(z: complex) -> tuple[float, float]:
    """Return the amplitude [um] and phase lag [deg, 0 to 360] of z [m]."""
    return abs(z) * 1e6, math.degrees(-math.atan2(z.imag, z.real)) % 360.0


def _arrays(path: Path, contents: Contents) -> dict[str, NDArray[Any]]:
    """Return the arrays put together from their pieces, each of the type and size the file says."""
    pieces: dict[str, list[Any]] = {}
    for message in contents.messages:
        if message.topic == "/response/array":
            pieces.setdefault(message.values.name, []).append(message.values)
    arrays: dict[str, NDArray[Any]] = {}
    for name, dtype in ARRAYS.items():
        mine = sorted(pieces.get(name, []), key=lambda piece: piece.offset)
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
    if len(response.reasons) != rows or (
        rows and not 0 <= response.run.min() <= response.run.max() < len(response.runs)
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
