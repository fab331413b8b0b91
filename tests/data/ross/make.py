"""Save four rotors with ROSS 2.3.0 and what it says of them. Run by ROSS's own Python.

python make.py FOLDER writes them; python make.py FOLDER ROTOR... loads those instead, saves each again in FOLDER.
"""

import json
import sys
from pathlib import Path

import numpy as np
import ross
from ross.materials import steel

TITANIUM = ross.Material(name="Ti", rho=4430, E=113.8e9, Poisson=0.342)
SPEEDS = (100.0, 300.0)


def plain():
    """ROSS's own first example: six equal elements, two disks, two bearings."""
    shaft = [ross.ShaftElement(L=0.25, idl=0.0, odl=0.05, material=steel) for _ in range(6)]
    disks = [
        ross.DiskElement.from_geometry(n=n, material=steel, width=0.07, i_d=0.05, o_d=0.28, tag=f"Disk {n}")
        for n in (2, 4)
    ]
    ends = [ross.BearingElement(n=n, kxx=1e6, kyy=8e5, cxx=1e3) for n in (0, 6)]
    return ross.Rotor(shaft, disks, ends, rated_w=300.0)


def stepped():
    """Hollow, stepped, of two materials, damped; bearings over speed, with cross coefficients, and a seal."""
    damped = {"alpha": 2.0, "beta": 1e-5}
    shaft = [ross.ShaftElement(L=0.2, idl=0.0, odl=0.05, material=steel, **damped) for _ in range(3)]
    shaft += [ross.ShaftElement(L=0.15, idl=0.02, odl=0.06, material=TITANIUM, **damped) for _ in range(2)]
    shaft += [ross.ShaftElement(L=0.1, idl=0.01, odl=0.04, material=steel, **damped)]
    wheel = ross.DiskElement.from_geometry(n=2, material=steel, width=0.05, i_d=0.05, o_d=0.3, tag="wheel")
    hub = ross.DiskElement(n=6, m=3.0, Id=0.02, Ip=0.03, tag="hub")
    speeds = np.array([0.0, 100.0, 300.0])
    film = ross.BearingElement(
        n=0,
        kxx=[1e6, 2e6, 3e6],
        kyy=[2e6, 3e6, 3.5e6],
        kxy=[0.0, 4e5, 6e5],
        kyx=[0.0, -5e5, -9e5],
        cxx=[1000, 900, 700.0],
        frequency=speeds,
        tag="film",
    )
    ball = ross.BearingElement(n=5, kxx=1e7, kyy=2e7, cxx=100, cxy=20, cyx=-20, kzz=1e5, tag="ball")
    seal = ross.SealElement(n=3, kxx=1e3, kxy=5e3, kyx=-5e3, cxx=10.0, tag="seal")
    return ross.Rotor(shaft, [wheel, hub], [film, ball, seal])


def tapered(pieces=1):
    """A shaft of which a fifth, in `pieces` elements, grows from 40 to 60 mm and its bore from 0 to 20 mm."""
    shaft = [ross.ShaftElement(L=0.2, idl=0.0, odl=0.04, material=steel) for _ in range(2)]
    for i in range(pieces):
        left, right = 0.02 * i / pieces, 0.02 * (i + 1) / pieces
        ends = {"idl": left, "odl": 0.04 + left, "idr": right, "odr": 0.04 + right}
        shaft.append(ross.ShaftElement(L=0.2 / pieces, material=steel, **ends))
    shaft += [ross.ShaftElement(L=0.2, idl=0.02, odl=0.06, material=steel) for _ in range(2)]
    disk = ross.DiskElement.from_geometry(n=2, material=steel, width=0.05, i_d=0.05, o_d=0.3)
    return ross.Rotor(shaft, [disk], [ross.BearingElement(n=n, kxx=1e7, cxx=100.0) for n in (0, len(shaft))])


def sleeved():
    """A shaft whose middle, six elements of 50 mm, is within sleeves that have mass and, in effect, no stiffness."""
    mass = ross.Material(name="mass", rho=7800, E=7e3, G_s=7e3)
    lengths = [0.1] * 6 + [0.05] * 6 + [0.1] * 6
    shaft = [ross.ShaftElement(L=L, idl=0.0, odl=0.05, material=steel, n=n) for n, L in enumerate(lengths)]
    shaft += [
        ross.ShaftElement(L=0.05, idl=0.05, odl=0.12, material=mass, n=n, tag=f"sleeve {n}") for n in range(6, 12)
    ]
    disk = ross.DiskElement.from_geometry(n=4, material=steel, width=0.05, i_d=0.05, o_d=0.3)
    return ross.Rotor(shaft, [disk], [ross.BearingElement(n=n, kxx=1e7, cxx=100.0) for n in (1, 17)])


def lateral_eigenvalues(rotor, omega, count=8):
    """Return the lowest `count` eigenvalues above the real axis, [re, im] rad/s, of x, y and the two tilts."""
    dof = [i for i in range(rotor.ndof) if i % 6 not in (2, 5)]
    M, C, G, K = (matrix[np.ix_(dof, dof)] for matrix in (rotor.M(omega), rotor.C(omega), rotor.G(), rotor.K(omega)))
    zero, one = np.zeros_like(M), np.eye(len(dof))
    A = np.block([[zero, one], [-np.linalg.solve(M, K), -np.linalg.solve(M, C + omega * G)]])
    values = np.linalg.eigvals(A)
    values = sorted(values[values.imag > 0], key=lambda v: v.imag)[:count]
    return [[float(v.real), float(v.imag)] for v in values]


def said_of(rotor):
    """Return the lateral eigenvalues at SPEEDS, the node positions [m] and the mass [kg]."""
    return {
        "nodes": [float(z) for z in rotor.nodes_pos],
        "mass": float(rotor.m),
        "eigenvalues": {f"{omega:g}": lateral_eigenvalues(rotor, omega) for omega in SPEEDS},
    }


def main(folder, *files):
    if files:
        rotors = {Path(file).stem: ross.Rotor.load(file) for file in files}
        said = {name: said_of(rotor) for name, rotor in rotors.items()}
    else:
        rotors = {make.__name__: make() for make in (plain, stepped, tapered, sleeved)}
        said = {name: said_of(rotor) for name, rotor in rotors.items()}
        said["tapered in 20"] = said_of(tapered(20))
    for name, rotor in rotors.items():
        rotor.save(folder / f"{name}.toml")
    (folder / "said.json").write_text(json.dumps({"ross": ross.__version__, **said}, indent=1) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
