"""`make docs`, or `python -m docs.make_docs`: every generated page and every picture that is drawn in seconds.

Their tests make them again and compare. What takes minutes, a browser or a viewer has a script of its own: `COSTLY`.
"""

from collections.abc import Mapping
from pathlib import Path

from docs import (
    api_reference,
    chea_choices,
    chea_figures,
    chea_pictures,
    chea_table7_page,
    cli_reference,
    config_reference,
    conventions_drawing,
    effect_pictures,
    lab_page,
    plant_page,
    tracking_drawing,
    wiring_drawing,
)
from docs.svg_plot import Figure

DOCS = Path(__file__).parent
IMAGES = DOCS / "img"

#: picture -> the command that makes it, from the top of the repository; each file says in itself what it was made from
COSTLY: Mapping[str, str] = {
    "chapter-fig13.svg": "python -m docs.make_chapter",
    "chapter-fig14.svg": "python -m docs.make_chapter",
    "chapter-fig4.svg": "python -m docs.make_chapter",
    "chapter-fig8.svg": "python -m docs.make_chapter",
    "chapter-fig9.svg": "python -m docs.make_chapter",
    "chea-table7-f1.svg": "python -m docs.make_chea_table7",
    "chea-table7-f2.svg": "python -m docs.make_chea_table7",
    "chea-table7-f3.svg": "python -m docs.make_chea_table7",
    "demo.png": "python -m docs.make_pictures demo",
    "discovery.png": "python -m docs.make_discovery",
    "lab-page.png": "python -m docs.make_pictures demo",
    "live.png": "python -m docs.make_pictures demo",
    "measured-run-up.svg": "python -m docs.make_measured_run_up",
    "tutorial-balance.png": "python -m docs.make_tutorial",
    "tutorial-gain.svg": "python -m docs.make_tutorial",
    "tutorial-report.png": "python -m docs.make_tutorial",
}


def pictures() -> dict[str, Figure]:
    """Return every picture that is drawn in seconds, by its file name in docs/img."""
    return {
        **conventions_drawing.pictures(),
        **wiring_drawing.pictures(),
        **effect_pictures.pictures(),
        **chea_pictures.pictures(),
        "tracking-windows.svg": tracking_drawing.windows(),
    }


def pages() -> dict[str, str]:
    """Return every page that is generated, or in part, by its file name in docs."""
    return {
        "api.md": api_reference.text(),
        "config.md": config_reference.text(),
        "cli.md": cli_reference.text(),
        "chea.md": chea_figures.shown((DOCS / "chea.md").read_text(encoding="utf-8")),
        "chea-choices.md": chea_choices.text(),
        "chea-table7.md": chea_table7_page.text(),
        "effects.md": effect_pictures.shown((DOCS / "effects.md").read_text(encoding="utf-8")),
        "lab.md": lab_page.shown((DOCS / "lab.md").read_text(encoding="utf-8")),
        "plant.md": plant_page.shown((DOCS / "plant.md").read_text(encoding="utf-8")),
    }


def main() -> None:
    """Write them all."""
    for name, figure in pictures().items():
        figure.save(IMAGES / name)
    for name, text in pages().items():
        (DOCS / name).write_text(text, encoding="utf-8")
        print(f"{DOCS / name}: written")


if __name__ == "__main__":
    main()
