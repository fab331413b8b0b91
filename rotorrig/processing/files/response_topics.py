"""Topics of `response.mcap` for viewers and other programs: a response as plain numbers, a topic for every plot.

`/bode/<probe>/<n>X`, `/gap/<probe>` and `/whirl/<probe>-<probe>/<n>X`, a message per row with the unit in every name.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rotorrig.acquisition.files import MessageType, message_type
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.tracking import WhirlVectors, whirl_vectors
from rotorrig.rig.config import RPM, UM

# Of a message, Rerun plots the first four doubles: the speed, thousands beside hundreds, stands behind them.
VECTOR = message_type(
    "OrderVector",
    {
        "speed_rpm": "int64",  # rounded, for a speed axis
        "amplitude_um": "double",  # 0-peak, raw
        "phase_lag_deg": "double",  # 0 to 360; NaN: not known
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
WHIRL = message_type(
    "WhirlVector",
    {
        "speed_rpm": "int64",
        "forward_um": "double",  # radius of the circle run through with the rotation, raw
        "backward_um": "double",  # of the one against it
        "compensated_forward_um": "double",  # slow-roll vectors subtracted; NaN without
        "compensated_backward_um": "double",
        "forward_phase_lag_deg": "double",  # raw, 0 to 360
        "backward_phase_lag_deg": "double",
        "forward_sigma_um": "double",  # 1 sigma of the real or imaginary part
        "backward_sigma_um": "double",
        "exact_speed_rpm": "double",
        "run": "string",
        "usable": "bool",
        "reasons": "string",
    },
)
Message = tuple[str, MessageType, int, Mapping[str, Any]]  # topic, type, log time [ns], fields


def messages(response: OrderTrackedResponse) -> Iterator[Message]:
    """Yield the messages to be plotted of a response, row by row."""
    whirl = _whirl(response)
    for i, t_ns in enumerate(row_times(response)):
        for topic, kind, values in (*_of_probes(response, i), *(each for pair in whirl for each in _of_pair(pair, i))):
            yield topic, kind, t_ns, {**_common(response, i), **values}


def row_times(response: OrderTrackedResponse) -> list[int]:
    """Return the middle of every row on the recording's clock [ns]; one second per row where that is not known."""
    t = response.t if np.isfinite(response.t).all() else np.arange(len(response.t), dtype=float)
    return [max(0, round(seconds * 1e9)) for seconds in t]


def order_name(order: float) -> str:
    """Return the name of an order as vibration people write it.

    >>> [order_name(order) for order in (1.0, 0.5, 2.0)]
    ['1X', '0.5X', '2X']
    """
    return f"{order:g}X"


def _common(response: OrderTrackedResponse, i: int) -> dict[str, Any]:
    rpm = float(response.omega[i]) * RPM
    return {
        "speed_rpm": round(rpm),
        "exact_speed_rpm": rpm,
        "run": response.runs[response.run[i]].name,
        "reasons": "; ".join(response.reasons[i]),
    }


def _of_probes(response: OrderTrackedResponse, i: int) -> Iterator[tuple[str, MessageType, dict[str, Any]]]:
    """Yield topic, message type and fields of every probe and order of row `i`."""
    for (p, probe), (n, order) in product(enumerate(response.probes), enumerate(response.orders)):
        variance = response.covariance[i, n, 2 * p : 2 * p + 2, 2 * p : 2 * p + 2]
        values = {"sigma_um": math.sqrt(np.trace(variance) / 2) * UM, "usable": bool(response.usable[i, p])}
        z = complex(response.z[i, p, n])
        if order == 0:
            yield f"/gap/{probe}", GAP, {**values, "gap_um": z.real * UM}
        else:
            left = z - complex(response.slow_roll[p, n])
            lag = math.nan if response.amplitudes_alone else _lag(z)
            values |= {"amplitude_um": abs(z) * UM, "phase_lag_deg": lag}
            values |= {"compensated_amplitude_um": abs(left) * UM, "compensated_phase_lag_deg": _lag(left)}
            yield f"/bode/{probe}/{order_name(order)}", VECTOR, values


Pair = tuple[WhirlVectors, NDArray[np.complex128], NDArray[np.complex128]]  # raw, compensated forward and backward


def _whirl(response: OrderTrackedResponse) -> list[Pair]:
    """Return +-nX of every plane and order above 0, and the same less the slow roll."""
    pairs: list[Pair] = []
    for order in response.orders:
        if order > 0:
            compensated = whirl_vectors(response, order=order, compensated=True)
            raw = whirl_vectors(response, order=order)
            pairs += [(r, c.forward, c.backward) for r, c in zip(raw, compensated, strict=True)]
    return pairs


def _of_pair(pair: Pair, i: int) -> Iterator[tuple[str, MessageType, dict[str, Any]]]:
    raw, forward, backward = pair
    sigma = raw.sigma[i] * UM
    yield (
        f"/whirl/{'-'.join(raw.plane.probes)}/{order_name(raw.order)}",
        WHIRL,
        {
            "forward_um": abs(raw.forward[i]) * UM,
            "backward_um": abs(raw.backward[i]) * UM,
            "compensated_forward_um": abs(forward[i]) * UM,
            "compensated_backward_um": abs(backward[i]) * UM,
            "forward_phase_lag_deg": _lag(complex(raw.forward[i])),
            "backward_phase_lag_deg": _lag(complex(raw.backward[i])),
            "forward_sigma_um": sigma[0],
            "backward_sigma_um": sigma[1],
            "usable": bool(raw.usable[i]),
        },
    )


def _lag(z: complex) -> float:
    """Return the phase lag of z [deg, 0 to 360]."""
    return math.degrees(-math.atan2(z.imag, z.real)) % 360.0
