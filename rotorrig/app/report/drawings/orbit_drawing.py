"""Orbits as small SVG pictures, a row per plane, a picture per speed, each with its own scale."""

import math
from html import escape

import numpy as np
from numpy.typing import NDArray

from rotorrig.app.plot_data import nice, orbit, representative_rows, sweeps, vectors
from rotorrig.processing import OrderTrackedResponse, Plane, planes
from rotorrig.rig.config import RPM, UM

SIDE = 100.0  # half the picture's width, in drawing units
FILL = 0.84  # of it that the largest excursion takes
NOISY = 6.0  # sigma: below this, the direction of whirl is not significant
ARROW = 0.08  # of a turn after the keyphasor dot: where the arrow of travel sits


def orbit_pictures(response: OrderTrackedResponse) -> list[tuple[Plane, list[str]]]:
    """Return per probe plane the `<figure>`s of its 1X orbit at a few speeds of the first sweep; [] without a plane."""
    if not sweeps(response):
        return []
    run = sweeps(response)[0]
    pictures = []
    for plane in planes(response.rig):
        if not set(plane.probes) <= set(response.probes):
            continue
        columns = [response.probes.index(name) for name in plane.probes]
        z = vectors(response)[:, columns]
        rows = representative_rows(response, z, run=run)
        pictures.append((plane, [_picture(response, row, orbit(plane, z[row]) * UM, columns) for row in rows]))
    return pictures


def _picture(response: OrderTrackedResponse, row: int, xy: NDArray[np.float64], columns: list[int]) -> str:
    """Return one orbit [µm] as a figure; dot at the keyphasor edge, arrow in the direction of travel."""
    rpm = float(response.omega[row] * RPM)
    reach = float(np.abs(xy).max())
    variance = response.covariance[row, response.orders.index(1.0)].diagonal()[[2 * c for c in columns]]
    way = whirl(xy) if reach > NOISY * UM * float(np.sqrt(variance.max())) else "near the noise"
    scale = nice(reach)
    points = xy * (SIDE * FILL / scale) * (1, -1)  # the SVG's y points down
    path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + "Z"
    at = max(1, round(ARROW * (len(points) - 1)))
    (x0, y0), (x1, y1) = points[at - 1], points[at]
    heading = math.degrees(math.atan2(y1 - y0, x1 - x0))
    words = f"1X orbit at {rpm:.0f} rpm, largest excursion {reach:.3g} µm, {way}"
    box, frame = f"{-SIDE} {-SIDE} {2 * SIDE} {2 * SIDE}", SIDE * FILL
    return (
        f'<figure class="orbit"><svg viewBox="{box}" role="img" aria-label="{escape(words)}">'
        f'<line class="axis" x1="{-SIDE}" x2="{SIDE}"/><line class="axis" y1="{-SIDE}" y2="{SIDE}"/>'
        f'<rect class="frame" x="{-frame}" y="{-frame}" width="{2 * frame}" height="{2 * frame}"/>'
        f'<path class="path" d="{path}"/>'
        f'<path class="travel" transform="translate({x1:.1f} {y1:.1f}) rotate({heading:.1f})" d="M-7 -6 7 0 -7 6z"/>'
        f'<circle class="keyphasor" cx="{points[0][0]:.1f}" cy="{points[0][1]:.1f}" r="6"/></svg>'
        f"<figcaption><strong>{rpm:.0f} rpm</strong><br>frame ±{scale:g} µm<br>{way}</figcaption></figure>"
    )


def whirl(xy: NDArray[np.float64]) -> str:
    """Return the direction of whirl of a closed orbit (point, 2).

    >>> whirl(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]]))
    'whirls x to y'
    """
    x, y = xy[:-1].T
    area = float(np.sum(x * np.diff(xy[:, 1]) - y * np.diff(xy[:, 0]))) / 2
    if abs(area) < 1e-3 * float(np.ptp(xy, axis=0).max()) ** 2:
        return "a straight line"
    return "whirls x to y" if area > 0 else "whirls y to x"
