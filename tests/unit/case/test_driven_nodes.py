# SPDX-License-Identifier: Apache-2.0
"""Prescribed displacements that drive nodes into a tool that stands are refused, in the plane and in space."""

from copy import deepcopy
from typing import Any

import pytest

from presswork.case import CaseError, build_model
from presswork.case.plane.schema import Case
from presswork.case.space.schema import SpaceCase
from tests.verification.test_wear import PLANE, SPACE, hold


def refuse(data: dict[str, Any]) -> str:
    kind = Case if data["analysis"] == "plane_strain" else SpaceCase
    with pytest.raises(CaseError) as error:
        build_model(kind.model_validate(data))
    return str(error.value)


@pytest.mark.parametrize(("case", "set_name", "along"), [(PLANE, "bottom", "y"), (SPACE, "top", "z")])
def test_a_set_that_is_driven_into_a_standing_tool_is_refused(case: dict[str, Any], set_name: str, along: str) -> None:
    data = deepcopy(case)
    data["stages"][0]["displacement"] = hold(set_name, "xyz" if case is SPACE else "xy", **{along: -0.01})
    text = refuse(data)
    assert "stages.0.displacement: drives" in text
    assert "into tools.die, at most 0.01 mm" in text
    assert "the other way, or less far" in text


def test_the_refused_set_driven_the_other_way_is_accepted() -> None:
    data = deepcopy(PLANE)
    data["stages"] = [{"name": "lift", "displacement": hold("bottom", "xy", y=0.01)}]
    build_model(Case.model_validate(data))


def test_nodes_that_slide_off_are_accepted() -> None:
    data = deepcopy(PLANE)
    data["stages"] = [{"name": "press", "displacement": hold("left", "x", x=0.01)}]  # along the die
    build_model(Case.model_validate(data))


def test_a_second_stage_that_goes_too_far_is_named() -> None:
    data = deepcopy(PLANE)
    data["stages"] = [
        {"name": "lift", "displacement": hold("bottom", "xy", y=0.5)},
        {"name": "press", "displacement": hold("bottom", "xy", y=-0.6)},
    ]
    assert "stages.1.displacement: drives 11 nodes into tools.die, at most 0.1 mm" in refuse(data)
