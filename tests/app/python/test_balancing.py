"""`rr.balance` and `rr.predict`: the same figures as the commands', as tables and in words."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rotorrig as rr
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.config.description import RigConfig
from tests.balancing.fits import fit_from, three_runs
from tests.identify.swept import U


@pytest.fixture(scope="module")
def runs(rig_config: RigConfig) -> list[OrderTrackedResponse]:
    return three_runs(rig_config)


@pytest.fixture(scope="module")
def fit(runs: list[OrderTrackedResponse]) -> Identification:
    return fit_from(runs[:1])


def test_a_balance_says_what_to_mount(runs: list[OrderTrackedResponse], fit: Identification, tmp_path: Path) -> None:
    paths = [str(rr.Response.of(run).save(tmp_path / f"{i}.mcap")) for i, run in enumerate(runs)]
    found = rr.balance(paths[:2], identification=fit, after=paths[2])
    table = found.to_pandas()
    assert table["by"].tolist()[:2] == ["influence coefficients", "fitted model"]
    assert table["amount_gmm"].to_numpy() == pytest.approx(abs(U) * 1e6, rel=0.02)
    assert table["angle_deg"].to_numpy() == pytest.approx(np.degrees(np.angle(-U)) % 360, abs=1.0)
    off = (table["amount_gmm"] - abs(U) * 1e6).abs() / table["amount_half95_gmm"]
    assert (off[table["by"] != "to mount"] < 2).all()
    assert found.comparison and found.comparison.share > 0.9
    assert repr(found).startswith("Balance: masses to add, from the mark in the sense of rotation\n  disk ")
    assert "fitted model agree" in repr(found) and "ISO 21940-11" in found._repr_html_()
    back = rr.read(found.save(tmp_path / "balance.json"))
    assert isinstance(back, rr.Balance)
    pd.testing.assert_frame_equal(back.to_pandas(), table, rtol=1e-12)  # the file has amount and angle


def test_masses_and_holes_are_texts_as_the_command_takes_them(runs: list[OrderTrackedResponse]) -> None:
    found = rr.balance(runs[:2], holes=16, masses="100 mg, 0.2 g", radius="30 mm", speeds="1500 to 2000 rpm")
    assert found.placing and "g into hole" in repr(found)
    with pytest.raises(rr.ConfigError, match="holes"):
        rr.balance(runs[:2], holes=16)


def test_a_prediction_is_a_table(runs: list[OrderTrackedResponse], fit: Identification) -> None:
    mass = f"disk: {abs(U) * 1e6:.6g} g mm at {np.degrees(np.angle(-U)) % 360:.6g} deg"
    found = rr.predict(runs[0], identification=fit, masses=mass)
    table = found.to_pandas()
    assert table["after_um"].max() < 0.1 * table["before_um"].max()
    assert (table["after_low95_um"] <= table["after_um"]).all()
    measured = runs[2].order(1.0) - runs[2].slow_roll[:, runs[2].orders.index(1.0)]
    inside = 0
    for k, name in enumerate(runs[2].probes):
        rows = table[(table["probe"] == name) & (table["direction"] == "up")]
        up = runs[2].run == 0
        amplitude = np.interp(rows["speed_rpm"], runs[2].omega[up] * 30 / np.pi, np.abs(measured[up, k]) * 1e6)
        inside += np.mean((amplitude > rows["after_low95_um"]) & (amplitude < rows["after_high95_um"]))
    assert inside / len(runs[2].probes) > 0.8
    assert "1x" in repr(found) and "rpm" in found._repr_html_()
    with pytest.raises(rr.ConfigError, match="masses: none was given"):
        rr.predict(runs[0], identification=fit, masses=[])
