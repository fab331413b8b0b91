"""The pictures of chea.md, drawn from runs of the search: `python docs/make_chea_pictures.py`.

docs/img/chea-*.svg. The same on every run: all randomness is seeded.
"""

from pathlib import Path

from chea_gathering import generations, maturity, operators, similarities
from chea_searching import descents, far_search
from chea_whole_runs import modern, six_panels

IMAGES = Path(__file__).parent / "img"


def main() -> None:
    """Draw every picture."""
    IMAGES.mkdir(exist_ok=True)
    pictures = {
        "operators": operators,
        "generations": generations,
        "maturity": maturity,
        "art-knn": similarities,
        "sqp": descents,
        "far-search": far_search,
        "fig6": six_panels,
        "modern": modern,
    }
    for name, draw in pictures.items():
        draw().save(IMAGES / f"chea-{name}.svg")


if __name__ == "__main__":
    main()
