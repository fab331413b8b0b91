"""Named random streams: every random quantity of a plant draws from its own generator, made from seed and name.

Adding a quantity, or drawing one in larger blocks, leaves all others as they were. What differs from run to run of one
rig, its noise, also takes the number of the run.
"""

import zlib

import numpy as np


def stream(seed: int, name: str, *, run: int = 0) -> np.random.Generator:
    """Return the generator of the quantity called `name` in the plant of that seed, in run `run` of it."""
    return np.random.default_rng([seed, zlib.crc32(name.encode()), *([run] if run else [])])
