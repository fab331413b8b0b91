"""The FE rotor against formulas: Jeffcott's rotor, the slender beam, an overhung disk with gyroscopic moment.

Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), ch. 3 and 6; Timoshenko, Vibration Problems.
"""

import math

import numpy as np
import pytest

from rotorrig.rig.description import RigConfig, from_si
from rotorrig.sims.rotor.assembly import assemble, with_bearing
from rotorrig.sims.rotor.harmonic import probe_response
from rotorrig.sims.rotor.modes import natural_frequencies, static_sag, whirl_modes


def rotor(*, shaft: dict, disk: dict, bearings: dict[float, float], probe: float) -> RigConfig:
    """Return a rig with one disk, isotropic bearings {position: stiffness} and an x and a y probe; SI."""
    return from_si(
        {
            "name": "closed form",
            "shaft": {"density": 1e-3, "youngs_modulus": 2e11, **shaft},
            "disks": [{"name": "disk", "mass": 1e-9, "polar_inertia": 1e-15, "transverse_inertia": 1e-15, **disk}],
            "bearings": [
                {"name": f"{i}", "position": z, "kxx": k, "kyy": k} for i, (z, k) in enumerate(bearings.items())
            ],
            "probes": [
                {"name": name, "position": probe, "angle": angle, "channel": i}
                for i, (name, angle) in enumerate([("x", 0.0), ("y", math.pi / 2)])
            ],
        }
    )


def test_a_stiff_light_shaft_on_springs_is_jeffcotts_rotor():
    m, kx, ky, c, U = 0.8, 3.4e4, 4.0e4, 15.0, 15e-6
    rig = rotor(
        shaft={"length": 0.4, "diameter": 0.08, "youngs_modulus": 2e14},  # 48 EI / L^3 is 1e7 times the springs
        disk={"position": 0.2, "mass": m, "polar_inertia": 5e-4, "transverse_inertia": 3e-4},
        bearings={0.0: 1.0, 0.4: 1.0},
        probe=0.2,
    )
    model = with_bearing(assemble(rig, max_element=0.2), ["0", "1"], np.diag([kx, ky]) / 2, np.eye(2) * c / 2)
    omega = np.linspace(50, 400, 60)
    got = probe_response(model, omega, unbalance={"disk": U * np.exp(0.4j)})
    force = omega**2 * U * np.exp(0.4j)
    m += 1e-3 * math.pi / 4 * 0.08**2 * 0.4  # the shaft rides along
    x = force / (kx - omega**2 * m + 1j * omega * c)
    y = -1j * force / (ky - omega**2 * m + 1j * omega * c)
    assert np.abs(got - np.column_stack([x, y])).max() < 5e-6 * np.abs(x).max()
    # far above the critical the heavy spot turns inwards: -U / m towards it, half a turn behind
    assert np.angle(-got[-1, 0] / np.exp(0.4j)) == pytest.approx(0, abs=0.1)


def test_below_resonance_the_shaft_moves_towards_the_heavy_spot():
    rig = rotor(
        shaft={"length": 0.4, "diameter": 0.01},
        disk={"position": 0.2, "mass": 0.8, "polar_inertia": 5e-4, "transverse_inertia": 3e-4},
        bearings={0.0: 1e7, 0.4: 1e7},
        probe=0.2,
    )
    x, y = probe_response(assemble(rig), 20.0, unbalance={"disk": 1e-5 * np.exp(0.7j)})[0]
    assert np.angle(x) == pytest.approx(0.7, abs=1e-6)
    assert y == pytest.approx(-1j * x, rel=1e-6)  # y follows x by a quarter of a turn: x towards y


@pytest.mark.parametrize("element", ["timoshenko", "lumped"])
def test_a_slender_pinned_shaft_has_eulers_and_bernoullis_frequencies(element):
    length, diameter, E, density = 2.0, 0.01, 2e11, 7800.0
    rig = rotor(
        shaft={"length": length, "diameter": diameter, "density": density, "youngs_modulus": E},
        disk={"position": 1.0},
        bearings={0.0: 1e9, length: 1e9},
        probe=1.0,
    )
    frequencies = natural_frequencies(assemble(rig, element=element), 0.0)
    for n in (1, 2, 3):
        want = (n * math.pi / length) ** 2 * math.sqrt(E * diameter**2 / (16 * density))
        # rotary inertia and shear take away (1 + E / kappa G) (n pi r / L)^2 / 2, 3e-5 n^2 of it at the most
        assert frequencies[2 * n - 2 : 2 * n] == pytest.approx(want, rel=4e-5 * n**2)


def test_a_pinned_shaft_sags_by_five_parts_in_384():
    length, diameter, E, density = 2.0, 0.02, 2e11, 7800.0
    rig = rotor(
        shaft={"length": length, "diameter": diameter, "density": density, "youngs_modulus": E},
        disk={"position": 1.0},
        bearings={0.0: 1e9, length: 1e9},
        probe=1.0,
    )
    sag = static_sag(assemble(rig), "-y")
    area, second_moment = math.pi / 4 * diameter**2, math.pi / 64 * diameter**4
    want = 5 * density * area * 9.80665 * length**4 / (384 * E * second_moment)
    assert -sag[1].min() == pytest.approx(want, rel=2e-4)  # shear adds 1e-4
    assert np.abs(sag[0]).max() == 0


@pytest.mark.parametrize("omega", [0.0, 300.0, 1500.0])
def test_an_overhung_disk_whirls_at_the_frequencies_of_its_two_degrees_of_freedom(omega):
    """A massless overhang L beyond two pins a apart: tip flexibility by the area-moment theorems, then 2 DOF in r, phi.

    m r'' + k11 r + k12 phi = 0, It phi'' - j Omega Ip phi' + k21 r + k22 phi = 0 with r = x + j y, phi = a + j b.
    """
    span, overhang, diameter, E = 0.4, 0.3, 0.012, 2e11
    m, Ip, It = 1.5, 4e-3, 2.2e-3
    rig = rotor(
        shaft={"length": span + overhang, "diameter": diameter, "youngs_modulus": E},
        disk={"position": span + overhang, "mass": m, "polar_inertia": Ip, "transverse_inertia": It},
        bearings={0.0: 1e10, span: 1e10},
        probe=span + overhang,
    )
    bending = E * math.pi / 64 * diameter**4
    shear = (6 * 1.3 / 8.8) * E / 2.6 * math.pi / 4 * diameter**2  # kappa G A, Cowper's factor, nu = 0.3
    flexibility = (
        np.array(
            [
                [overhang**3 / 3 + overhang**2 * span / 3, overhang**2 / 2 + overhang * span / 3],
                [overhang**2 / 2 + overhang * span / 3, overhang + span / 3],
            ]
        )
        / bending
        + np.array([[overhang + overhang**2 / span, overhang / span], [overhang / span, 1 / span]]) / shear
    )
    k = np.linalg.inv(flexibility)
    inverse_mass = np.diag([1 / m, 1 / It])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse_mass @ k, np.diag([0, 1j * omega * Ip / It])]])
    whirl = np.linalg.eigvals(A).imag  # positive: x towards y
    modes = whirl_modes(assemble(rig), omega, count=4)
    np.testing.assert_allclose(sorted(abs(whirl)), [mode.frequency for mode in modes], rtol=1e-5)
    if omega:
        want = [np.sign(whirl[np.argsort(abs(whirl))][i]) for i in range(4)]
        assert [round(mode.whirl) for mode in modes] == want
