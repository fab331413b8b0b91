"""A search in words."""

from dataclasses import replace

from rotorrig.app.text import search_line, stages_text
from rotorrig.identify.identification import Identification, SearchTrace


def test_a_search_says_of_what_how_and_how_far_it_went(identification: Identification) -> None:
    assert search_line(identification.fits[0]) == (
        "f1 was searched by its value alone, with the chapter's algorithm: "
        "4321 calls, converged, 1 significant minimum."
    )


def test_its_stages_say_what_each_did_and_what_was_decided(identification: Identification) -> None:
    fit = identification.fits[0]
    assert stages_text(fit) == (
        "Calls: 11 generations of 1500, searched 2 clusters, reduced the bounds to 1 that were not convex, "
        "9 local searches of 2421, looked far away at 400."
    )


def test_of_an_older_file_nothing_is_known(identification: Identification) -> None:
    assert stages_text(replace(identification.fits[0], trace=SearchTrace())) == ""
