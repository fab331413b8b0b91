"""A row says what the catalogue says of a run, and nothing of what is not known."""

from pathlib import Path
from typing import Any

from rotorrig.app.lab.page.catalogue import read_catalogue
from rotorrig.app.lab.page.runs import row_of_run
from tests.app.lab.page.catalogue_maker import FIRST_DAY, estimate, write_run


def row(lab: Path, **tables: Any) -> dict[str, Any]:
    write_run(lab, "a/run.mcap", **tables)
    catalogue = read_catalogue(lab)
    return row_of_run(catalogue, catalogue.runs[0], report=None, bode=None)


def test_a_failed_run_has_its_sentence_and_no_values(tmp_path: Path) -> None:
    found = row(tmp_path, runs={"sentence": "keyphasor: 3 edges in 41 s, want one per turn"})
    assert found["sentence"] == "keyphasor: 3 edges in 41 s, want one per turn"
    assert (found["status"], found["step"], found["file"]) == ("failed", "track", "a/run.mcap")
    assert found["t"] == FIRST_DAY.timestamp() * 1000
    assert not {"kxx", "critical", "residual", "verdict", "report", "bode", "causes"} & set(found)


def test_the_first_bearing_and_the_first_disk_stand_in_the_table_by_name(tmp_path: Path) -> None:
    found = row(
        tmp_path,
        estimates=[
            estimate("left kxx", 30_000.0, 300.0, "N/m", 33_900.0, fit="480 to 1500 rpm"),
            estimate("left kxx", 31_000.0, 300.0, "N/m", 33_900.0),
            estimate("right kxx", 32_000.0, 300.0, "N/m", 33_900.0),
            estimate("u disk 2", 2e-5, 1e-7, "kg m", 1e-5),
            estimate("left cxx", 15.0, 99.0, "N s/m", 15.0, determined=False),
        ],
    )
    assert found["kxx"] == [31.0, 0.3, "left kxx"]  # of the whole sweep
    assert found["u"] == [20.0, 0.1, "u disk 2"]
    assert "cxx" not in found
    assert found["undetermined"] == ["left cxx"]


def test_a_run_fitted_in_bands_alone_shows_the_first(tmp_path: Path) -> None:
    kxx = {"sigma": 300.0, "unit": "N/m", "nameplate": 33_900.0}
    bands = [estimate("kxx", 3e4, fit="low", **kxx), estimate("kxx", 4e4, fit="high", **kxx)]
    assert row(tmp_path, estimates=bands)["kxx"] == [30.0, 0.3]


def test_the_critical_speed_is_that_of_the_largest_peak(tmp_path: Path) -> None:
    peaks = [
        {
            "run": "up",
            "probe": "2x",
            "critical_speed_rpm": 3000.0,
            "peak_um": float("nan"),
            "amplification_factor": 1.0,
        },
        {"run": "up", "probe": "1x", "critical_speed_rpm": 2240.0, "peak_um": 180.0, "amplification_factor": 12.0},
        {"run": "down", "probe": "1y", "critical_speed_rpm": 2225.0, "peak_um": 190.0, "amplification_factor": 12.5},
    ]
    found = row(tmp_path, peaks=peaks)
    assert (found["critical"], found["q"], found["peak"], found["where"]) == (2225.0, 12.5, 190.0, "1y down")


def test_causes_are_those_chosen_in_their_words(tmp_path: Path) -> None:
    causes = [
        {"rank": 1, "label": "bow", "words": "the shaft is bowed by 21 µm", "chosen": True},
        {"rank": 2, "label": "rub", "words": "", "chosen": True},
        {"rank": 3, "label": "crack", "words": "the shaft is cracked", "chosen": False},
    ]
    assert row(tmp_path, causes=causes)["causes"] == ["the shaft is bowed by 21 µm", "rub"]
