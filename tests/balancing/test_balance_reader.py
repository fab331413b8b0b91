"""balance.json read back is the balance that was written."""

import json
from pathlib import Path

import numpy as np
import pytest

from rotorrig.balancing import Balance, Holes, Task, balance, read_balance, write_balance
from rotorrig.identify.identification import Identification
from rotorrig.processing.response import OrderTrackedResponse
from rotorrig.rig.errors import DataError


@pytest.fixture(scope="module")
def found(runs: list[OrderTrackedResponse], fit: Identification) -> Balance:
    """With all there is: a fit, holes, the least maximum, and the run after."""
    holes = {"disk": Holes(count=16, masses=(1e-4, 2e-4, 5e-4), radius=0.03, first=0.1)}
    task = Task(holes=holes, radii={"disk": 0.03}, min_max=True)
    return balance(runs[:2], task, identification=fit, after=runs[2])


def test_a_balance_is_read_as_it_was_written(found: Balance, tmp_path: Path) -> None:
    write_balance(tmp_path / "balance.json", found)
    again = read_balance(tmp_path / "balance.json")
    for name in ("planes", "radii", "conditions", "dof", "compensated", "left_out", "by", "grade", "source"):
        assert getattr(again, name) == getattr(found, name), name
    assert [c.by for c in again.corrections] == [c.by for c in found.corrections]
    assert np.allclose(again.chosen.half_widths, found.chosen.half_widths)
    assert again.mounted == pytest.approx(found.mounted)
    assert again.min_max == pytest.approx(found.min_max)
    assert again.determinacy.worst.amount == pytest.approx(found.determinacy.worst.amount)
    assert again.placing is not None and found.placing is not None
    assert (again.placing.holes, again.placing.filled) == (found.placing.holes, found.placing.filled)
    assert np.allclose(again.prediction.band, found.prediction.band, rtol=1e-5)
    assert again.comparison is not None and found.comparison is not None
    assert again.comparison.share == found.comparison.share


@pytest.mark.parametrize("missing", ["planes", "prediction", "grade"])
def test_a_file_that_lacks_a_part_is_one_sentence(found: Balance, tmp_path: Path, missing: str) -> None:
    path = tmp_path / "balance.json"
    write_balance(path, found)
    table = json.loads(path.read_text())
    del table[missing]
    path.write_text(json.dumps(table))
    with pytest.raises(DataError, match=f"balance.json: a part is missing or wrong .*{missing}"):
        read_balance(path)
