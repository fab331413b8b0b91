"""docs/api.md: what `import rotorrig as rr` gives, read from the code's own signatures and docstrings."""

import inspect
import re
from types import FunctionType
from typing import Any

from rotorrig.app import python
from rotorrig.app.lab import query
from rotorrig.app.python.plots import ResponsePlots

HEAD = """# `import rotorrig as rr`

Written by `make docs` from the code itself; do not edit. The [how-to](python.md) says what it is for. Everything is in
SI unless a name says otherwise; amplitudes are 0-peak, phases lag ([conventions](conventions.md)). What a user can get
wrong raises `rr.DataError` or `rr.ConfigError`, both `rr.RigError`, with one sentence.
"""
FUNCTIONS = (
    python.read,
    python.simulate,
    python.track,
    python.identify,
    python.diagnose,
    python.balance,
    python.predict,
    python.report,
    query,
)
CLASSES = (
    python.Recording,
    python.Response,
    ResponsePlots,
    python.Identification,
    python.Diagnosis,
    python.Balance,
    python.Prediction,
    python.Rotor,
)


def text() -> str:
    """Return the whole page."""
    parts = [_function(f"rr.{each.__name__}", each) for each in FUNCTIONS]
    return "\n".join([HEAD, *parts, *(_class(each) for each in CLASSES)])


def _class(each: type) -> str:
    name = "response.plot" if each is ResponsePlots else f"rr.{each.__name__}"
    lines = [f"## {name}", "", _words(each), ""]
    for key, member in vars(each).items():
        if not key.startswith("_") and (kind := _kind(member)):
            lines.append(f"- `{kind(key)}` {' '.join(_words(_function_of(member)).split())}")
    return "\n".join(lines) + "\n"


def _kind(member: Any) -> Any:
    """Return how a member is written, given its name; None for one that is not documented."""
    if isinstance(member, property):
        return lambda key: f".{key}"
    if isinstance(member, (FunctionType, classmethod)):
        function = _function_of(member)
        return lambda key: f"{'' if isinstance(member, classmethod) else '.'}{key}{_signature(function)}"
    return None


def _function_of(member: Any) -> Any:
    return member.fget if isinstance(member, property) else getattr(member, "__func__", member)


def _function(name: str, function: Any) -> str:
    return f"## {name}\n\n```python\n{name}{_signature(function)}\n```\n\n{_words(function)}\n"


def _signature(function: Any) -> str:
    """Return the parameters with their defaults, types left out: the docstring says what they take."""
    signature = inspect.signature(function)
    plain = [p.replace(annotation=p.empty) for p in signature.parameters.values() if p.name not in ("self", "cls")]
    return re.sub(r"\s+", " ", str(signature.replace(parameters=plain, return_annotation=signature.empty)))


def _words(thing: Any) -> str:
    return inspect.cleandoc(thing.__doc__ or "")
