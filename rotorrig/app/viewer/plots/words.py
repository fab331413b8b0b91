"""Text that Rerun can display: characters missing from the viewer's font end it, so they are replaced."""

LATIN = (range(0x20, 0x7F), range(0xA0, 0x149), range(0x14A, 0x17F))
GREEK = (range(0x391, 0x3A2), range(0x3A3, 0x3CA))
CYRILLIC = (range(0x410, 0x450),)
SHOWN = (*LATIN, *GREEK, *CYRILLIC)
ALSO = frozenset("\n–—‘’“”•…−≤≥≈×±→")


def displayable(words: str) -> str:
    """Return words with "?" for every character the viewer could not draw.

    >>> displayable("1X of 12 µm ∠ 45°")
    '1X of 12 µm ? 45°'
    """
    return "".join(c if c in ALSO or any(ord(c) in block for block in SHOWN) else "?" for c in words)
