# SPDX-License-Identifier: Apache-2.0
"""Materials of a model."""

import numpy as np
import pytest

from presswork import _core
from presswork.law.elastic_plastic import make_hardening
from presswork.model import Hardening

PARAMETERS = {
    "yield_stress": 200.0, "saturation_stress": 350.0, "K": 600.0, "modulus": 80.0, "e0": 0.01, "n": 0.25, "rate": 9.0,
    "exponent": 0.8, "voce_share": 0.4,
}  # fmt: skip
TABLES = {
    "table": [0.0, 180.0, 0.2, 300.0, 1.0, 420.0],
    "monotone_table": [0.0, 180.0, 900.0, 0.2, 300.0, 300.0, 1.0, 420.0, 50.0],
}
LAWS = [law.name for law in _core.HardeningLaw if not _core.is_hot(law)]


@pytest.mark.parametrize("law", LAWS)
def test_a_hardening_law_is_scaled_as_a_whole(law):
    names = _core.parameter_names(_core.HardeningLaw[law])
    given = TABLES[law] if names == ["points"] else [PARAMETERS[name] for name in names]
    hardening, eqps = Hardening(law, np.array(given)), np.array([0.0, 1e-3, 0.1, 0.5, 2.0])
    laws = [_core.VonMises(2e5, 0.3, *make_hardening(own)) for own in (hardening, hardening.scale(3.0))]
    (flow, slope), (scaled, scaled_slope) = (own.flow_stress(eqps) for own in laws)
    np.testing.assert_allclose(scaled, 3.0 * flow, rtol=1e-13)
    np.testing.assert_allclose(scaled_slope, 3.0 * slope, rtol=1e-7)  # steep at 0: round-off
