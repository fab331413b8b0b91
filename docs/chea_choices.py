"""docs/chea-choices.md: what the chapter leaves open or misprints, what was chosen, why, and where it stands in code.

Values come from the settings, so the page cannot say another than the code takes. Measured reasons stand beside the
code, in the docstring the last column leads to; this page does not repeat their figures.
"""

from dataclasses import dataclass
from pathlib import Path

from benchmarks.parts.identification.seed_stages import SETTINGS as TABLE6
from rotorrig.identify.base_model.settings import BASE_MODEL
from rotorrig.identify.chea import SEED
from rotorrig.identify.chea.steps.settings import STEPS

ROOT = Path(__file__).parents[1]
_CHEA = "rotorrig/identify/chea"
_GENETIC = f"{_CHEA}/chapter/genetic.py"
_CHAPTER = f"{_CHEA}/chapter/chapter.py"
_CLUSTERING = f"{_CHEA}/chapter/clustering.py"
_SETTINGS = f"{_CHEA}/chapter/settings.py"
_ENGINE = f"{_CHEA}/engine/engine.py"
_SQP = f"{_CHEA}/steps/sqp.py"
_STEPS = f"{_CHEA}/steps/settings.py"
_TABLE7 = "benchmarks/parts/identification/seed_table7.py"


@dataclass(frozen=True)
class Choice:
    """One row of the table; `names` are what to look for in the file."""

    chapter: str
    here: str
    because: str
    file: str
    names: tuple[str, ...]


_GENES = (
    Choice(
        '"length of chromosome 12" (Tables 1 and 6)',
        f"{SEED.bits} bits for each parameter: 12 for the two of Table 1",
        "12 bits each take more calls and solve less often; 12 for the five parameters of Table 6 would be a grid of "
        "five points each",
        _GENETIC,
        ("Colony",),
    ),
    Choice(
        "binary code not named",
        "Gray code, turned by a random number of grid points",
        "neighbours differ in one bit, plain binary has cliffs; unturned, the first bit mirrors about the middle of "
        "the box, an unfair advantage on symmetric functions",
        _GENETIC,
        ("_decode", "gray_to_integer"),
    ),
    Choice(
        "crossover 40 %, mutation 0.8 exp(-i/2): of what?",
        f"{SEED.crossover:.0%} of the pairs of parents, at one place; {SEED.mutation:g} exp(-i/2) of the children, "
        "one bit",
        "per bit, the first generation would be made anew and every generation would cost nearly 200 calls, more than "
        "the chapter reports",
        _GENETIC,
        ("_cross_over", "_mutate"),
    ),
    Choice(
        '"i: ith generation"',
        "the founders are the first generation, their children mutate with i = 2",
        "counted from zero the search takes more calls and solves no more",
        _GENETIC,
        ("_mutate", "generation"),
    ),
    Choice(
        "selection not named",
        f"tournaments of {SEED.tournament}, every individual in {SEED.tournament}",
        "with two the search takes more calls; with four fewer, but minima are lost sooner to higher selection",
        _GENETIC,
        ("_winners",),
    ),
    Choice(
        "elitism not named",
        "the best of all and of each cluster survive",
        "else a peak is lost by chance to another as high",
        _CHAPTER,
        ("_elites",),
    ),
    Choice(
        "calls for individuals met before not mentioned",
        "none",
        "their value is known",
        _GENETIC,
        ("_move_in",),
    ),
    Choice(
        "GA that never matures",
        f"ends after {SEED.max_generations} generations",
        "mutation has ended by then",
        _SETTINGS,
        ("max_generations",),
    ),
)

_CLUSTERS = (
    Choice(
        "individuals normalised to 0..1 (step 1)",
        "by the box of this run of the genetic algorithm",
        "in reduced bounds the clusters are told apart as in the whole box",
        _CHAPTER,
        ("gather",),
    ),
    Choice(
        'δ of eq. (1) a sum of squares, in the text an "average distance"',
        "the sum, as printed",
        "the equation is taken over the words",
        _CLUSTERING,
        ("cef",),
    ),
    Choice(
        "β of eq. (1) with one cluster, which has no neighbour",
        "the diagonal of the cube",
        "the largest possible distance; with the edge Rastrigin's function takes a few fewer calls, and as many runs "
        "succeed",
        _CLUSTERING,
        ("cef", "_nearest_centre"),
    ),
    Choice(
        "similarity of ART-KNN not defined",
        "1 - distance / diagonal of the cube",
        "a cluster near the origin is then like any other",
        f"{_CHEA}/chapter/art_knn.py",
        ("classify",),
    ),
    Choice(
        "order of presentation",
        "best individual first; at the end every point joins its nearest neuron",
        "the outcome depends on the order, so it must be fixed",
        _CHAPTER,
        ("_finite_best_first",),
    ),
    Choice(
        '"change similarity from 0.4 to 1.0"',
        ", ".join(f"{value:g}" for value in SEED.similarities),
        "at 1.0 every individual is its own cluster, and CEF is 0",
        _SETTINGS,
        ("similarities",),
    ),
    Choice(
        "clusters of one have no spread",
        f"classifications with fewer than {SEED.min_cluster_size:g} points per cluster on average are left out",
        "else 200 points in five dimensions count as mature before the first generation",
        _CLUSTERING,
        ("cluster",),
    ),
)

_DECISIONS = (
    Choice(
        "a lone cluster: its one local search agrees with itself",
        "it gets the additional searches too",
        "as Fig. 6 does",
        _ENGINE,
        ("_reduce",),
    ),
    Choice(
        '"several random points within each group"',
        f"{SEED.members}, beside the best; the first that disagrees decides",
        "Fig. 6 starts four, the text of Table 7 three; with one more as many runs succeed, at more calls",
        _SETTINGS,
        ("members",),
    ),
    Choice(
        '"nearly the same point"',
        f"within {SEED.same_point:g} of the box in every parameter",
        "searches of one minimum end far closer; those of the test functions are a tenth of the box apart and more",
        _SETTINGS,
        ("same_point",),
    ),
    Choice(
        "a local search on its way to a known minimum",
        f"ends within {SEED.same_point:g} of it",
        "the outcome is known; followed to the end, more calls in all",
        _CHAPTER,
        ("descend",),
    ),
    Choice(
        '"reduced bounds as those of each cluster"',
        "the cluster's points, and a tenth of their extent to each side",
        "the minimum need not lie between the individuals",
        _ENGINE,
        ("bounding_box",),
    ),
    Choice(
        '"until each cluster has only one local minimum"',
        f"at most {SEED.max_levels} levels, then `STALLED`",
        "a function with a minimum at every scale would never end",
        _SETTINGS,
        ("max_levels",),
    ),
)

_DESCENTS = (
    Choice(
        'SQP: "MATLAB program"',
        "written here: bounds are the only constraints, Powell's damped BFGS update",
        "finite differences can then be counted, batched and interrupted",
        _SQP,
        ("descend", "_update_bfgs"),
    ),
    Choice(
        "first step of SQP",
        f"{STEPS.first:g} of the box in the steepest parameter; then the curvature met on it for all",
        "a start is most often in its basin: a longer step would leave it",
        _STEPS,
        ("first",),
    ),
    Choice(
        "line search of SQP",
        f"weak Wolfe: {STEPS.sufficient:.0e} of the decrease promised, and a slope that has risen to {STEPS.risen:g} "
        f"of the first; a step too long is cut to {STEPS.shortening[0]:g} .. {STEPS.shortening[1]:g} of it, down to "
        f"{STEPS.shortest:.0e}; a turn of the slope within {STEPS.bracket:g} of the step is a kink",
        "f2 and f3 are sums of absolute values; decrease alone ends at their kinks",
        _SQP,
        ("_line_search",),
    ),
    Choice(
        "finite differences of SQP",
        f"forward, {STEPS.difference:g} of the box; {STEPS.difference_at_kinks:g} once a step leads to nothing lower "
        "though more was promised",
        "the longer ones are blind near a kink, where f2 of Table 7 still has to follow it toward the damping, and "
        "wrong where the curvature is f1's; the shorter ones cost digits on other ground",
        _SQP,
        ("gradient", "difference_at_kinks"),
    ),
    Choice(
        "tolerances of SQP",
        "1e-5 of the first slope, and a promised gain of 1e-10 of all gained; 400 steps",
        "a slope alone ends f1 of Table 7 where the stiffness is right and the damping, with 1e-6 of its curvature, "
        "is not",
        _SQP,
        ("descend", "tolerance", "max_steps"),
    ),
)

_REST = (
    Choice(
        "distances of the random search",
        f"Euclidean in the unit cube; the farthest of {SEED.far_candidates}, as printed",
        "parameters of different units have no common length",
        f"{_CHEA}/steps/far_search.py",
        ("farthest",),
    ),
    Choice(
        "random search after a local search was started (step 5)",
        "continues to the maximum number of iterations",
        "one better minimum does not exclude another",
        _CHAPTER,
        ("search_far",),
    ),
    Choice(
        "iterations of the random search: 400 in Table 1, 500 in Table 6",
        f"{SEED.far_iterations}; {TABLE6.far_iterations} for Table 7",
        "as printed",
        "benchmarks/parts/identification/seed_stages.py",
        ("far_iterations",),
    ),
    Choice(
        "scale of a variable; eq. (20) spans five to seven decades",
        'logarithmic in all five for Table 7, `x_scale="log"`',
        "on a linear scale the damping sought is 5e-5 of its range: less than one step of the genes",
        _TABLE7,
        ("x_scale",),
    ),
    Choice(
        "scale of a variable in `rotor identify --search seed`",
        "logarithmic, but for cross coefficients, which have either sign",
        "as for Table 7",
        "rotorrig/identify/base_model/unknowns.py",
        ("to_working",),
    ),
    Choice(
        "most calls",
        f"twice the chapter's for Table 7; {BASE_MODEL.black_box:,} in `rotor identify`",
        "the chapter's own flow chart has no limit, and a function of many minima would take days",
        _TABLE7,
        ("max_nfev",),
    ),
    Choice(
        "a function that fails",
        "a counted call with the value +inf",
        "a search does not end because one point has no response",
        f"{_CHEA}/session/record.py",
        ("failures",),
    ),
    Choice(
        "eqs. (2) and (4) as printed",
        "Rosenbrock's and Rastrigin's functions, with the square of x₁ and the x_i lost in print",
        "they have the stated minima",
        "benchmarks/parts/chea/functions.py",
        (),
    ),
)

SECTIONS: dict[str, tuple[Choice, ...]] = {
    "Genetic algorithm (2.1, Tables 1 and 6)": _GENES,
    "Clusters (2.2, 2.3, eq. 1)": _CLUSTERS,
    "Convexity and reduced bounds (2, Fig. 1)": _DECISIONS,
    "Local search (2.4)": _DESCENTS,
    "Random search, scale and the rest (2.5, 7.1)": _REST,
}


def text() -> str:
    """Return the page."""
    head = """# What the chapter leaves open, and what we chose

Written by `make docs` from docs/chea_choices.py and the settings of the code; do not edit.

One choice for every function: the test functions, Table 7 and its random truths all run with these. Figures that
speak for a choice stand in the docstring of the file named.
"""
    return "\n".join([head, *(f"## {title}\n\n{_table(rows)}\n" for title, rows in SECTIONS.items())])


def _table(rows: tuple[Choice, ...]) -> str:
    lines = ["| the chapter | here | because | in code |", "|---|---|---|---|"]
    lines += [f"| {row.chapter} | {row.here} | {row.because} | {_where(row)} |" for row in rows]
    return "\n".join(lines)


def _where(row: Choice) -> str:
    link = f"[{Path(row.file).name}](../{row.file})"
    return ", ".join([link, *(f"`{name}`" for name in row.names)])
