"""The pictures of docs/chea.md, and Fig. 3 of docs/chapter.md, from runs of the search. All randomness is seeded."""

from docs.chapter_network import network
from docs.chea_gathering import generations, maturity, operators, similarities
from docs.chea_searching import descents, far_search
from docs.chea_whole_runs import modern, six_panels
from docs.svg_plot import Figure


def pictures() -> dict[str, Figure]:
    """Return every picture by its file name."""
    return {
        "chapter-fig3.svg": network(),
        "chea-operators.svg": operators(),
        "chea-generations.svg": generations(),
        "chea-maturity.svg": maturity(),
        "chea-art-knn.svg": similarities(),
        "chea-sqp.svg": descents(),
        "chea-far-search.svg": far_search(),
        "chea-fig6.svg": six_panels(),
        "chea-modern.svg": modern(),
    }
