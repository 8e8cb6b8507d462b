# SPDX-License-Identifier: Apache-2.0
"""The curves that the editor shows are those that the run will use."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case.material.forming_limit.build import build_curve
from presswork.case.material.library import find_sheet, list_keys
from presswork.server.material_curves import describe_material


@pytest.mark.parametrize("thickness", [0.8, "0.8 mm", 2.0])
def test_forming_limit_is_that_of_the_blank(thickness: float | str) -> None:
    found = describe_material({"name": "dc04", "own": None, "thickness": thickness})
    mm = float(str(thickness).removesuffix(" mm"))
    curve = build_curve(find_sheet("dc04").material, mm)
    assert found["limit"]["thickness"] == mm
    np.testing.assert_allclose(found["limit"]["major"], curve.limit(np.array(found["limit"]["minor"])))
    assert found["limit"]["margin"] == 0.1


@pytest.mark.validation
def test_every_sheet_of_the_library_with_a_limit_shows_it() -> None:
    for key in list_keys():
        material = find_sheet(key).material
        found = describe_material({"name": key})
        assert ("limit" in found) == (material.forming_limit is not None and bool(found)), key


@pytest.mark.parametrize("thickness", ["thin", -1, [], None, "1 kg"])
def test_bad_thickness_is_no_crash(thickness: object) -> None:
    found = describe_material({"name": "dc04", "thickness": thickness})
    assert found["stress"]


def test_own_material_has_its_own_curves() -> None:
    own = {
        "young": 70e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 400.0, "e0": 0.01, "n": 0.2},
        "forming_limit": {"law": "points", "points": [[-0.2, 0.4], [0.0, 0.2], [0.2, 0.3]]},
    }  # fmt: skip
    found = describe_material({"name": "mine", "own": own, "thickness": 1.0})
    assert found["stress"][0] == pytest.approx(400.0 * 0.01**0.2)
    assert min(found["limit"]["major"]) == pytest.approx(0.2)
    assert describe_material({"name": "mine", "own": {"young": 1}}) == {}
