"""The ask/tell object: told in any portions, interrupted anywhere, resumed anywhere, it is the same search."""

import copy
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorrig.identify.chea import CheaResult, Search, StopReason, chea

BOX = [(-1.0, 1.0), (-1.0, 1.0)]

pytestmark = pytest.mark.parametrize("profile", ["seed", "modern"])


def peaks(x: np.ndarray) -> float:
    """Eq. (3) of the chapter: four global and four local minima."""
    u, v = np.pi * x
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))


def half_blind(x: np.ndarray) -> float:
    return peaks(x) if x[0] < 0.6 else float("nan")


def identical(one: CheaResult, other: CheaResult) -> bool:
    names = ("x", "fun", "xl", "funl", "hits", "history", "nfev", "njev", "nit", "nfail", "message", "stop_reason")
    return all(np.array_equal(one[name], other[name]) for name in names)


def finished(search: Search, fun=peaks) -> CheaResult:
    while not search.done:
        search.tell(fun(x) for x in search.ask())
    return search.result()


def told(profile: str, n: int) -> Search:
    """Return a search that was told n values."""
    search = Search(BOX, rng=1, profile=profile)
    while search.record.nfev < n:
        search.tell(peaks(x) for x in search.ask()[: n - search.record.nfev])
    return search


def test_by_hand_and_by_chea_the_search_is_the_same(profile: str) -> None:
    by_hand = finished(Search(BOX, rng=1, profile=profile))
    assert by_hand.stop_reason is StopReason.CONVERGED
    assert identical(by_hand, chea(peaks, BOX, rng=1, profile=profile))


def test_values_may_be_told_in_any_portions(profile: str) -> None:
    whole = finished(Search(BOX, rng=1, profile=profile))
    rng = np.random.default_rng(0)
    search = Search(BOX, rng=1, profile=profile)
    while not search.done:
        search.tell([peaks(x) for x in search.ask()[: rng.integers(0, 9)]])
    assert identical(search.result(), whole)


def test_asking_again_before_telling_gives_the_same_points(profile: str) -> None:
    search = Search(BOX, rng=1, profile=profile)
    first = search.ask()
    assert search.ask().tolist() == first.tolist()
    search.tell([1.0])
    assert search.ask().tolist() == first[1:].tolist()


def test_more_values_than_points_are_refused_and_nothing_is_taken_in(profile: str) -> None:
    search = Search(BOX, rng=1, profile=profile)
    n = len(search.ask())
    with pytest.raises(ValueError, match=rf"told {n + 1} values, expected at most {n}: one for each point asked for"):
        search.tell(np.zeros(n + 1))
    assert search.record.nfev == 0
    assert len(search.ask()) == n


def test_when_it_is_done_nothing_is_asked_and_nothing_may_be_told(profile: str) -> None:
    search = Search(BOX, rng=1, profile=profile)
    result = finished(search)
    assert search.ask().shape == (0, 2)
    search.tell([])
    assert search.done
    with pytest.raises(ValueError, match="told 1 values, expected at most 0"):
        search.tell([0.0])
    assert identical(search.result(), result)


def test_an_unfinished_search_says_so_and_lists_what_it_has(profile: str) -> None:
    result = told(profile, 7).result()
    assert result.stop_reason is StopReason.UNFINISHED
    assert result.nfev == 7
    assert not result.success


def test_an_error_while_the_values_are_made_leaves_the_search_as_it_was(profile: str) -> None:
    search = Search(BOX, rng=1, profile=profile)
    with pytest.raises(ZeroDivisionError):
        search.tell(1 / (x[0] - x[0]) for x in search.ask().tolist())
    assert search.record.nfev == 0


def test_resumed_after_any_number_of_calls_it_ends_bit_for_bit_as_if_never_stopped(profile: str) -> None:
    whole = chea(half_blind, BOX, rng=1, profile=profile)
    assert whole.nfail > 0
    for n in np.random.default_rng(0).integers(1, whole.nfev, 4).tolist():
        calls = 0

        def interrupted(x: np.ndarray, n: int = n) -> float:
            nonlocal calls
            calls += 1
            if calls > n:
                raise KeyboardInterrupt
            return half_blind(x)

        cut = chea(interrupted, BOX, rng=1, profile=profile)
        assert (cut.stop_reason, cut.nfev) == (StopReason.INTERRUPTED, n)
        state = pickle.loads(pickle.dumps(cut.state))
        assert identical(chea(half_blind, resume=state), whole)


def test_resumed_again_and_again_it_is_still_the_same_search(profile: str) -> None:
    whole = chea(peaks, BOX, rng=1, profile=profile)
    result = chea(peaks, BOX, rng=1, profile=profile, max_nfev=1)
    while not result.success:
        result = chea(peaks, resume=result.state, max_nfev=result.nfev + whole.nfev // 4)
    assert identical(result, whole)


@pytest.mark.campaign
def test_a_fresh_process_resumes_it_too(profile: str, tmp_path: Path) -> None:
    whole = finished(Search(BOX, rng=1, profile=profile))
    search = told(profile, whole.nfev // 2)
    before, after, script = tmp_path / "before.pickle", tmp_path / "after.pickle", tmp_path / "resume.py"
    before.write_bytes(pickle.dumps(search))
    script.write_text(f"""
import pickle
from pathlib import Path
import numpy as np

def peaks(x):
    u, v = np.pi * x
    return (np.cos(2 * u) + np.cos(2.5 * u) - 2.1) * (2.1 - np.cos(3 * v) - np.cos(3.5 * v))

search = pickle.loads(Path({str(before)!r}).read_bytes())
while not search.done:
    search.tell([peaks(x) for x in search.ask()])
Path({str(after)!r}).write_bytes(pickle.dumps(search.result()))
""")
    subprocess.run([sys.executable, script], check=True, timeout=60)
    assert identical(pickle.loads(after.read_bytes()), whole)


def test_ctrl_c_within_the_searchs_own_code_loses_nothing(profile: str) -> None:
    whole = chea(peaks, BOX, rng=1, profile=profile)
    _, lines = _lines_of_the_search(lambda: chea(peaks, BOX, rng=1, profile=profile, max_nfev=whole.nfev // 2))
    for line in np.random.default_rng(0).integers(lines // 50, lines, 4).tolist():
        cut, _ = _lines_of_the_search(lambda: chea(peaks, BOX, rng=1, profile=profile), interrupt_at=line)
        assert cut.stop_reason is StopReason.INTERRUPTED
        assert cut.history[:, 0].max() <= cut.nfev
        assert identical(chea(peaks, resume=cut.state), whole)


def test_resuming_leaves_the_state_as_it_was(profile: str) -> None:
    state = told(profile, 30).state
    first = chea(peaks, resume=state)
    assert len(state.values) == 30
    assert identical(chea(peaks, resume=state), first)


def test_what_the_caller_draws_from_his_generator_in_between_changes_nothing(profile: str) -> None:
    rng = np.random.default_rng(1)
    cut = chea(peaks, BOX, rng=rng, profile=profile, max_nfev=30)
    rng.random(100)
    assert identical(chea(peaks, resume=cut.state), chea(peaks, BOX, rng=1, profile=profile))


def test_a_search_that_ended_is_resumed_without_a_call(profile: str) -> None:
    whole = chea(peaks, BOX, rng=1, profile=profile)
    assert identical(chea(None, resume=whole.state), whole)


def test_a_target_met_before_is_met_without_a_call(profile: str) -> None:
    cut = chea(peaks, BOX, rng=1, profile=profile, max_nfev=30)
    again = chea(None, resume=cut.state, f_target=cut.fun)
    assert again.stop_reason is StopReason.TARGET
    assert again.nfev == 30


def test_the_callback_is_shown_a_state_to_keep(profile: str) -> None:
    states = []
    whole = chea(peaks, BOX, rng=1, profile=profile, callback=lambda shown: states.append(shown.state))
    for state in (states[0], states[-1]):
        assert identical(chea(peaks, resume=state), whole)


def test_a_pickle_takes_eight_bytes_per_evaluation(profile: str) -> None:
    sizes = [len(pickle.dumps(told(profile, n))) for n in (10, 110)]
    assert sizes[1] - sizes[0] < 100 * 8 + 20
    assert sizes[0] < 2000


def test_a_copy_goes_its_own_way(profile: str) -> None:
    search = told(profile, 30)
    branch = copy.deepcopy(search)
    whole = finished(branch)
    assert search.record.nfev == 30
    assert identical(finished(search), whole)


def test_a_state_of_another_version_is_refused(profile: str) -> None:
    state = told(profile, 60).state
    other = replace(state, seed=(1, 2, 3, 4))  # stands for a version that would have asked for other points
    with pytest.raises(ValueError, match="begun by another version of the algorithm, and cannot be resumed"):
        Search.resume(other)


def _lines_of_the_search(act, *, interrupt_at: int = 0):
    """Return what `act` returns and how many lines of the search it ran, with Ctrl-C before one of them if wanted."""
    lines = 0

    def trace(frame, event, argument):
        nonlocal lines
        lines += event == "line"
        if lines == interrupt_at > 0:
            sys.settrace(None)
            raise KeyboardInterrupt
        own = "/rotorrig/identify/chea/" in frame.f_code.co_filename
        return trace if own and frame.f_code.co_name not in ("chea", "__init__", "__exit__") else None

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        return act(), lines
    finally:
        sys.settrace(before)
