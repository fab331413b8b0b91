"""The chapter's rig, and one whose answers stand in textbooks."""

from pathlib import Path

import pytest

from rotorrig.rig.config.description import RigConfig, load, parse

CONFIGS = Path(__file__).parents[3] / "configs"


@pytest.fixture(scope="session")
def rk4() -> RigConfig:
    return load(CONFIGS / "rk4.toml")


@pytest.fixture(scope="session")
def jeffcott() -> RigConfig:
    """Return a disk on a nearly massless shaft in rigid bearings 400 mm apart, a damper at the disk.

    E I = 200e9 * pi / 64 * 0.01^4 = 98.17 N m^2; k = 48 E I / L^3 = 73.63 kN/m; m = 1 kg: critical at 271.3 rad/s.
    """
    return parse(
        """
        name = "Jeffcott"
        shaft = { length = "400 mm", diameter = "10 mm", density = "1 kg/m^3", youngs_modulus = "200 GPa" }
        gravity = "none"

        [[disks]]
        name = "disk"
        position = "200 mm"
        mass = "1 kg"
        polar_inertia = "2e-4 kg m^2"
        transverse_inertia = "1e-4 kg m^2"
        unbalance = { amount = "20 g mm", angle = "0 deg" }

        [[bearings]]
        name = "left"
        position = "0 mm"
        kxx = "1e11 N/m"
        kyy = "1e11 N/m"

        [[bearings]]
        name = "right"
        position = "400 mm"
        kxx = "1e11 N/m"
        kyy = "1e11 N/m"

        [[bearings]]
        name = "damper"
        position = "200 mm"
        kxx = "0 N/m"
        kyy = "0 N/m"
        cxx = "27.13 N s/m" # damping ratio 5 %
        cyy = "27.13 N s/m"

        [[probes]]
        name = "x"
        position = "200 mm"
        angle = "0 deg"
        channel = 0

        [[probes]]
        name = "y"
        position = "200 mm"
        angle = "90 deg"
        channel = 1

        [keyphasor]
        channel = 3
        """,
        where="Jeffcott",
    )
