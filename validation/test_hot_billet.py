# SPDX-License-Identifier: Apache-2.0
"""Temperatures of a hot billet between dies against CalculiX."""

import pytest

from validation.hot_billet_calculix import compare, has_calculix

pytestmark = pytest.mark.validation


@pytest.mark.skipif(not has_calculix(), reason="CalculiX (ccx) is not installed: nothing to compare with")
def test_a_barrelled_billet_cools_as_in_calculix() -> None:
    """Within 0.1 % of the difference to the die at the middle, the side, the face and the rim."""
    for place, (own, other) in compare().items():
        assert own - 200 == pytest.approx(other - 200, rel=2e-3), place
