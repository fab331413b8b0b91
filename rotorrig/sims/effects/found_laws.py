"""Laws of a force at a place of the shaft: how it goes with speed and motion, whatever it is that makes it.

Under the motion Re(q e^{j theta}) a law acts with the force Re(F e^{j theta}). Both are told by what of them turns with
the shaft and what against it: (x, y) = f (1, -j) + b (1, j) for rotation x to y. found_force.py makes an effect of
them. Source: the equivalent loads of Markert, Platz, Seidler, Int. J. Rotating Machinery 7 (2001) 311, each by the law
that produces it.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from numba import njit
from numpy.typing import NDArray

from rotorrig.sims.effects.base import Complex, Theta, polar
from rotorrig.sims.rotor.nonlinear import Force

PLUS = " + "  # between the names of several laws
SHARE = 0.03  # of a bearing's stiffness: a typical size of a law that goes with the motion
MOTION = 20e-6  # m, and
ARM = 0.03  # m: typical of the motion, and of a moment's force
FREQUENCY, DAMPING = "natural frequency", "damping ratio"  # unknowns of what resonates, beside its amounts
STILL = 1e-6  # m/s: slower than this the direction of the motion is not known

Reals = NDArray[np.float64]
Pair = tuple[Complex, Complex]  # what turns with the shaft, and what against it
Pattern = tuple[tuple[float, float], tuple[float, float]]  # between x and y

ALIKE: Pattern = ((1, 0), (0, 1))
UNLIKE: Pattern = ((0.5, 0), (0, -0.5))
SKEW: Pattern = ((0, 1), (1, 0))
CROSSED: Pattern = ((0, 1), (-1, 0))  # for rotation x to y: the force is ahead of the motion


@dataclass(frozen=True, slots=True, kw_only=True)
class Law(ABC):
    """How one force goes with speed and motion; one that `tilts` is a moment, by the slope."""

    unknowns: tuple[str, ...]
    unit: str  # of its unknowns
    typical: Callable[[float, float], float]  # size, of a bearing's stiffness [N/m] and a speed [rad/s]
    words: Callable[[Theta], str]
    textbook: str = ""  # what has that law
    tilts: bool = False

    @property
    def is_nonlinear(self) -> bool:
        """True where the force is not linear in the motion."""
        return False

    @abstractmethod
    def units(self, f: Complex, b: Complex, omega: Reals) -> list[Pair]:
        """Return for one unit of each unknown the force at speeds [rad/s], under motions f and b [m]: its 1X."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenForce(Law):
    """A phasor whatever the motion; its two unknowns are its real and imaginary part."""

    backward: bool = False
    law: Literal["constant", "unbalance"] = "constant"

    @property
    def name(self) -> str:
        """Name of the phasor."""
        return self.unknowns[0].removesuffix(" re")

    def units(self, f: Complex, b: Complex, omega: Reals) -> list[Pair]:
        """Return its size, once along the mark and once a quarter of a turn ahead."""
        size: Complex = (omega**2 if self.law == "unbalance" else np.ones_like(omega)).astype(complex)
        nothing = np.zeros_like(size)
        return [(nothing, own) if self.backward else (own, nothing) for own in (size, 1j * size)]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearForce(Law):
    """One that is linear in the motion: a term of the stiffness K, the damping C, Omega H or Omega^2 S."""

    matrix: Literal["K", "C", "H", "S"]
    patterns: tuple[Pattern, ...]  # of each unknown

    def units(self, f: Complex, b: Complex, omega: Reals) -> list[Pair]:
        """Return what its matrices make of the motion."""
        powers = {"K": 1.0 + 0j * omega, "C": 1j * omega, "H": omega + 0j, "S": omega**2 + 0j}
        by = powers[self.matrix]
        x, y = f + b, -1j * f + 1j * b
        forces = []
        for (xx, xy), (yx, yy) in self.patterns:
            fx, fy = -by * (xx * x + xy * y), -by * (yx * x + yy * y)
            forces.append(((fx + 1j * fy) / 2, (fx - 1j * fy) / 2))
        return forces


@dataclass(frozen=True, slots=True, kw_only=True)
class ResonantForce(Law):
    """One that is linear in the motion and resonates with it: whatever gives way there has a mass of its own.

    a / (1 - (Omega / omega_0)^2 + 2 j zeta Omega / omega_0) times the motion along x or y, `a` being its unknowns.
    """

    frequency: float = 0.0  # rad/s, where a search stands
    ratio: float = 0.05

    def units(self, f: Complex, b: Complex, omega: Reals) -> list[Pair]:
        """Return what it makes of the motion along x, then along y."""
        u = omega / self.frequency
        by = 1 / (1 - u**2 + 2j * self.ratio * u)
        fx, fy = by * (f + b), by * 1j * (b - f)
        return [(fx / 2, fx / 2), (1j * fy / 2, -1j * fy / 2)]


@dataclass(frozen=True, slots=True, kw_only=True)
class NonlinearForce(Law):
    """One that is not; its first order is that of a motion f and b without others."""

    force: Force
    first: Callable[[Complex, Complex], Pair]

    @property
    def is_nonlinear(self) -> bool:
        """True."""
        return True

    def units(self, f: Complex, b: Complex, omega: Reals) -> list[Pair]:
        """Return its first order."""
        return [self.first(f, b)]


@njit(cache=True)
def cubic(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return -k3 |r|^2 r."""
    k = -constants[0] * (x * x + y * y)
    return k * x, k * y


@njit(cache=True)
def dry(x: float, y: float, vx: float, vy: float, constants: NDArray[np.float64]) -> tuple[float, float]:
    """Return -F v / |v|."""
    by = -constants[0] / np.sqrt(vx * vx + vy * vy + STILL * STILL)
    return by * vx, by * vy


def check_laws(effect: str, names: Iterable[str], known: Collection[str]) -> None:
    """Raise ValueError naming the laws there are if one of those of an effect is none of them."""
    if unknown := next((name for name in names if name not in known), None):
        raise ValueError(f"{effect}: there is no law '{unknown}', want some of {', '.join(known)}, joined by '{PLUS}'")


def _cubic_first(f: Complex, b: Complex) -> Pair:
    return -(np.abs(f) ** 2 + 2 * np.abs(b) ** 2) * f, -(2 * np.abs(f) ** 2 + np.abs(b) ** 2) * b


def _dry_first(f: Complex, b: Complex) -> Pair:
    size = np.sqrt(np.abs(f) ** 2 + np.abs(b) ** 2) + 1e-12
    return -1j * f / size, -1j * b / size


def _figure(value: float) -> str:
    """Return three digits, without an exponent where one can do without.

    >>> _figure(1569.6), _figure(-0.0412), _figure(2.64e10), _figure(14.0)
    ('1,570', '-0.0412', '2.64e+10', '14')
    """
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.10g}" if 1e-3 <= abs(rounded) < 1e5 or not rounded else f"{rounded:.3g}"


def _phasor(theta: Theta, name: str, unit: str, *, by: float = 1.0) -> str:
    size, angle = polar(theta, name)
    return f"{_figure(by * size)} {unit} at {angle:.0f} deg from the keyphasor mark"


LAWS: Mapping[str, Law] = MappingProxyType(
    {
        "force": GivenForce(
            unknowns=("force re", "force im"),
            unit="N",
            typical=lambda k, w: SHARE * k * MOTION,
            words=lambda t: f"a force that turns with the shaft, alike at all speeds, {_phasor(t, 'force', 'N')}",
            textbook="a bent shaft",
        ),
        "speed squared": GivenForce(
            unknowns=("unbalance re", "unbalance im"),
            unit="kg m",
            law="unbalance",
            typical=lambda k, w: 5e-6,
            words=lambda t: (
                "a force that turns with the shaft and grows with the square of the speed, "
                f"{_phasor(t, 'unbalance', 'g mm', by=1e6)}"
            ),
            textbook="an unbalance",
        ),
        "backward force": GivenForce(
            unknowns=("backward force re", "backward force im"),
            unit="N",
            backward=True,
            typical=lambda k, w: SHARE * k * MOTION,
            words=lambda t: (
                f"a force that turns against the shaft, alike at all speeds, {_phasor(t, 'backward force', 'N')}"
            ),
        ),
        "moment": GivenForce(
            unknowns=("moment re", "moment im"),
            unit="N m",
            tilts=True,
            typical=lambda k, w: SHARE * k * MOTION * ARM,
            words=lambda t: f"a moment that turns with the shaft, alike at all speeds, {_phasor(t, 'moment', 'N m')}",
            textbook="a kink of the shaft",
        ),
        "moment by speed squared": GivenForce(
            unknowns=("couple re", "couple im"),
            unit="kg m^2",
            law="unbalance",
            tilts=True,
            typical=lambda k, w: 5e-6 * ARM,
            words=lambda t: (
                "a moment that turns with the shaft and grows with the square of the speed, "
                f"{_phasor(t, 'couple', 'g mm^2', by=1e9)}"
            ),
            textbook="a couple unbalance",
        ),
        "stiffness": LinearForce(
            unknowns=("stiffness",),
            unit="N/m",
            matrix="K",
            patterns=(ALIKE,),
            typical=lambda k, w: SHARE * k,
            words=lambda t: f"a force against the motion, {_figure(t['stiffness'])} N/m",
            textbook="a stiffness",
        ),
        "skew stiffness": LinearForce(
            unknowns=("kxx less kyy", "kxy"),
            unit="N/m",
            matrix="K",
            patterns=(UNLIKE, SKEW),
            typical=lambda k, w: SHARE * k,
            words=lambda t: (
                f"a stiffness that differs with the direction, kxx - kyy {_figure(t['kxx less kyy'])} N/m, "
                f"kxy = kyx {_figure(t['kxy'])} N/m"
            ),
            textbook="a support with two stiffnesses",
        ),
        "cross-coupled stiffness": LinearForce(
            unknowns=("cross-coupled stiffness",),
            unit="N/m",
            matrix="K",
            patterns=(CROSSED,),
            typical=lambda k, w: SHARE * k,
            words=lambda t: (
                f"a force across the motion, a quarter of a turn ahead, {_figure(t['cross-coupled stiffness'])} N/m"
            ),
            textbook="a fluid film",
        ),
        "cross-coupled stiffness over speed": LinearForce(
            unknowns=("cross-coupled damping",),
            unit="N s/m",
            matrix="H",
            patterns=(CROSSED,),
            typical=lambda k, w: SHARE * k / w,
            words=lambda t: (
                "a force across the motion, a quarter of a turn ahead, that grows with the speed, "
                f"{_figure(t['cross-coupled damping'])} N s/m"
            ),
            textbook="a seal, or damping that turns with the shaft",
        ),
        "damping": LinearForce(
            unknowns=("damping",),
            unit="N s/m",
            matrix="C",
            patterns=(ALIKE,),
            typical=lambda k, w: SHARE * k / w,
            words=lambda t: f"a force against the velocity, {_figure(t['damping'])} N s/m",
            textbook="viscous damping",
        ),
        "stiffness over speed": LinearForce(
            unknowns=("stiffness over speed squared",),
            unit="N s^2/m",
            matrix="S",
            patterns=(ALIKE,),
            typical=lambda k, w: SHARE * k / w**2,
            words=lambda t: (
                "a force against the motion that grows with the square of the speed, "
                f"{_figure(t['stiffness over speed squared'])} N s^2/m"
            ),
            textbook="a stiffness that grows with speed, or less mass",
        ),
        "resonance": ResonantForce(
            unknowns=("resonant stiffness x", "resonant stiffness y"),
            unit="N/m",
            typical=lambda k, w: SHARE * k,
            words=lambda t: (
                f"a force of something that resonates at {t[FREQUENCY] / (2 * np.pi):.1f} Hz (damping ratio "
                f"{t[DAMPING]:.3f}), {_figure(t['resonant stiffness x'])} N/m along x and "
                f"{_figure(t['resonant stiffness y'])} N/m along y"
            ),
            textbook="a pedestal or bracket with a resonance",
        ),
        "tilt stiffness": LinearForce(
            unknowns=("tilt stiffness",),
            unit="N m/rad",
            matrix="K",
            patterns=(ALIKE,),
            tilts=True,
            typical=lambda k, w: SHARE * k * ARM**2,
            words=lambda t: f"a moment against the slope, {_figure(t['tilt stiffness'])} N m/rad",
            textbook="a bearing that resists tilt",
        ),
        "tilt damping": LinearForce(
            unknowns=("tilt damping",),
            unit="N m s/rad",
            matrix="C",
            patterns=(ALIKE,),
            tilts=True,
            typical=lambda k, w: SHARE * k * ARM**2 / w,
            words=lambda t: f"a moment against the change of the slope, {_figure(t['tilt damping'])} N m s/rad",
        ),
        "cubic stiffness": NonlinearForce(
            unknowns=("cubic stiffness",),
            unit="N/m^3",
            force=cubic,
            first=_cubic_first,
            typical=lambda k, w: SHARE * k / (5 * MOTION) ** 2,
            words=lambda t: (
                "a force against the motion that grows with the cube of its size, "
                f"{_figure(t['cubic stiffness'])} N/m^3"
            ),
            textbook="a spring that grows stiffer with deflection",
        ),
        "dry friction": NonlinearForce(
            unknowns=("friction",),
            unit="N",
            force=dry,
            first=_dry_first,
            typical=lambda k, w: SHARE * k * MOTION,
            words=lambda t: f"a force against the velocity, of the same size at any, {_figure(t['friction'])} N",
            textbook="dry friction",
        ),
    }
)
