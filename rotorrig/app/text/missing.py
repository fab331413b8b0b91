"""A missing force in words."""

from collections.abc import Iterator

from rotorrig.identify.discovery import MissingForce


def missing_lines(missing: MissingForce) -> Iterator[str]:
    """Yield where it acts and how it goes, what has such a law, and what explains nearly as much."""
    yield f"{missing.words[:1].upper()}{missing.words[1:]}."
    if missing.like:
        yield f"Such a law has {'; or '.join(missing.like)}. That is no name of a cause: it says what to look for."
    for rival in missing.rivals:
        yield f"Nearly as good, {rival.evidence:.0f} of BIC behind: {rival.words}."
