"""The same rotor turned the other way: the transposed one, under loads that run the other way round.

With the shaft's angle theta falling, a load fixed to the shaft, Re(F e^{j theta}), is Re(conj(F) e^{j |theta|}). The
rotor it meets obeys reciprocity: at one frequency, Z for the speed -Omega is the transpose of Z for Omega. What is
symmetric belongs to springs, masses and dampers, which have no sense of rotation; what is skew, gyroscopic and
circulatory terms, is there because the shaft turns, and turns over with it. In a mirror such a rotor turns as before.

So no effect has to know of it: unbalance and bow are fixed to the shaft, kxy = kyx to the ground, and kxy = -kyx,
internal damping and gyroscopic moments follow the sense of rotation. A film of oil under a steady load is not of that
kind: its kxy + kyx turns over as well. Source: Casimir, On Onsager's principle of microscopic reversibility, Rev. Mod.
Phys. 17 (1945) 343.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from rotorrig.sims.rotor.model.assembly import Added, RotorModel
from rotorrig.sims.rotor.model.bearing import BearingAttachment
from rotorrig.sims.rotor.model.derivatives import Direction
from rotorrig.sims.rotor.model.loads import Load


def reverse_rotor(model: RotorModel) -> RotorModel:
    """Return the rotor as it is when it turns the other way, its angle counted upwards again."""
    more = model.added
    return replace(
        model,
        rotation=-model.rotation,  # turns the gyroscopic matrix of shaft and disks over
        bearings=tuple(_reverse_bearing(bearing) for bearing in model.bearings),
        added=Added(
            M=_transpose(more.M),
            C=_transpose(more.C),
            G=_transpose(more.G),
            K=_transpose(more.K),
            H=_transpose(more.H),
            S=_transpose(more.S),
            T=None if more.T is None else more.T.conj(),
        ),
    )


def reverse_load(load: Load) -> Load:
    """Return a load that is fixed to the shaft as the rotor feels it when it turns the other way."""
    return replace(load, pattern=load.pattern.conj())


def reverse_direction(direction: Direction) -> Direction:
    """Return the derivative of the reversed rotor's matrices."""
    M, C, G, K, H, S, T, P = direction
    return Direction(M=M.T, C=C.T, G=G.T, K=K.T, H=np.transpose(H), S=np.transpose(S), T=np.conj(T), P=P)


def _reverse_bearing(bearing: BearingAttachment) -> BearingAttachment:
    return replace(bearing, stiffness=bearing.stiffness.swapaxes(1, 2), damping=bearing.damping.swapaxes(1, 2))


def _transpose(A: NDArray | None) -> NDArray | None:
    return None if A is None else A.T
