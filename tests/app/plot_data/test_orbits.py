"""Orbits do not depend on how the probes are turned."""

import numpy as np
import pytest

from rotorrig.app.plot_data.orbits import orbit
from rotorrig.processing.probe_planes import planes
from rotorrig.rig.config.description import RigConfig


def test_orbit_of_turned_probes_is_the_same_orbit(rig: RigConfig) -> None:
    turned = [p.model_copy(update={"angle": p.angle + np.pi / 4}) for p in rig.probes[:2]]
    plane = planes(rig.model_copy(update={"probes": tuple(turned)}))[0]
    x, y = 3.0, -2.0j  # an ellipse: x = 3 cos, y = 2 sin
    z = np.array([x * np.cos(p.angle) + y * np.sin(p.angle) for p in turned])
    xy = orbit(plane, z)
    theta = np.linspace(0, 2 * np.pi, len(xy))
    assert xy == pytest.approx(np.column_stack([3 * np.cos(theta), 2 * np.sin(theta)]))


def test_parallel_probes_make_no_plane(rig: RigConfig) -> None:
    parallel = tuple(p.model_copy(update={"angle": 0.0}) for p in rig.probes)
    assert planes(rig.model_copy(update={"probes": parallel})) == ()
