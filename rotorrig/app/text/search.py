"""A global search in two lines: of what, how and how far; and what its stages did."""

from rotorrig.identify import Fit

_DID = {
    "gather": "gathered {calls}",
    "genetic": "{steps} generations of {calls}",
    "local": "{steps} local searches of {calls}",
    "breed": "bred {calls}",
    "far": "looked far away at {calls}",
    "polish": "polished with {calls}",
}
_HOW = {
    "vector": "by residuals and their derivatives",
    "modern": "by its value alone, with CHEA's profile modern",
    "seed": "by its value alone, with the chapter's algorithm",
}


def search_line(fit: Fit) -> str:
    """Return objective, way, calls, how it ended and the number of minima."""
    minima = f"{len(fit.optima)} significant minim{'um' if len(fit.optima) == 1 else 'a'}"
    how = _HOW[fit.trace.method]
    return f"{fit.objective} was searched {how}: {fit.evaluations} calls, {fit.stop}, {minima}."


def stages_text(fit: Fit) -> str:
    """Return "Calls: gathered 10, searched 3 clusters, ..": the calls of each stage, and what was decided."""
    trace = fit.trace
    did = [_DID[stage.name].format(steps=stage.steps, calls=stage.evaluations) for stage in trace.stages]
    clusters = len(trace.heads)
    decided = [f"searched {clusters} cluster{'s' * (clusters != 1)}"] if clusters else []
    if trace.reduced:
        decided.append(f"reduced the bounds to {trace.reduced} that were not convex")
    return f"Calls: {', '.join(did[:1] + decided + did[1:])}." if did else ""
