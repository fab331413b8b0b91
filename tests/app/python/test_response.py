"""A response in xarray, pandas, Parquet and MATLAB: the same numbers, with their units."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.io import loadmat

import rotorrig as rr
from rotorrig.processing import OrderTrackedResponse
from rotorrig.rig.config import RPM


@pytest.fixture
def seen(response: OrderTrackedResponse) -> rr.Response:
    return rr.Response.of(response)


def test_it_is_the_response_it_was_made_of(seen: rr.Response, response: OrderTrackedResponse) -> None:
    assert isinstance(seen, OrderTrackedResponse)
    assert seen.z is response.z and seen.runs == response.runs


def test_it_prints_in_a_few_lines_with_its_largest_vector(seen: rr.Response) -> None:
    lines = repr(seen).splitlines()
    assert len(lines) < 10
    assert "365 rows" in repr(seen)
    # the peak of the closed form is e / (2 zeta) = 187.5 um at the critical speed of 2230 rpm
    largest = next(line for line in lines if "largest 1X" in line)
    assert float(largest.split()[2]) == pytest.approx(187.5, rel=0.02)
    assert "um 0-peak at 22" in largest


def test_text_that_looks_like_html_is_text_in_a_notebook(seen: rr.Response) -> None:
    from dataclasses import replace

    nasty = replace(seen, source=replace(seen.source, source="<script>alert(1)</script>"))
    assert "<script>" not in nasty._repr_html_()
    assert "&lt;script&gt;" in nasty._repr_html_()


def test_the_dataset_has_every_vector_under_its_names_with_units(seen: rr.Response) -> None:
    data = seen.to_xarray()
    assert data.displacement.dims == ("speed", "probe", "order")
    assert data.displacement.attrs["units"] == "m" and data.speed.attrs["units"] == "rad s-1"
    row, probe = 100, seen.probes[1]
    value = data.displacement.sel(probe=probe, order=1.0)[row]
    assert complex(value) == seen.order(1.0)[row, 1]
    assert float(data.rpm[row]) == pytest.approx(seen.omega[row] * RPM)
    up = data.where(data.run == seen.runs[1].name, drop=True)
    assert up.sizes["speed"] == int(np.sum(seen.run == 1))
    compensated = (data.displacement - data.slow_roll).sel(order=1.0).values
    np.testing.assert_array_equal(compensated, seen.compensated(1.0))
    sigma = np.sqrt(seen.covariance[row, seen.orders.index(1.0), 2, 2])
    assert float(data.sigma.sel(probe=probe, order=1.0)[row]) == sigma


@pytest.mark.parametrize("compensated", [False, True])
def test_the_table_gives_the_vectors_back(seen: rr.Response, compensated: bool) -> None:
    table = seen.to_pandas(compensated=compensated)
    assert len(table) == seen.z.size
    part = table[(table.order == 1.0) & (table.probe == seen.probes[0])]
    z = part.amplitude_um.to_numpy() * 1e-6 * np.exp(-1j * np.radians(part.phase_lag_deg.to_numpy()))
    want = seen.compensated(1.0)[:, 0] if compensated else seen.order(1.0)[:, 0]
    np.testing.assert_allclose(z, want, rtol=1e-12, atol=1e-18)
    assert list(part.run.unique()) == [run.name for run in seen.runs]


def test_a_parquet_file_is_the_table(seen: rr.Response, tmp_path: Path) -> None:
    path = seen.to_parquet(tmp_path / "r.parquet", compensated=True)
    pd.testing.assert_frame_equal(pd.read_parquet(path), seen.to_pandas(compensated=True), check_dtype=False)


def test_a_matlab_file_holds_the_arrays_by_their_documented_names(seen: rr.Response, tmp_path: Path) -> None:
    arrays = loadmat(seen.to_mat(tmp_path / "r.mat"))
    np.testing.assert_array_equal(arrays["z"], seen.z)
    np.testing.assert_allclose(arrays["rpm"][:, 0], seen.omega * RPM)
    assert [str(name[0]) for name in arrays["probes"][:, 0]] == list(seen.probes)
    page = (Path(__file__).parents[3] / "docs/python.md").read_text()
    assert [name for name in arrays if not name.startswith("__") and f"`{name}`" not in page] == []


def test_a_file_that_cannot_be_written_is_said_in_a_sentence(seen: rr.Response, tmp_path: Path) -> None:
    for write in (seen.save, seen.to_parquet, seen.to_mat):
        with pytest.raises(rr.DataError, match="nowhere"):
            write(tmp_path / "nowhere" / "file")


def test_a_saved_response_is_read_back(seen: rr.Response, tmp_path: Path) -> None:
    again = rr.read(seen.save(tmp_path / "r.mcap"))
    assert isinstance(again, rr.Response)
    np.testing.assert_array_equal(again.z, seen.z)
