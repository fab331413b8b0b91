"""Responses as labelled arrays and tables: xarray, pandas, Parquet, MATLAB."""

from pathlib import Path
from typing import Any, cast

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray
from scipy.io import savemat

from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig import write_whole_file
from rotorrig.rig.config import RPM, UM

PHASE = "x = Re(z exp(j n theta)), theta = 0 at the keyphasor edge; phase lag = -arg z; 0-peak"


def dataset(response: OrderTrackedResponse) -> xr.Dataset:
    """Return the response as (speed, probe, order), SI; units as the CF conventions write them."""
    rows, probe_order = ("speed",), ("probe", "order")
    sigma = vector_sigma(response)
    slow = np.sqrt(np.diagonal(response.slow_roll_covariance, axis1=1, axis2=2)[:, ::2]).T
    length = {"units": "m", "comment": PHASE}
    runs = np.array([run.name for run in response.runs])
    rises = np.array([run.direction for run in response.runs])
    return xr.Dataset(
        {
            "displacement": (
                ("speed", "probe", "order"),
                response.z,
                {**length, "long_name": "order vector, raw; of order 0 the gap"},
            ),
            "sigma": (("speed", "probe", "order"), sigma, {"units": "m", "long_name": "1 sigma of re and of im"}),
            "slow_roll": (probe_order, response.slow_roll, {**length, "long_name": "slow-roll vector"}),
            "slow_roll_sigma": (probe_order, slow, {"units": "m", "long_name": "1 sigma of re and of im"}),
            "usable": (("speed", "probe"), response.usable, {"long_name": "row may be used"}),
        },
        coords={
            "speed": (rows, response.omega, {"units": "rad s-1", "long_name": "shaft speed"}),
            "rpm": (rows, response.omega * RPM, {"units": "rpm", "long_name": "shaft speed"}),
            "time": (rows, response.t, {"units": "s", "long_name": "middle of the row's window"}),
            "acceleration": (rows, response.alpha, {"units": "rad s-2", "long_name": "shaft acceleration"}),
            "run": (rows, runs[response.run], {"long_name": "run"}),
            "direction": (rows, rises[response.run], {"long_name": "+1 speed rises, -1 falls, 0 dwell"}),
            "probe": ("probe", list(response.probes)),
            "order": ("order", list(response.orders), {"units": "1", "long_name": "multiple of shaft speed"}),
        },
        attrs={
            "title": f"Order-tracked response of {response.rig.name}",
            "rotation": response.rig.rotation,
            "slow_roll_speed_rpm": response.slow_roll_omega * RPM,
            "source": response.source.source,
            "source_hash": response.source.source_hash,
            "config_hash": response.source.config_hash,
            "history": f"rotorrig {response.source.code_version}",
        },
    )


def vector_sigma(response: OrderTrackedResponse) -> NDArray[np.float64]:
    """Return one standard deviation of the real part of every vector, (speed, probe, order) [m]."""
    variance = np.diagonal(response.covariance, axis1=2, axis2=3)[:, :, ::2]
    return np.sqrt(variance).transpose(0, 2, 1)


def frame(response: OrderTrackedResponse, *, compensated: bool) -> pd.DataFrame:
    """Return a row for each speed, probe and order; of order 0, the gap, `real_um` alone has a meaning."""
    z = response.z - response.slow_roll if compensated else response.z
    rows, probes, orders = z.shape
    run = np.array([run.name for run in response.runs])[response.run]
    reasons = np.array(["; ".join(words) for words in response.reasons])
    whole = {"run": run, "time_s": response.t, "speed_rpm": response.omega * RPM}
    whole |= {"acceleration_rpm_per_s": response.alpha * RPM, "turns": response.revolutions}
    flat = z.reshape(-1)
    return pd.DataFrame(
        {name: np.repeat(values, probes * orders) for name, values in whole.items()}
        | {
            "probe": np.tile(np.repeat(response.probes, orders), rows),
            "order": np.tile(response.orders, rows * probes),
            "amplitude_um": np.abs(flat) * UM,
            "phase_lag_deg": np.mod(-np.degrees(np.angle(flat)), 360.0),
            "real_um": flat.real * UM,
            "imag_um": flat.imag * UM,
            "sigma_um": vector_sigma(response).reshape(-1) * UM,
            "usable": np.repeat(response.usable.reshape(-1), orders),
            "reasons": np.repeat(reasons, probes * orders),
        }
    )


def write_parquet(path: Path, table: pd.DataFrame) -> Path:
    """Write a table whole. Raises DataError if that fails."""
    with write_whole_file(path) as file:
        table.to_parquet(file, index=False)
    return path


def write_mat(path: Path, response: OrderTrackedResponse) -> Path:
    """Write the arrays of a response, SI, as a MATLAB 5 file. Raises DataError if that fails."""
    names = np.array([*response.probes], dtype=object)
    arrays = {
        "z": response.z,
        "slow_roll": response.slow_roll,
        "sigma": vector_sigma(response),
        "omega": response.omega[:, None],
        "rpm": response.omega[:, None] * RPM,
        "alpha": response.alpha[:, None],
        "t": response.t[:, None],
        "usable": response.usable,
        "run": response.run[:, None] + 1,  # MATLAB counts from 1
        "runs": np.array([run.name for run in response.runs], dtype=object)[:, None],
        "probes": names[:, None],
        "orders": np.array(response.orders)[None],
        "rig": response.rig.name,
        "conventions": f"z (speed, probe, order) m, raw; {PHASE}",
    }
    with write_whole_file(path) as file:
        savemat(cast(Any, file), arrays)  # it takes an open file, whatever its types say
    return path
