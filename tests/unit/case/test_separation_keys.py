# SPDX-License-Identifier: Apache-2.0
"""What `[separation]` goes with: errors name the key, and what helps."""

import pytest

from presswork import build_model
from presswork.case.errors import CaseError
from tests.regression.test_separation_runs import STEEL, cropping


def refused(**changes):
    with pytest.raises(CaseError) as caught:
        build_model(cropping(**changes))
    return {problem.key: problem for problem in caught.value.problems}


def without(*keys):
    damage = {key: value for key, value in STEEL["damage"].items() if key not in keys}
    return {"steel": {**STEEL, "damage": damage}}


def test_separation_needs_the_explicit_procedure():
    problems = refused(procedure="implicit", explicit=None, output={"steps": 2})
    assert "cuts no cracks" in problems["separation"].expected


def test_separation_needs_new_meshes():
    assert "new mesh" in refused(remesh=None)["separation"].expected
    assert "new mesh" in refused(remesh={"enabled": False})["separation"].expected


def test_separation_needs_a_critical_damage():
    undamaged = {"steel": {key: value for key, value in STEEL.items() if key != "damage"}}
    assert "where a crack begins" in refused(materials=undamaged)["materials.steel.damage"].expected
    latham = {"steel": {**STEEL, "damage": {"criterion": "cockcroft_latham", "length": 0.1}}}
    assert "materials.steel.damage.critical" in refused(materials=latham)


def test_separation_does_not_go_with_pores():
    porous = {"steel": {**STEEL, "gtn": {"porosity": 0.002, "length": 0.2}}}
    assert "pores" in refused(materials=porous)["materials.steel.gtn"].expected


def test_cells_where_cracks_grow_fit_the_length():
    assert "too large" in refused(separation={"size": 0.15})["separation.size"].expected
    assert "remesh.smallest_size" in refused(separation={"size": 0.05})


def bed(edge):
    tools = cropping().model_dump(exclude_unset=True)["tools"]
    profile = [[edge, -8], {"to": [edge, 0], "radius": 0.15}, [9, 0]]
    return {name: tool | ({"profile": profile} if name == "bed" else {}) for name, tool in tools.items()}


@pytest.mark.parametrize("edge", [3.0, 2.9])
def test_tools_without_clearance_are_refused(edge):
    assert "no clearance to blade" in refused(tools=bed(edge))["tools.bed"].expected


def test_a_clearance_beyond_the_sheet_is_refused():
    wide = bed(5.2)
    del wide["clamp"]
    assert "exceeds the thickness of 2 mm" in refused(tools=wide)["tools.bed"].expected


def test_a_usual_clearance_is_taken():
    assert build_model(cropping(tools=bed(3.1))).separation is not None


def test_keys_reach_the_model():
    model = build_model(cropping(separation={"mu": 0.2, "size": 0.07}))
    assert model.separation is not None
    assert model.separation.size == 0.07
    (faces,) = model.contacts
    assert faces.mu == 0.2
    assert faces.by_itself
    assert faces.slave == faces.master
