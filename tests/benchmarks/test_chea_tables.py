"""The tables beside the peers: what counts as a call, as a minimum, as a success; the keys of the JSON."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from benchmarks import chea_tables
from benchmarks.parts.chea import page
from benchmarks.parts.chea.counting import BudgetSpent, Counted
from benchmarks.parts.chea.functions import Listed, Problem, cases_beyond, chapter_cases, cube
from benchmarks.parts.chea.peers import METHODS, Found, Method, forward_differences
from benchmarks.parts.chea.score import count_minima, run, summarise

F1, F2, F3 = chapter_cases()[:3]
QUICK = [name for name in METHODS if name not in ("pycma BIPOP", "differential_evolution", "basinhopping")]


def bowl(x: np.ndarray) -> np.ndarray:
    return (x**2).sum(axis=1)


def saddle(x: np.ndarray) -> np.ndarray:
    return x[:, 0] ** 2 - x[:, 1] ** 2


def problem(fun) -> Problem:
    return Problem(fun=fun, bounds=cube(1.0, 2), minima=Listed(np.zeros((1, 2))), tolerance=np.full(2, 1e-3))


def answering(x: np.ndarray, *listed: list[float], calls: int = 1) -> Method:
    """A method that makes some calls and returns what it was told to."""

    def solve(fun, bounds, rng):
        for _ in range(calls):
            fun(np.array(x))
        return Found(np.array(x), np.array([x, *listed]))

    return Method(name="answering", solve=solve, settings="")


def test_every_value_of_a_batch_and_of_finite_differences_is_a_call() -> None:
    fun = Counted(bowl)
    assert fun(np.array([3.0, 4.0])) == 25.0
    fun.batch(np.ones((5, 2)))
    assert fun.calls == 6
    approx_fprime(np.ones(2), fun, 1e-8)  # two differences, and the value itself
    assert fun.calls == 9


def test_the_best_point_is_kept_and_no_call_goes_beyond_the_budget() -> None:
    fun = Counted(bowl, budget=3)
    fun(np.array([0.5, 0.0]))
    fun(np.array([2.0, 0.0]))
    with pytest.raises(BudgetSpent):
        fun.batch(np.zeros((2, 2)))
    assert (fun.calls, fun.best_x.tolist(), fun.best_fun) == (2, [0.5, 0.0], 0.25)


@pytest.mark.parametrize("name", METHODS)
def test_a_method_stays_within_its_budget_and_its_box(name: str) -> None:
    pytest.importorskip({"pycma BIPOP": "cma", "nlopt MLSL": "nlopt"}.get(name, "scipy"))
    seen: list[np.ndarray] = []
    fun = Counted(lambda x: seen.append(x.copy()) or F2.fun(x), budget=250)
    found = METHODS[name].run(fun, F2.bounds, np.random.default_rng(0))
    assert fun.calls == sum(map(len, seen)) <= 250
    assert (np.abs(np.concatenate(seen)) <= 1.0).all()
    assert found.x.shape == (2,) and found.listed.shape[1] == 2


@pytest.mark.parametrize("name", QUICK)
def test_a_method_finds_the_valley_of_the_chapters_first_function(name: str) -> None:
    pytest.importorskip({"nlopt MLSL": "nlopt"}.get(name, "scipy"))
    assert run(F1, METHODS[name], 0, budget=METHODS[name].budget).success


def test_forward_differences_turn_backward_at_the_upper_bound() -> None:
    seen: list[np.ndarray] = []
    fun = Counted(lambda x: seen.append(x) or bowl(x))
    x = np.array([1.0, 0.5])
    assert forward_differences(fun, x, 1.25, cube(1.0, 2)) == pytest.approx([2.0, 1.0], abs=1e-6)
    assert np.concatenate(seen).max() <= 1.0


def test_a_minimum_counts_once_and_other_points_do_not() -> None:
    twice = np.array([[1e-4, 0.0], [0.0, 5e-4], [0.3, 0.3]])
    assert count_minima(problem(bowl), twice) == 1
    assert count_minima(problem(bowl), np.array([[0.002, 0.0]])) == 0  # lower ground a tolerance away
    assert count_minima(problem(saddle), np.zeros((1, 2))) == 0
    assert count_minima(problem(saddle), np.array([[0.0, 1.0], [0.0, -1.0]])) == 2  # on the bounds


def test_success_is_the_best_point_within_the_tolerance_of_a_global_minimum() -> None:
    near, off = (run(F1, answering([1.0, 1.0 + d]), 0, budget=None) for d in (0.9e-3, 1.1e-3))
    assert near.success and not off.success
    assert near.found == 1.0 and off.found == 0.0
    assert near.offset == pytest.approx([0.0, 0.9e-3])


def test_all_globals_asks_for_every_one_of_them_in_the_list() -> None:
    peaks = [[a * 0.4388, b * 0.30585] for a in (1, -1) for b in (1, -1)]
    three, four = (run(F2, answering(*peaks[:n], calls=n), 0, budget=None) for n in (3, 4))
    assert (three.found, four.found) == (0.75, 1.0)
    score = summarise([three, four], F2)
    assert (score.success, score.all_globals, score.share, score.minima) == (1.0, 0.5, 0.875, 3.5)
    assert (score.calls, score.calls_median, score.calls_max) == (3.5, 3.5, 4)
    assert score.x == pytest.approx([0.4388, 0.30585])


def run_main(monkeypatch, capsys, *words: str) -> str:
    monkeypatch.setattr("sys.argv", ["chea_tables.py", "--workers", "1", *words])
    chea_tables.main()
    return capsys.readouterr().out


def test_json_has_the_agreed_keys_on_its_last_line_and_the_page_the_tables(monkeypatch, capsys, tmp_path) -> None:
    (tmp_path / "docs").mkdir()
    monkeypatch.setattr(chea_tables, "ROOT", tmp_path)
    missing = replace(METHODS["direct"], name="direct", package="no-such-package")
    monkeypatch.setattr(chea_tables, "PEERS", (METHODS["elitist GA"], missing))
    monkeypatch.setattr(chea_tables, "CHEA", tuple(replace(METHODS[name], budget=60) for name in ("modern", "seed")))
    out = run_main(monkeypatch, capsys, "--seeds", "1", "--json", "--write")
    assert "| direct" in out and "not installed" in out
    assert "\n".join(out.splitlines()[:-1]) in (tmp_path / "docs/chea-tables.md").read_text()
    found = json.loads(out.splitlines()[-1])
    functions = {"f1", "f2", "f3", "f1s", "f2s", "f3s", "f3r"}
    assert found.keys() == {"seed", "modern", "peers", "chapter", "niching"}
    for figures in (found["seed"], found["modern"], found["peers"]["elitist GA"]):
        assert figures.keys() == functions
        for figure in figures.values():
            assert {"calls", "success", "minima", "all_globals"} <= figure.keys()
            assert 0 <= figure["success"] <= 1 and 0 <= figure["all_globals"] <= 1
    assert set(found["peers"]["direct"].values()) == {None}
    assert found["chapter"]["CHEA"]["f3"]["calls"] == 2100
    assert {name: row["calls"] for name, row in found["chapter"]["EGA"].items()} == {"f1": 3183, "f2": 3014, "f3": 3131}


def test_no_peers_leaves_them_out_and_dimensions_adds_the_others(monkeypatch, capsys) -> None:
    some = [case for case in cases_beyond() if case.name in ("camel 2", "Levy 2")]
    for module in (chea_tables, page):
        monkeypatch.setattr(module, "chapter_cases", lambda: [F1])
        monkeypatch.setattr(module, "cases_beyond", lambda: some)
    monkeypatch.setattr(chea_tables, "CALLS_PER_DIMENSION", 50)
    words = ("--seeds", "1", "--json", "--no-peers", "--dimensions", "1")
    found = json.loads(run_main(monkeypatch, capsys, *words).splitlines()[-1])
    assert found["peers"] == {}
    assert found["dimensions"]["seed"].keys() == {"camel 2", "Levy 2"}
    assert found["dimensions"]["seed"]["Levy 2"]["calls"] == 100


def test_no_seeds_is_a_sentence(monkeypatch, capsys) -> None:
    with pytest.raises(SystemExit):
        run_main(monkeypatch, capsys, "--seeds", "0")
    assert "--seeds is 0, expected at least 1" in capsys.readouterr().err
