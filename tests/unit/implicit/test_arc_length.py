# SPDX-License-Identifier: Apache-2.0
"""The change of load that keeps an increment on its arc."""

import numpy as np
import pytest

from presswork.implicit.arc_length import _on_arc


def one_node(*translation: float) -> np.ndarray:
    return np.array([[*translation, 0.0, 0.0, 0.0]])


def test_the_load_that_goes_on_as_before_is_taken() -> None:
    """Both 0.5 and -1.5 of the load's answer (2, 0, 0) lead from (1, 0, 0) onto the arc of 2 mm."""
    change = _on_arc(one_node(1, 0, 0), one_node(0, 0, 0), one_node(2, 0, 0), 2.0)
    assert change == pytest.approx(0.5)


def test_where_no_load_leads_onto_the_arc_the_nearest_to_it_is_taken() -> None:
    """The correction is 3 mm across the load's answer, the arc 2 mm: what goes along the answer is taken back."""
    change = _on_arc(one_node(1, 0, 0), one_node(0, 3, 0), one_node(2, 0, 0), 2.0)
    assert change == pytest.approx(-0.5)
