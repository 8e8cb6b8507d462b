# SPDX-License-Identifier: Apache-2.0
"""Forming and heat together against CalculiX, and why its own coupled procedure is no truth for large strains."""

import pytest

from validation.coupled_billet_calculix import measure_squeezed_bar, run_calculix, run_presswork
from validation.hot_billet_calculix import has_calculix

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(not has_calculix(), reason="CalculiX (ccx) is not installed: nothing to compare with"),
]


def test_a_billet_softer_where_it_is_hot_is_upset_as_in_calculix() -> None:
    """Temperatures within 1 % of the difference to the die at middle, side, face and rim, the force within 0.1 %."""
    (own, own_force), (other, other_force) = run_presswork(), run_calculix()
    for place, degrees in own.items():
        assert degrees - 200 == pytest.approx(other[place] - 200, rel=1e-2), place
    assert own_force == pytest.approx(other_force, rel=1e-3)


def test_the_coupled_procedure_of_calculix_conducts_on_the_body_as_it_was() -> None:
    """A bar squeezed to a half at constant volume conducts four times the heat; CalculiX gives what it did at rest."""
    assert measure_squeezed_bar(0.5) == pytest.approx(1.0, rel=1e-3)
