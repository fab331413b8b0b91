"""Order tracking: method, window, runs, keyphasor, slow roll, masked rows and remarks."""

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import lag_degrees
from rotorrig.app.report.html import Section, items, pairs, paragraph, section, table
from rotorrig.app.text import quantity_with_sigma
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM, UM

LISTED = 12  # reasons, remarks
METHODS = {
    "resampling": "resampling at equal steps of shaft angle, then windowed DFT",
    "least-squares": "joint least-squares fit of all orders over shaft angle",
    "vold-kalman": "Vold-Kalman filter",
    "unknown": "not stated by the response file",
}
WINDOWS = {
    "blackman": "Blackman",
    "hann": "Hann",
    "rectangular": "rectangular",
    "vold-kalman": "the filter's own",
}


def tracking_section(response: OrderTrackedResponse) -> Section:
    """Return the section on order tracking and data quality."""
    return section(
        "tracking",
        "Order tracking",
        pairs("Method and window", _facts(response)),
        _runs(response),
        _slow_roll(response),
        _count_by_kind("Masked rows, by reason", "reason", response, response.reasons),
        _count_by_kind("Remarks on usable rows", "remark", response, [_kinds(row) for row in response.remarks]),
    )


def _facts(response: OrderTrackedResponse) -> dict[str, str]:
    facts = {
        "method": METHODS.get(response.method, response.method),
        "window": f"{WINDOWS.get(response.window, response.window)}, over {_turns(response.revolutions)} per vector",
        "orders": ", ".join("0X (gap)" if not order else f"{order:g}X" for order in response.orders),
        "vectors": f"{len(response.omega)} rows, {1 - response.usable.mean():.1%} of their vectors masked",
    }
    if len(response.keyphasor_t) > 1:
        facts["keyphasor pulses"] = str(len(response.keyphasor_t))
    if np.isfinite(response.jitter).any():
        facts["keyphasor jitter, 1 σ of an edge"] = _jitter(response)
    if np.isfinite(response.omega_sigma).any():
        facts["uncertainty of a row's speed, median"] = f"{np.nanmedian(response.omega_sigma) * RPM:.2g} rpm"
    return facts


def _turns(revolutions: NDArray[np.float64]) -> str:
    """Return the length of a row's window: "8 turns", "4 to 12 turns".

    >>> _turns(np.array([8.0, 8.0, np.nan])), _turns(np.array([4.0, 12.0])), _turns(np.array([np.nan]))
    ('8 turns', '4 to 12 turns', 'unknown length')
    """
    known = revolutions[np.isfinite(revolutions)]
    if not known.size:
        return "unknown length"
    low, high = float(known.min()), float(known.max())
    return f"{low:g} turns" if math.isclose(low, high) else f"{low:.3g} to {high:.3g} turns"


def _jitter(response: OrderTrackedResponse) -> str:
    """Return the median jitter as time and as shaft angle."""
    angle = np.nanmedian(np.degrees(response.jitter * response.omega))
    return f"median {np.nanmedian(response.jitter) * 1e6:.2g} µs ({angle:.2g}° of shaft angle)"


def _runs(response: OrderTrackedResponse) -> str:
    rows = []
    for i, run in enumerate(response.runs):
        mine = response.run == i
        if not mine.any():
            continue
        rpm, rate = response.omega[mine] * RPM, response.alpha[mine] * RPM
        known = np.isfinite(rate).any()
        trial = ", ".join(
            f"{abs(u) * UM:.3g} g mm at {math.degrees(np.angle(u)) % 360:.0f}° on {disk}"
            for disk, u in run.trial_unbalance.items()
        )
        cells = [str(int(mine.sum())), f"{rpm.min():.0f} to {rpm.max():.0f}"]
        cells += [f"{np.nanmedian(rate):+.3g}" if known else "–", _turns(response.revolutions[mine])]
        rows.append([run.name, *cells, f"{response.usable[mine].mean():.1%}", trial or "none"])
    header = ["run", "rows", "rpm", "rate, rpm/s, median", "window", "usable", "trial mass"]
    return table("Runs", header, rows)


def _slow_roll(response: OrderTrackedResponse) -> str:
    """Return the slow-roll vectors and the doubts about them."""
    orders = [n for n, order in enumerate(response.orders) if order and np.isfinite(response.slow_roll[:, n]).any()]
    if not orders and np.isfinite(response.compensation_omega):
        rpm = response.compensation_omega * RPM
        return paragraph(f"Every vector lacks that of a slow roll at {rpm:.0f} rpm, which the table does not tell.")
    if not orders:
        return paragraph("No slow roll: every vector includes runout and bow.")
    sigma = np.sqrt(np.maximum(np.diagonal(response.slow_roll_covariance, axis1=1, axis2=2), 0.0))  # (order, 2 probe)
    rows = [
        [name, *(_vector(response.slow_roll[p, n], float(sigma[n, 2 * p])) for n in orders)]
        for p, name in enumerate(response.probes)
    ]
    caption = f"Slow roll at {response.slow_roll_omega * RPM:.0f} rpm, 0-peak ± 1 σ and phase lag"
    kept = response.slow_roll_waveform.shape[-1]
    notes = ["Stored vectors are raw; the slow roll is subtracted only where stated."]
    notes += [f"Its waveform is stored too, {kept} points per turn."] if kept else []
    against = [*response.slow_roll_remarks]
    warning = paragraph("The slow roll is doubtful:", kind="warning") + items(against) if against else ""
    return table(caption, ["probe", *(f"{response.orders[n]:g}X" for n in orders)], rows) + warning + paragraph(*notes)


def _vector(z: complex, sigma: float) -> str:
    if not np.isfinite(z):
        return "–"
    return f"{quantity_with_sigma(abs(z), sigma, 'm')} at {lag_degrees(np.array([z]))[0]:.0f}°"


def _kinds(remarks: Iterable[str]) -> list[str]:
    """Return the distinct kinds of remarks: the text before the colon.

    >>> _kinds(["line interference: 50 Hz, 2.1 um", "line interference: 50 Hz, 2.2 um", "missed pulse"])
    ['line interference', 'missed pulse']
    """
    return list(dict.fromkeys(remark.partition(": ")[0] for remark in remarks))


def _count_by_kind(caption: str, kind: str, response: OrderTrackedResponse, words: Sequence[Iterable[str]]) -> str:
    """Return a table of reasons or remarks, most frequent first, with their speed ranges."""
    rows_of: defaultdict[str, list[int]] = defaultdict(list)
    for row, kinds in enumerate(words):
        for word in kinds:
            rows_of[word].append(row)
    if not rows_of:
        return ""
    often = sorted(rows_of.items(), key=lambda item: (-len(item[1]), item[0]))
    rows = []
    for word, where in often[:LISTED]:
        rpm = response.omega[where] * RPM
        rows.append([word, str(len(where)), f"{np.nanmin(rpm):.0f} to {np.nanmax(rpm):.0f}"])
    more = paragraph(f"{len(often) - LISTED} more are in the response file.") if len(often) > LISTED else ""
    return table(caption, [kind, "rows", "rpm"], rows) + more
