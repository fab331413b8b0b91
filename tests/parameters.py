"""Parameters of tests whose every case takes seconds."""

from collections.abc import Iterable
from typing import Any

import pytest


def few(values: Iterable[Any], *, now: int = 1) -> list[Any]:
    """Return them with all but the first `now` left to `make test-all`: those do something of their own seldom."""
    every = list(values)
    later = [
        pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=pytest.mark.campaign)
        for value in every[now:]
    ]
    return [*every[:now], *later]
