"""The triangular factor by which a linear model is solved."""

import numpy as np
import pytest

from rotorrig.identify.chea.residuals.linear_model import triangular_factor


@pytest.mark.parametrize("near", [0.5, 1e-7, 0.0])
def test_columns_that_are_alike_have_the_triangle_of_their_products(near: float) -> None:
    columns = np.array([[1.0, 1.0], [0.0, near], [0.0, 0.0]])
    columns /= np.linalg.norm(columns, axis=0)
    root, onto = triangular_factor(columns)
    np.testing.assert_allclose(root.T @ root, columns.T @ columns, atol=1e-15)
    inside, across = columns @ [2.0, -3.0], np.array([0.0, 0.0, 4.0])
    np.testing.assert_allclose(root.T @ onto(inside + across), columns.T @ inside, atol=1e-12)
    assert np.linalg.norm(onto(across)) < 1e-12
