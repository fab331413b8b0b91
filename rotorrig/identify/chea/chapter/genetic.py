"""The genetic algorithm of section 2.1: 6-bit genes, tournament, one-point crossover, decaying mutation, elitism."""

import numpy as np
from numpy.typing import NDArray

from rotorrig.identify.chea.chapter.settings import SeedSettings
from rotorrig.identify.chea.session import Evaluations

Array = NDArray[np.float64]
Bits = NDArray[np.uint8]


class Colony:
    """A population of chromosomes in a box of the unit cube; `advance` makes the next generation.

    The chapter names crossover and mutation probabilities and is silent on the rest. Chosen here:

    - Six bits per parameter: Table 1's "length of chromosome 12" is read as that of the whole chromosome, of two
      parameters. (Table 6 repeats it for five, which would leave a grid of five points each.) On eqs. (2) to
      (4) a search then takes 1040, 1100 and 1500 calls, and 100 of 100 succeed; with 12 bits each 1220, 1120 and 1630,
      and 94 on eq. (4). The local searches refine the points anyway; a coarse grid is met again sooner.
    - Gray code: neighbouring grid points differ in one bit; plain binary has cliffs, the worst in the middle of the box
      (0111... to 1000...). In Gray code the first bit mirrors a parameter about the middle instead, which spreads
      copies over the peaks of a function symmetric there. So the code of each parameter is turned by a random number
      of grid points, once per colony, and no place in the box is special.
    - Probabilities are per pair and per individual. Flipping every bit with probability 0.8 exp(-1/2) would make the
      first generation anew, and evaluate nearly all of every generation: more calls than the chapter reports.
    - The founders are the first generation, so their children mutate with probability 0.8 exp(-2/2). With
      exp(-1/2) the search takes 6 to 7 % more calls and solves no more.
    - Tournaments of three, and every individual enters three: drawn at random, 5 % would never enter. With two the
      search takes 4 to 14 % more calls; with four 2 to 7 % fewer, but 96.5 rather than 98 % of 200 runs succeed on
      eq. (4) in shifted boxes (no more than chance could do; three keeps the variety).
    - Elitism is up to the caller, who knows the clusters: the best of each, see chapter.py.
    - A chromosome met before keeps its value and costs no call.
    """

    def __init__(self, box: Array, *, rng: np.random.Generator, settings: SeedSettings) -> None:
        self.generation = 1
        self._box = box  # (2, dim) lower and upper corner
        self._rng = rng
        self._settings = settings
        self._known: dict[bytes, float] = {}
        self._turn = rng.integers(0, 2**settings.bits, box.shape[1])

    def create_founders(self) -> Evaluations[None]:
        """Make the first generation."""
        shape = (self._settings.population, self._box.shape[1] * self._settings.bits)
        yield from self._move_in(self._rng.integers(0, 2, shape, dtype=np.uint8))

    def advance(self, elites: NDArray[np.intp] | None = None) -> Evaluations[None]:
        """Replace the population by its children; the `elites`, by default the best, survive in place of the worst."""
        self.generation += 1
        chosen = np.array([self.fun.argmin()]) if elites is None else elites
        survivors = self._bits[chosen]
        yield from self._move_in(self._mutate(self._cross_over(self._bits[self._winners()])))
        worst = np.argsort(-self.fun, kind="stable")[: len(survivors)]
        self._bits[worst] = survivors
        self._read_values()

    def _winners(self) -> NDArray[np.intp]:
        n = len(self.fun)
        entrants = np.array([self._rng.permutation(n) for _ in range(self._settings.tournament)])  # (tournament, n)
        return entrants[self.fun[entrants].argmin(axis=0), np.arange(n)]

    def _cross_over(self, parents: Bits) -> Bits:
        """Swap the tails of consecutive pairs beyond a random cut; tournament winners are already in random order."""
        pairs, length = len(parents) // 2, parents.shape[1]
        meets = self._rng.random(pairs) < self._settings.crossover
        cut = self._rng.integers(1, length, pairs)
        swap = (np.arange(length) >= cut[:, None]) & meets[:, None]
        first, second = parents[0 : 2 * pairs : 2], parents[1 : 2 * pairs : 2]
        children = parents.copy()
        children[0 : 2 * pairs : 2] = np.where(swap, second, first)
        children[1 : 2 * pairs : 2] = np.where(swap, first, second)
        return children

    def _mutate(self, children: Bits) -> Bits:
        probability = self._settings.mutation * np.exp(-self.generation / 2)  # Table 1
        chosen = np.flatnonzero(self._rng.random(len(children)) < probability)
        children[chosen, self._rng.integers(0, children.shape[1], len(chosen))] ^= 1
        return children

    def _move_in(self, bits: Bits) -> Evaluations[None]:
        new = {row.tobytes(): row for row in bits if row.tobytes() not in self._known}
        if new:
            values = yield self._decode(np.array(list(new.values())))
            self._known.update(zip(new, values.tolist(), strict=True))
        self._bits = bits
        self._read_values()

    def _read_values(self) -> None:
        self.points = self._decode(self._bits)  # (n, dim) in the unit cube
        self.fun = np.array([self._known[row.tobytes()] for row in self._bits])

    def _decode(self, bits: Bits) -> Array:
        codes = gray_to_integer(bits.reshape(len(bits), -1, self._settings.bits))
        grid = 2**self._settings.bits
        return self._box[0] + (codes + self._turn) % grid / (grid - 1) * (self._box[1] - self._box[0])


def gray_to_integer(bits: Bits) -> NDArray[np.int64]:
    """Return the numbers (...) of Gray-coded bits (..., bit), most significant first.

    >>> gray_to_integer(np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=np.uint8)).tolist()
    [0, 1, 2, 3]
    """
    binary = np.bitwise_xor.accumulate(bits, axis=-1)
    return binary.astype(np.int64) @ 2 ** np.arange(bits.shape[-1] - 1, -1, -1)
