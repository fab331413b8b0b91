"""Full spectra and +-nX vectors of orbits drawn by hand: circles and ellipses, forward and backward."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rotorrig.acquisition.recording import RawRecording
from rotorrig.processing.pipeline import track
from rotorrig.processing.probe_planes import planes
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.processing.tracking.full_spectrum import full_spectrum, whirl_vectors
from rotorrig.rig.config.description import RigConfig
from tests.processing.synthetic import chirp
from tests.processing.test_probe_planes import rig_with

RPM = np.pi / 30
RATE = 5_000.0
CIRCLES = {1.0: 20e-6, -1.0: 5e-6, 2.0: 4e-6, -2.0: 1e-6, 0.5: 3e-6}  # radius of what turns at that order


def orbit(theta: np.ndarray) -> np.ndarray:
    """Return x + jy of circles that start at angles of their own."""
    return sum(radius * np.exp(1j * (order * theta + 0.4 * order)) for order, radius in CIRCLES.items())


@pytest.fixture(scope="module")
def recording(record: Callable[..., RawRecording]) -> RawRecording:
    """An orbit at either plane, that of the second twice as large, on a rise from 600 to 1200 rpm."""
    t = np.arange(int(20 * RATE)) / RATE
    theta = chirp(t, start=600 * RPM, rate=30 * RPM, theta_0=-0.3)
    w = orbit(theta)
    x = np.stack([w.real, w.imag, 2 * w.real, 2 * w.imag], axis=1)
    x = x + 1e-8 * np.random.default_rng(3).standard_normal(x.shape)
    return record(theta, x, rate=RATE, marks=[(0.0, "up")])


@pytest.fixture(scope="module")
def response(recording: RawRecording) -> OrderTrackedResponse:
    return track(recording)


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0])
def test_vectors_forward_and_backward_are_the_circles_of_the_orbit(
    response: OrderTrackedResponse, order: float
) -> None:
    first, second = whirl_vectors(response, order=order)
    assert (first.plane.probes, second.plane.probes) == (("1x", "1y"), ("2x", "2y"))
    np.testing.assert_allclose(first.forward, CIRCLES[order] * np.exp(0.4j * order), atol=5e-9)
    backward = CIRCLES.get(-order, 0.0) * np.exp(0.4j * order)  # b* e^{-jn theta} = r e^{-j(n theta + 0.4 n)}
    np.testing.assert_allclose(first.backward, backward, atol=5e-9)
    np.testing.assert_allclose(second.forward, 2 * first.forward, atol=1e-8)
    assert first.usable.all()


@pytest.mark.parametrize("angles", [(0.0, 90.0), (20.0, 80.0)])
def test_their_covariance_is_that_of_many_draws(
    response: OrderTrackedResponse, rk4: RigConfig, rng: np.random.Generator, angles: tuple[float, float]
) -> None:
    rig = rig_with(rk4, angles, "x-to-y")
    root = rng.standard_normal((4, 4)) * 1e-7
    covariance = np.tile(root @ root.T, (len(response.t), len(response.orders), 1, 1))
    z, usable = response.z[:, :2], response.usable[:, :2]
    two = replace(response, rig=rig, probes=("1x", "1y"), z=z, usable=usable, covariance=covariance)
    draws = rng.standard_normal((200_000, 4)) @ root.T
    z = draws[:, 0::2] + 1j * draws[:, 1::2]
    one = replace(two, z=np.repeat(z[:, :, None], len(two.orders), axis=2), usable=np.ones(z.shape, dtype=bool))
    one = replace(one, covariance=np.tile(covariance[:1], (len(z), 1, 1, 1)))
    (drawn,), (told,) = whirl_vectors(one), whirl_vectors(two)
    pairs = np.stack([drawn.forward.real, drawn.forward.imag, drawn.backward.real, drawn.backward.imag])
    np.testing.assert_allclose(told.covariance[0], np.cov(pairs), atol=0.02 * np.abs(told.covariance[0]).max())
    np.testing.assert_allclose(told.sigma[0, 0] ** 2, (pairs[0].var() + pairs[1].var()) / 2, rtol=0.02)


def test_compensated_vectors_are_less_the_slow_roll(response: OrderTrackedResponse) -> None:
    slow = response.slow_roll.copy()
    slow[:, response.orders.index(1.0)] = (3e-6, -3e-6j, 0, 0)  # a circle of 3 um, forward
    (first, second) = whirl_vectors(replace(response, slow_roll=slow), compensated=True)
    np.testing.assert_allclose(first.forward, 20e-6 * np.exp(0.4j) - 3e-6, atol=5e-9)
    np.testing.assert_allclose(first.backward, 5e-6 * np.exp(0.4j), atol=5e-9)
    np.testing.assert_allclose(np.abs(second.forward), 40e-6, atol=1e-8)


def test_every_circle_stands_at_its_order(rk4: RigConfig) -> None:
    w = orbit(2 * np.pi * np.arange(8 * 16) / 16)
    read = np.stack([w.real, w.imag], axis=1)
    plane = planes(rig_with(rk4, (0.0, 90.0), "x-to-y"))[0]
    found, amplitude = full_spectrum(read, plane=plane, rotation="x-to-y", turns=8)
    assert found[0] == -4 and found[-1] == 4 and len(found) == 65
    for order, radius in CIRCLES.items():
        assert amplitude[found == order] == pytest.approx(radius)
    near = np.min(np.abs(found[:, None] - [0, *CIRCLES]), axis=1) <= 1 / 8
    assert amplitude[~near].max() < 1e-12


@pytest.mark.parametrize(("rotation", "way"), [("x-to-y", 1), ("y-to-x", -1)])
@pytest.mark.parametrize("angles", [(0.0, 90.0), (45.0, 135.0), (20.0, 80.0)])
def test_forward_is_positive_whichever_way_the_rotor_turns(
    rk4: RigConfig, rotation: str, way: int, angles: tuple[float, float]
) -> None:
    rig = rig_with(rk4, angles, rotation)
    theta = 2 * np.pi * np.arange(8 * 32) / 32
    x, y = 3 * np.cos(theta + 0.2) + 100.0, way * np.sin(theta + 0.2) - 40.0  # an ellipse: (3 + 1) / 2 and (3 - 1) / 2
    read = np.stack([x * np.cos(p.angle) + y * np.sin(p.angle) for p in rig.probes], axis=1)
    order, amplitude = full_spectrum(read, plane=planes(rig)[0], rotation=rotation, turns=8, highest=2.0)
    assert amplitude[order == 1.0] == pytest.approx(2.0)
    assert amplitude[order == -1.0] == pytest.approx(1.0)
