"""The shaft element: a uniform tube between two nodes, bent in two planes (chapter, section 5.2, eq. 6).

Degrees of freedom of a node: x, y [m] and the slopes a = dx/dz, b = dy/dz [rad] of its cross-section (bending part
of the slope: shear adds to dx/dz but not to a). Both planes then obey the same equations with the same signs; in
rotations about the axes, a turns about +y and b about -x. Rotation from x towards y is positive.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Tube

Element = Literal["timoshenko", "lumped"]
Matrix = NDArray[np.float64]

NODE_DOF = 4  # x, y, a, b
X_PLANE = np.array([0, 2, 4, 6])  # x1, a1, x2, a2
Y_PLANE = np.array([1, 3, 5, 7])  # y1, b1, y2, b2
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)  # takes longer than all else of an element


class ElementMatrices(NamedTuple):
    """Mass, gyroscopic and stiffness matrix of one element, (8, 8); G multiplies Omega q'."""

    M: Matrix
    G: Matrix
    K: Matrix


class Properties(NamedTuple):
    """What elements are made of, (element,) each; real, or complex for a complex step."""

    bending: NDArray  # N m^2, E I
    shear: NDArray  # N, kappa G A
    mass: NDArray  # kg/m
    tilt: NDArray  # kg m, transverse inertia per length


class PlaneMatrices(NamedTuple):
    """One plane's matrices of elements over (x1, a1, x2, a2), (element, 4, 4) each."""

    mass: NDArray  # of translation
    tilt: NDArray  # of rotation, with the transverse inertia rho I per length
    stiffness: NDArray


def shaft_element(tube: Tube, length: float, *, element: Element = "timoshenko") -> ElementMatrices:
    """Return the matrices of eq. (6) for a piece of `tube` of `length` [m], first node's four DOFs first.

    "timoshenko": consistent mass with rotary inertia and shear (Nelson, J. Mech. Design 102, 1980, 793).
    "lumped": the chapter's; half of the element's mass and rotary inertia at either node, the same stiffness.
    G has the polar inertia at (a, b) and its negative at (b, a); eq. (5) and (6) carry it with the other sign.
    Raises ValueError unless the length is above zero.
    """
    if not length > 0:
        raise ValueError(f"the element's length is {length:g} m, want one above zero")
    mass, tilt, stiffness = (A[0] for A in plane_matrices(properties([tube]), np.array([length]), element=element))
    M, G, K = (np.zeros((2 * NODE_DOF, 2 * NODE_DOF)) for _ in range(3))
    for dof in (X_PLANE, Y_PLANE):
        M[np.ix_(dof, dof)] = mass + tilt  # M_T + M_R of eq. (6)
        K[np.ix_(dof, dof)] = stiffness
    G[np.ix_(X_PLANE, Y_PLANE)] = 2 * tilt  # a slender slice has Ip = 2 It
    G[np.ix_(Y_PLANE, X_PLANE)] = -2 * tilt
    return ElementMatrices(M, G, K)


def properties(tubes: Sequence[Tube]) -> Properties:
    """Return the properties of one element of each tube."""
    shear = [shear_factor(t) * area(t) * t.youngs_modulus / (2 * (1 + t.poisson_ratio)) for t in tubes]
    return Properties(
        bending=np.array([t.youngs_modulus * second_moment(t) for t in tubes]),
        shear=np.array(shear),
        mass=np.array([t.density * area(t) for t in tubes]),
        tilt=np.array([t.density * second_moment(t) for t in tubes]),
    )


def plane_matrices(of: Properties, length: NDArray, *, element: Element = "timoshenko") -> PlaneMatrices:
    """Integrate the shape functions' products for elements of lengths (element,) [m].

    Four Gauss points are exact for these polynomials (degree 6).
    """
    phi = shear_share(of, length)
    N, R, curvature, shear = _shape_functions(length, phi)
    weight = _WEIGHTS * length[:, None] / 2

    def integral(shape: NDArray) -> NDArray:
        return (shape * weight[:, None]) @ shape.swapaxes(1, 2)

    bending, shear_stiffness = of.bending[:, None, None], of.shear[:, None, None]
    stiffness = bending * integral(curvature) + shear_stiffness * integral(shear)
    if element == "lumped":
        half = length[:, None, None] / 2
        mass = half * of.mass[:, None, None] * np.diag([1.0, 0.0, 1.0, 0.0])
        tilt = half * of.tilt[:, None, None] * np.diag([0.0, 1.0, 0.0, 1.0])
    else:
        mass, tilt = of.mass[:, None, None] * integral(N), of.tilt[:, None, None] * integral(R)
    return PlaneMatrices(mass, tilt, stiffness)


def shear_share(of: Properties, length: NDArray) -> NDArray:
    """Return the ratio of shear to bending flexibility of elements, (element,)."""
    return 12 * of.bending / (of.shear * length**2)


def area(tube: Tube) -> float:
    """Return the cross-section [m^2]."""
    return np.pi / 4 * (tube.diameter**2 - tube.inner_diameter**2)


def second_moment(tube: Tube) -> float:
    """Return the second moment of area about a diameter [m^4]."""
    return np.pi / 64 * (tube.diameter**4 - tube.inner_diameter**4)


def shear_factor(tube: Tube) -> float:
    """Return the effective part of the cross-section in shear: Cowper, J. Appl. Mech. 33 (1966) 335, hollow circle.

    >>> from rotorrig.rig.config.nameplate import Tube
    >>> rod = Tube(
    ...     start=0, length=1, diameter=0.1, inner_diameter=0, density=7800, youngs_modulus=2e11, poisson_ratio=0.3
    ... )
    >>> round(shear_factor(rod), 6)  # solid: 6 (1 + nu) / (7 + 6 nu)
    0.886364
    """
    nu = tube.poisson_ratio
    m2 = (tube.inner_diameter / tube.diameter) ** 2
    return 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)


def deflection_shapes(s: NDArray, length: NDArray, phi: NDArray) -> NDArray:
    """Return the shape functions of deflection at `s`, (element, 4 dof, point).

    `s` (point,) or (element, point) goes from 0 to 1 along an element; lengths [m] and `phi`, of `shear_share`, are
    (element,). Exact for static end loads (Nelson 1980, eq. 5).
    """
    L, phi = length[:, None], phi[:, None]
    N = [
        1 - 3 * s**2 + 2 * s**3 + phi * (1 - s),
        L * (s - 2 * s**2 + s**3 + phi / 2 * (s - s**2)),
        3 * s**2 - 2 * s**3 + phi * s,
        L * (s**3 - s**2 - phi / 2 * (s - s**2)),
    ]
    return np.stack(N, axis=1) / (1 + phi[:, None])


def _shape_functions(length: NDArray, phi: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Return deflection, section slope, curvature and shear angle at the Gauss points, each (element, 4 dof, point).

    Nelson 1980, eq. 5 to 9.
    """
    s = (_POINTS + 1) / 2
    L, share = length[:, None], phi[:, None]
    one = np.ones_like(s) / L
    R = [
        6 / L * (s**2 - s),
        1 - 4 * s + 3 * s**2 + share * (1 - s),
        6 / L * (s - s**2),
        3 * s**2 - 2 * s + share * s,
    ]
    curvature = [6 / L**2 * (2 * s - 1), (6 * s - 4 - share) / L, 6 / L**2 * (1 - 2 * s), (6 * s - 2 + share) / L]
    shear = [-share * one, -share / 2 * L * one, share * one, -share / 2 * L * one]
    slope, bend, shear_angle = (np.stack(shape, axis=1) / (1 + share[:, None]) for shape in (R, curvature, shear))
    return deflection_shapes(s, length, phi), slope, bend, shear_angle
