"""`SeedSettings`: the control parameters of the search, with the values of the source's Tables 1 and 6.

The source is the chapter "A Hybrid Evolutionary Algorithm and its Application to Parameter Identification of Rolling
Elements Bearings"; equation, table and section numbers in this package are that chapter's.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SeedSettings:
    """Control parameters. Lengths are in the unit cube, where every parameter runs from 0 to 1."""

    # Table 1
    bits: int = 6  # per variable: Table 1's chromosome of 12 for two variables; see genetic.py
    population: int = 200
    crossover: float = 0.4  # probability that a pair of parents is crossed
    mutation: float = 0.8  # probability that one bit of a child flips: mutation * exp(-generation / 2), founders are 1
    cef_stop: float = 0.2
    weight_size: float = 0.9  # w_g, eq. (1)
    weight_distance: float = 1.5  # w_m
    weight_similarity: float = 0.9  # w_r
    far_iterations: int = 400  # Table 1; Table 6 has 500

    # Section 2.3: "change similarity from 0.4 ~ 1.0". 1.0 itself makes every individual its own cluster and CEF 0.
    similarities: tuple[float, ...] = (0.4, 0.5, 0.6, 0.7, 0.8, 0.9)

    # Sections 2 and 3: "additional local searches". Fig. 6 starts four in a cluster, Table 7's text three: the best and
    # two members. With three members as many runs succeed, at 3 to 5 % more calls.
    members: int = 2

    # Section 2.5
    far_candidates: int = 5

    # Silent in the source
    tournament: int = 3  # see genetic.py
    max_generations: int = 30  # mutation is 2e-7 by then, and the population a few copies
    min_cluster_size: float = 5.0  # on average; see clustering.py
    max_levels: int = 4  # how often a box may be reduced to a cluster's before giving up on telling its minima apart
    same_point: float = 0.01  # ends of local searches this close are one point; a descent that comes so close is over


#: The source's own parameters.
SEED = SeedSettings()
