"""Parameters to the unit cube and back, each on a linear or a logarithmic scale."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import Bounds

Array = NDArray[np.float64]
Box = Bounds | Sequence[ArrayLike] | Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Scaling:
    """The map between a box of parameters and the unit cube."""

    lower: Array  # (dim,)
    upper: Array  # (dim,)
    log: NDArray[np.bool_]  # (dim,) True: logarithmic

    @property
    def dim(self) -> int:
        """Number of parameters."""
        return len(self.lower)

    def to_parameters(self, u: Array) -> Array:
        """Return the parameters (..., dim) of points of the unit cube, never outside the bounds by rounding.

        >>> scaling = from_bounds([(1.0, 100.0), (0.0, 2.0)], ("log", "linear"))
        >>> scaling.to_parameters(np.array([0.5, 0.5])).round(9).tolist()
        [10.0, 1.0]
        """
        low, high = self._ends()
        s = low + u * (high - low)
        x = np.where(self.log, np.exp(np.where(self.log, s, 0.0)), s)
        x = np.where(u == 0.0, self.lower, np.where(u == 1.0, self.upper, x))
        return np.clip(x, self.lower, self.upper)

    def _ends(self) -> tuple[Array, Array]:
        low, high = (np.where(self.log, np.log(np.where(self.log, end, 1.0)), end) for end in (self.lower, self.upper))
        return low, high


def from_bounds(bounds: Box, x_scale: str | Sequence[str]) -> Scaling:
    """Return the `Scaling` of (dim, 2) bounds or a scipy `Bounds`; `x_scale` is "linear", "log" or one per parameter.

    Raises ValueError on bounds that are not finite, not ascending, or not positive where the scale is logarithmic.
    """
    pairs = _pairs(bounds)
    scales = [x_scale] * len(pairs) if isinstance(x_scale, str) else list(x_scale)
    if len(scales) != len(pairs) or not set(scales) <= {"linear", "log"}:
        raise ValueError(f"x_scale is {x_scale!r}, expected 'linear' or 'log', or one of them for each of {len(pairs)}")
    for i, ((low, high), scale) in enumerate(zip(pairs.tolist(), scales, strict=True)):
        if not (np.isfinite([low, high]).all() and low < high):
            raise ValueError(f"bounds[{i}] is ({low:g}, {high:g}), expected finite ends, the lower one first")
        if not np.isfinite(high - low):
            raise ValueError(f"bounds[{i}] is ({low:g}, {high:g}), expected ends whose difference is finite")
        if scale == "log" and low <= 0:
            raise ValueError(f"bounds[{i}] starts at {low:g}, expected a positive end for a logarithmic scale")
    return Scaling(lower=pairs[:, 0], upper=pairs[:, 1], log=np.array([scale == "log" for scale in scales]))


def _pairs(bounds: Box) -> Array:
    try:
        ends = np.column_stack([bounds.lb, bounds.ub]) if isinstance(bounds, Bounds) else bounds
        pairs = np.array(ends, dtype=np.float64)
    except ValueError as error:
        raise ValueError(f"bounds are no numbers: {error}") from None
    if pairs.ndim != 2 or pairs.shape[1] != 2 or len(pairs) == 0:
        raise ValueError(f"bounds has shape {pairs.shape}, expected (dim, 2): a lower and an upper end per parameter")
    return pairs
