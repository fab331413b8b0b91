"""The FE rotor against formulas: Jeffcott, slender beam, an overhung disk with gyroscopic moment; stability.

Friswell, Penny, Garvey, Lees, Dynamics of Rotating Machines (2010), ch. 3, 6 and 7; Timoshenko, Vibration Problems;
Den Hartog, Mechanical Vibrations (1956), for the disk on a cantilever (Stodola's problem). The formulas are derived or
stated where they are used; tolerances are what the formula leaves out.
"""

import math
from typing import Any

import numpy as np
import pytest

from rotorrig.rig.config.description import RigConfig, from_si
from rotorrig.sims.rotor.model.assembly import assemble, with_bearing
from rotorrig.sims.rotor.modes.campbell import stability_onset
from rotorrig.sims.rotor.modes.modes import critical_modes, natural_frequencies, static_sag, whirl_modes
from rotorrig.sims.rotor.steady.harmonic_response import probe_response


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


def test_a_disk_on_a_massless_shaft_between_rigid_bearings_is_critical_at_its_bending_stiffness():
    """Jeffcott's first critical speed, 48 E I / L^3 with the shear added: 1 / k = L^3 / 48 E I + L / 4 kappa G A."""
    length, diameter, E, m = 0.5, 0.012, 2e11, 1.2
    rig = rotor(
        shaft={"length": length, "diameter": diameter},
        disk={"position": length / 2, "mass": m, "polar_inertia": 1e-3, "transverse_inertia": 6e-4},
        bearings={0.0: 0.0, length: 0.0},
        probe=length / 2,
    )
    rigid = tuple(b.model_copy(update={"rigid": True, "kxx": None, "kyy": None}) for b in rig.bearings)
    I, A = math.pi / 64 * diameter**4, math.pi / 4 * diameter**2  # noqa: E741
    flexibility = length**3 / (48 * E * I) + length / (4 * (7.8 / 8.8) * E / 2.6 * A)
    found = critical_modes(assemble(rig.model_copy(update={"bearings": rigid})), up_to=1.2 / math.sqrt(flexibility * m))
    assert [mode.omega for mode in found] == pytest.approx([1 / math.sqrt(flexibility * m)] * 2, rel=1e-7)


def test_a_disk_on_a_cantilever_is_critical_where_den_hartog_says():
    """Synchronous whirl of a disk on a massless cantilever, by the flexibilities a of its end.

    The disk's force m w^2 r and moment -D w^2 phi bend it: r = a11 m w^2 r - a12 D w^2 phi, phi = a12 m w^2 r - a22 D
    w^2 phi, with D = Ip - It forward and -(Ip + It) backward, so
    1 - w^2 (a11 m - a22 D) - w^4 m D (a11 a22 - a12^2) = 0. The clamp is a stub 25 times as thick in two rigid
    bearings; its slope is 1e-6 of the cantilever's.
    """
    L, diameter, E, m, Ip, It = 0.3, 0.012, 2e11, 1.5, 12e-3, 6.5e-3
    stub = 0.3
    rig = rotor(
        shaft={"sections": [{"length": stub, "diameter": 0.3}, {"length": L, "diameter": diameter}]},
        disk={"position": stub + L, "mass": m, "polar_inertia": Ip, "transverse_inertia": It},
        bearings={0.0: 0.0, stub: 0.0},
        probe=L,
    )
    rigid = tuple(b.model_copy(update={"rigid": True, "kxx": None, "kyy": None}) for b in rig.bearings)
    bending = E * math.pi / 64 * diameter**4
    shear = (7.8 / 8.8) * E / 2.6 * math.pi / 4 * diameter**2
    a11, a12, a22 = L**3 / (3 * bending) + L / shear, L**2 / (2 * bending), L / bending

    def criticals(D: float) -> list[float]:
        roots = np.roots([-m * D * (a11 * a22 - a12**2), -(a11 * m - a22 * D), 1]).real
        return [math.sqrt(w2) for w2 in roots if w2 > 0]

    forward, backward = criticals(Ip - It), criticals(-(Ip + It))
    assert (len(forward), len(backward)) == (1, 2)  # a flat disk's second forward critical speed does not exist
    found = critical_modes(assemble(rig.model_copy(update={"bearings": rigid})), up_to=1.3 * max(forward + backward))
    want = sorted([(w, 1) for w in forward] + [(w, -1) for w in backward])
    assert [round(mode.whirl) for mode in found] == [sense for _, sense in want]
    np.testing.assert_allclose([mode.omega for mode in found], [w for w, _ in want], rtol=1e-5)


def on_a_pedestal(*, k: float, c: float, cross: Any) -> RigConfig:
    """Return Jeffcott's rotor of 1 kg on a stiff light shaft whose two bearings share k, c and kxy = -kyx."""
    rig = rotor(
        shaft={"length": 0.4, "diameter": 0.08, "youngs_modulus": 2e14},
        disk={"position": 0.2, "mass": 1.0, "polar_inertia": 1e-6, "transverse_inertia": 1e-4},
        bearings={0.0: 1.0, 0.4: 1.0},
        probe=0.2,
    )
    table = rig.model_dump()
    for bearing in table["bearings"]:
        bearing.update(kxx=k / 2, kyy=k / 2, cxx=c / 2, cyy=c / 2, kxy=cross(0.5), kyx=cross(-0.5))
    return from_si(table)


def test_rotating_damping_drives_jeffcotts_rotor_unstable_above_its_critical_speed():
    """m r'' + (c_e + c_i) r' + (k - j Omega c_i) r = 0: unstable from w (1 + c_e / c_i) on, at the frequency w."""
    k, c_e, c_i, top = 4e4, 30.0, 20.0, 1000.0
    rig = on_a_pedestal(k=k, c=c_e + c_i, cross=lambda part: {"speed": (0.0, top), "value": (0.0, part * c_i * top)})
    model = assemble(rig, max_element=0.2)
    onset = stability_onset(model, up_to=top)
    w = math.sqrt(k / (1 + 1e-3 * math.pi / 4 * 0.08**2 * 0.4))  # the shaft rides along
    assert onset is not None
    assert onset.omega == pytest.approx(w * (1 + c_e / c_i), rel=1e-4)
    assert onset.frequency == pytest.approx(w, rel=1e-4)
    assert round(onset.whirl, 3) == 1
    assert stability_onset(model, up_to=0.99 * onset.omega) is None


@pytest.mark.parametrize(("part", "stable"), [(0.999, True), (1.001, False)])
def test_cross_coupled_stiffness_wins_over_damping_where_it_exceeds_c_times_omega(part, stable):
    """m r'' + c r' + (k - j q) r = 0 is marginal at q = c w exactly: then r = e^{j w t}, w^2 = k / m."""
    k, c = 4e4, 30.0
    w = math.sqrt(k / (1 + 1e-3 * math.pi / 4 * 0.08**2 * 0.4))
    model = assemble(on_a_pedestal(k=k, c=c, cross=lambda half: half * part * c * w), max_element=0.2)
    onset = stability_onset(model, up_to=300.0)
    assert (onset is None) == stable
    if onset:
        assert onset.omega == 0  # at every speed
