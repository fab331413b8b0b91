"""Parameters of tests whose every case takes seconds."""

from collections.abc import Iterable
from typing import Any

import pytest


def defer_rest(values: Iterable[Any], *, now: int = 1) -> list[Any]:
    """Return the parameters with all but the first `now` left to `make test-all`; a tuple is of several names."""
    every = list(values)
    later = (value if isinstance(value, tuple) else (value,) for value in every[now:])
    return [*every[:now], *(pytest.param(*value, marks=pytest.mark.campaign) for value in later)]
