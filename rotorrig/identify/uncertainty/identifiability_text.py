"""Sentences on what a response cannot determine."""

import math
from collections.abc import Collection, Iterator

from rotorrig.identify.base_model import Reals
from rotorrig.identify.extended_model import ExtendedProblem
from rotorrig.identify.least_squares import Solution
from rotorrig.identify.uncertainty.identifiability import Coordinate, Identifiability, Weakness
from rotorrig.identify.uncertainty.settings import UNCERTAINTY


def describe_identifiability(
    best: Solution, problem: ExtendedProblem, able: Identifiability, *, unseen: str
) -> tuple[str, ...]:
    """Return sentences on parameters at a bound, undetermined, tied, or limited by the nameplate's tolerances.

    `unseen` names the axes no probe looks along.
    """
    base = problem.parameters.base
    unknowns = base.space.unknowns
    settled = {u.name for u in unknowns if any(axis in unseen for axis in u.axes)}
    sentences = [_unseen(axis, [u.name for u in unknowns if axis in u.axes]) for axis in unseen]
    at_bound = set(problem.parameters.at_bound(best.p))
    for i, unknown in enumerate(unknowns):
        if i in at_bound:
            value = base.values(best.p)[i]
            settled.add(unknown.name)
            sentences.append(
                f"{unknown.name} ran into its bound of {value:.3g} {unknown.unit}: this data does not give it."
            )
    for root, by_what in ((able.noise, "by this data"), (able.fitted, "within the tolerances of the nameplate")):
        for names, sentence in _weak(able, root, by_what, settled):
            settled.update(names)
            sentences.append(sentence)
    sentences += _describe_ties(able)
    if limited := _describe_limits(able, settled):
        sentences.append(limited)
    return tuple(sentences)


def _unseen(axis: str, names: list[str]) -> str:
    listed = _list(names) if names else f"what moves along {axis}"
    return f"No probe looks along {axis}: {listed} {_are(names)} not determined."


def _weak(
    able: Identifiability, root: Reals, by_what: str, settled: Collection[str]
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Say what is not determined, what only a combination of is, and what cannot be while those are not.

    `settled` are undetermined by what was said before.
    """
    coordinates = {c.name: c for c in able.coordinates}
    weak: list[tuple[str, ...]] = [(name,) for name in able.undetermined(root) if name not in settled]
    open_ = {*settled, *(names[0] for names in weak)}
    for weakness in able.weaknesses(root, known=open_):
        open_.update(weakness.names)
        if len(weakness.names) > 1:
            yield weakness.names, _inseparable([coordinates[n] for n in weakness.names], weakness, by_what)
        else:
            weak.append(weakness.names)
    for names in weak:
        way = _either_way(coordinates[names[0]], able.sigma(names[0], root))
        yield names, f"{names[0]} is not determined {by_what} ({way})."
    led = [name for name in able.names if name not in open_ and able.sigma(name, root) > UNCERTAINTY.determined]
    if led:
        yield tuple(led), f"While these are open, {_list(led)} {_are(led)} not determined {by_what} either."


def _inseparable(coordinates: list[Coordinate], weakness: Weakness, by_what: str) -> str:
    moves = [
        _describe_change(c, UNCERTAINTY.shown * change) for c, change in zip(coordinates, weakness.changes, strict=True)
    ]
    sentence = f"{_list(weakness.names)} cannot be separated {by_what}: {_list(moves)} at once would hardly show"
    if weakness.known_sigma < UNCERTAINTY.known:
        sentence += f"; {_combination(coordinates, weakness.known)} is known to {_percent(weakness.known_sigma)}"
    return f"{sentence}."


def _describe_ties(able: Identifiability) -> Iterator[str]:
    """Yield a sentence for every pair whose members are determined, but far better together."""
    weak = {name for name in able.names if able.sigma(name, able.fitted) > UNCERTAINTY.determined}
    correlation = able.correlation()
    for i, first in enumerate(able.coordinates):
        for k, second in enumerate(able.coordinates[:i]):
            if abs(correlation[i, k]) > UNCERTAINTY.inseparable and not weak & {first.name, second.name}:
                weights, sigma = able.combination((second.name, first.name), able.fitted)
                yield (
                    f"{second.name} and {first.name} are {abs(correlation[i, k]):.3f} correlated: "
                    f"{_combination([second, first], weights)} is known to {_percent(sigma)}, better than either."
                )


def _describe_limits(able: Identifiability, settled: Collection[str]) -> str:
    """Say which estimates the nameplate's tolerances limit, not the noise, but for those of which more was said."""
    limited = []
    for name, shares in able.budget().items():
        if name not in settled and shares["noise"] < 1 - UNCERTAINTY.limited:
            cause = max((kind for kind in shares if kind != "noise"), key=lambda kind: shares[kind])
            limited.append(f"{name} ({cause})")
    return (
        f"The tolerances in [prior] limit {_list(limited)}, not the noise: more data would not help." if limited else ""
    )


def _either_way(coordinate: Coordinate, sigma: float) -> str:
    if coordinate.logarithmic:
        return f"a factor of {math.exp(min(sigma, 20)):.2g} either way"
    if coordinate.unit == "rad":
        return f"± {math.degrees(min(sigma, math.pi)):.0f} degrees"
    return f"± {sigma * coordinate.reference:.2g} {coordinate.unit}"


def _describe_change(coordinate: Coordinate, change: float) -> str:
    way = "higher" if change > 0 else "lower"
    if coordinate.logarithmic:
        return f"{coordinate.name} {_percent(abs(change))} {way}"
    if coordinate.unit == "rad":
        return f"{coordinate.name} {math.degrees(abs(change)):.2g} degrees {way}"
    return f"{coordinate.name} {abs(change) * coordinate.reference:.2g} {coordinate.unit} {way}"


def _combination(coordinates: list[Coordinate], weights: Reals) -> str:
    """Return "kxx × u / cxx^0.97" of logarithms, else "ln(kxx) - 0.4 kxy/(3.4e+04 N/m)"."""
    kept = [(c, round(float(w), 2)) for c, w in zip(coordinates, weights, strict=True) if abs(w) >= 0.01]
    if all(c.logarithmic for c, _ in kept):
        factors = [f"{'/' if w < 0 else '×'} {c.name}{'' if abs(w) == 1 else f'^{abs(w):g}'}" for c, w in kept]
        above, below = ([f for f in factors if f[0] == sign] for sign in "×/")
        return " ".join([*above, *below]).removeprefix("× ")
    terms = [f"{'-' if w < 0 else '+'} {'' if abs(w) == 1 else f'{abs(w):g} '}{_term(c)}" for c, w in kept]
    return " ".join(terms).removeprefix("+ ")


def _term(coordinate: Coordinate) -> str:
    if coordinate.logarithmic:
        return f"ln({coordinate.name})"
    return f"{coordinate.name}/({coordinate.reference:.3g} {coordinate.unit})"


def _percent(relative: float) -> str:
    return f"{100 * relative:.2g} %"


def _are(names: Collection[str]) -> str:
    return "is" if len(names) == 1 else "are"


def _list(names: Collection[str]) -> str:
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last
