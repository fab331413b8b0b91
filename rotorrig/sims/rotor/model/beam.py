"""The shaft element: a uniform tube between two nodes, bent in two planes (chapter, section 5.2, eq. 6).

Degrees of freedom of a node: x, y [m] and the slopes a = dx/dz, b = dy/dz [rad] of its cross-section (bending part
of the slope: shear adds to dx/dz but not to a). Both planes then obey the same equations with the same signs; in
rotations about the axes, a turns about +y and b about -x. Rotation from x towards y is positive.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rotorrig.rig.config import Tube

Element = Literal["timoshenko", "lumped"]
Matrix = NDArray[np.float64]

NODE_DOF = 4  # x, y, a, b
_X_PLANE = np.array([0, 2, 4, 6])  # x1, a1, x2, a2
_Y_PLANE = np.array([1, 3, 5, 7])  # y1, b1, y2, b2
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)  # takes longer than all else of an element


class ElementMatrices(NamedTuple):
    """Mass, gyroscopic and stiffness matrix of one element, (8, 8); G multiplies Omega q'."""

    M: Matrix
    G: Matrix
    K: Matrix


def shaft_element(tube: Tube, length: float, *, element: Element = "timoshenko") -> ElementMatrices:
    """Return the matrices of eq. (6) for a piece of `tube` of `length` [m], first node's four DOFs first.

    "timoshenko": consistent mass with rotary inertia and shear (Nelson, J. Mech. Design 102, 1980, 793).
    "lumped": the chapter's; half of the element's mass and rotary inertia at either node, the same stiffness.
    G has the polar inertia at (a, b) and its negative at (b, a); eq. (5) and (6) carry it with the other sign.
    Raises ValueError unless the length is above zero.
    """
    if not length > 0:
        raise ValueError(f"the element's length is {length:g} m, want one above zero")
    plane = _one_plane(tube, length)
    mass, tilt = (plane.mass, plane.tilt) if element == "timoshenko" else _lump(tube, length)
    M, G, K = (np.zeros((2 * NODE_DOF, 2 * NODE_DOF)) for _ in range(3))
    for dof in (_X_PLANE, _Y_PLANE):
        M[np.ix_(dof, dof)] = mass + tilt  # M_T + M_R of eq. (6)
        K[np.ix_(dof, dof)] = plane.stiffness
    G[np.ix_(_X_PLANE, _Y_PLANE)] = 2 * tilt  # a slender slice has Ip = 2 It
    G[np.ix_(_Y_PLANE, _X_PLANE)] = -2 * tilt
    return ElementMatrices(M, G, K)


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


class _Plane(NamedTuple):
    """One plane's (4, 4) matrices over (x1, a1, x2, a2)."""

    mass: Matrix  # of translation
    tilt: Matrix  # of rotation, with the transverse inertia rho I per length
    stiffness: Matrix


def _one_plane(tube: Tube, length: float) -> _Plane:
    """Integrate the shape functions' products; four Gauss points are exact for these polynomials (degree 6)."""
    E, A, I = tube.youngs_modulus, area(tube), second_moment(tube)  # noqa: E741
    shear_stiffness = shear_factor(tube) * A * E / (2 * (1 + tube.poisson_ratio))
    N, R, curvature, shear = _shape_functions(length, 12 * E * I / (shear_stiffness * length**2))
    weight = _WEIGHTS * length / 2

    def integral(shape: Matrix) -> Matrix:
        return (shape * weight) @ shape.T

    return _Plane(
        mass=tube.density * A * integral(N),
        tilt=tube.density * I * integral(R),
        stiffness=E * I * integral(curvature) + shear_stiffness * integral(shear),
    )


def _shape_functions(length: float, phi: float) -> tuple[Matrix, Matrix, Matrix, Matrix]:
    """Return deflection, section slope, curvature and shear angle at the Gauss points, each (4 dof, 4 point).

    Exact for static end loads; `phi` is the ratio of shear to bending flexibility (Nelson 1980, eq. 5 to 9).
    """
    s = (_POINTS + 1) / 2  # 0 to 1 along the element
    one, L = np.ones_like(s), length
    N = [
        1 - 3 * s**2 + 2 * s**3 + phi * (1 - s),
        L * (s - 2 * s**2 + s**3 + phi / 2 * (s - s**2)),
        3 * s**2 - 2 * s**3 + phi * s,
        L * (s**3 - s**2 - phi / 2 * (s - s**2)),
    ]
    R = [
        6 / L * (s**2 - s),
        1 - 4 * s + 3 * s**2 + phi * (1 - s),
        6 / L * (s - s**2),
        3 * s**2 - 2 * s + phi * s,
    ]
    curvature = [6 / L**2 * (2 * s - 1), (6 * s - 4 - phi) / L, 6 / L**2 * (1 - 2 * s), (6 * s - 2 + phi) / L]
    shear = [-phi / L * one, -phi / 2 * one, phi / L * one, -phi / 2 * one]
    deflection, slope, bend, shear_angle = (np.array(shape) / (1 + phi) for shape in (N, R, curvature, shear))
    return deflection, slope, bend, shear_angle


def _lump(tube: Tube, length: float) -> tuple[Matrix, Matrix]:
    half = tube.density * length / 2
    mass = half * area(tube) * np.diag([1.0, 0.0, 1.0, 0.0])
    tilt = half * second_moment(tube) * np.diag([0.0, 1.0, 0.0, 1.0])
    return mass, tilt
