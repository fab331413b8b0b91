import numpy as np

from rotorrig.sims.plant.streams import stream


def test_the_same_seed_and_name_give_the_same_numbers() -> None:
    assert stream(3, "hum").random() == stream(3, "hum").random()


def test_another_name_or_seed_gives_others() -> None:
    assert len({stream(s, n).random() for s in (0, 1, 2) for n in ("hum", "track 0", "track 1")}) == 9


def test_another_run_gives_others_and_run_zero_is_the_rig_s_own() -> None:
    assert len({stream(3, "hum", run=run).random() for run in (0, 1, 2)}) == 3
    assert stream(3, "hum", run=0).random() == stream(3, "hum").random()
    assert stream(3, "hum", run=2).random() == stream(3, "hum", run=2).random()


def test_numbers_do_not_depend_on_the_pieces_they_are_drawn_in() -> None:
    """The plant's independence of block size rests on this."""
    whole = stream(1, "sensor noise").standard_normal((1000, 5))
    pieces = stream(1, "sensor noise")
    drawn = [pieces.standard_normal((n, 5)) for n in (1, 0, 7, 492, 500)]
    assert np.array_equal(np.concatenate(drawn), whole)
