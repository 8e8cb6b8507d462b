# SPDX-License-Identifier: Apache-2.0
"""Cases in space with several bodies: what is built, and what is refused before anything is computed."""

import copy

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.space.schema import SpaceCase
from presswork.outcome import StartError
from presswork.process.begin import check_start

STEEL = {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300, "modulus": 1000}}
CASE = {
    "title": "two blocks",
    "analysis": "solid",
    "workpiece": {"material": "steel", "mesh": {"size": [4, 4, 2], "cells": [2, 2, 1]}},
    "bodies": {"upper": {"material": "steel", "mesh": {"origin": [0, 0, 2], "size": [4, 4, 2], "cells": [3, 3, 2]}}},
    "contacts": {"joint": {"between": ["workpiece", "upper"], "contact": "coulomb", "mu": 0.1}},
    "materials": {"steel": STEEL},
    "boundary": {"floor": {"set": "back", "fix": ["x", "y", "z"]}},
    "stages": [{"name": "press", "displacement": [{"set": "upper.front", "component": "z", "value": -0.1}]}],
}


def change(**changes) -> SpaceCase:
    """Return the case with values replaced, their keys joined by two underscores."""
    case = copy.deepcopy(CASE)
    for key, value in changes.items():
        *path, last = key.split("__")
        table = case
        for name in path:
            table = table.setdefault(name, {})
        table[last] = value
    return SpaceCase(**case)


def problems(**changes) -> list[str]:
    with pytest.raises(CaseError) as error:
        build_model(change(**changes))
    return [f"{p.key}: {p.expected}; {p.remedy}" for p in error.value.problems]


def test_bodies_lie_in_one_mesh_with_sets_of_their_own() -> None:
    model = build_model(SpaceCase(**CASE))
    assert [body.name for body in model.bodies] == ["workpiece", "upper"]
    assert len(model.mesh.points) == 3 * 3 * 2 + 4 * 4 * 3
    assert set(model.mesh.face_sets) >= {"front", "upper.back"}
    assert np.all(model.mesh.points[model.mesh.node_sets["upper.back"], 2] == 2.0)
    assert model.contacts[0].slave == 1  # the finer one
    assert not model.solver.symmetric
    check_start(model)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        (
            {"bodies__upper__mesh": {"origin": [1, 1, 1.5], "size": [2, 2, 2], "cells": [2, 2, 2]}},
            "contacts.joint.between: workpiece and upper overlap at the start, by 0.5 mm at (2, 2, 2); move one",
        ),
        (
            {"bodies__upper__mesh": {"origin": [0, 0, 9], "size": [2, 2, 2], "cells": [2, 2, 2]}},
            "contacts.joint.between: workpiece and upper are 7 mm apart, farther than anything moves in this case",
        ),
        (
            {"contacts__joint__between": ["workpiece", "uper"]},
            "contacts.joint.between: no such body: uper; did you mean `upper`",
        ),
        ({"contacts": {}}, "bodies.upper: no contact names this body: it would touch nothing; add [contacts.NAME]"),
        ({"bodies__upper__material": "stel"}, "bodies.upper.material: no such material"),
        (
            {"bodies__upper__element": "tet4_mini"},
            "bodies.upper.element: hexahedra and tetrahedra do not go together in one case: the workpiece has",
        ),
        (
            {"tools__joint": {"shape": "plane", "contact": "sticking", "normal": [0, 0, 1], "position": [0, 0, -5]}},
            "contacts.joint: a tool has this name",
        ),
    ],
)
def test_faulty_bodies_are_refused_with_a_remedy(changes, fault) -> None:
    assert any(text.startswith(fault) for text in problems(**changes)), problems(**changes)


def test_new_meshes_have_sizes_for_each_body() -> None:
    tetrahedra = {"workpiece__element": "tet4_mini", "bodies__upper__element": "tet4_mini"}
    sizes = {"size": 0.9, "bodies": {"upper": {"size": 0.7, "smallest_size": 0.2, "quality": 0.1}}}
    found = build_model(change(remesh=sizes, **tetrahedra)).remeshing
    assert (found.of_body("workpiece").size, found.of_body("upper").size) == (0.9, 0.7)
    assert (found.of_body("upper").smallest_size, found.of_body("upper").quality) == (0.2, 0.1)
    sizes["bodies"]["upper"]["size"] = 5.0
    (text,) = problems(remesh=sizes, **tetrahedra)
    assert text.startswith("remesh.bodies.upper.size: size (5 mm) exceeds the least extent of the body")


def test_explicit_bodies_that_touch_get_new_meshes_but_for_one_that_touches_itself() -> None:
    stage = CASE["stages"][0] | {"duration": "80 us"}
    explicit = {"procedure": "explicit", "materials__steel": STEEL | {"density": 7.85e-9}, "stages": [stage]}
    nodal = {"workpiece__element": "tet4_nodal", "bodies__upper__element": "tet4_nodal"}
    found = build_model(change(remesh={}, **explicit, **nodal)).remeshing
    assert found is not None
    assert not found.obstacle
    itself = {"contacts__fold": {"between": ["upper", "upper"], "contact": "frictionless"}}
    assert any(
        text.startswith("contacts of a body with itself: does not go together with [remesh]")
        for text in problems(remesh={}, **explicit, **nodal, **itself)
    )


def test_explicit_hexahedra_are_told_which_cells_get_new_meshes() -> None:
    explicit = {"procedure": "explicit", "stages": [CASE["stages"][0] | {"duration": "80 us"}]}
    explicit |= {"workpiece__element": "hex8_1pt", "bodies__upper__element": "hex8_1pt"}
    found = problems(remesh={}, materials__steel=STEEL | {"density": 7.85e-9}, **explicit)
    assert any('new ones are made of tetrahedra; take element = "tet4_nodal"' in text for text in found), found


def test_explicit_bodies_need_density_and_elements_of_their_own() -> None:
    found = problems(procedure="explicit", bodies__upper__element="hex8_1pt", bodies__upper__velocity=[0, 0, -1e9])
    assert any(text.startswith("materials.steel.density: missing key; add it") for text in found), found
    dense = STEEL | {"density": 7.85e-9}
    found = problems(procedure="explicit", materials__steel=dense, bodies__upper__element="tet4_mini")
    assert any(text.startswith("bodies.upper.element: the explicit procedure has no such element") for text in found)
    found = problems(procedure="explicit", materials__steel=dense, bodies__upper__velocity=[0, 0, -1e9])
    assert any(text.startswith("bodies.upper.velocity: faster than sound in the material") for text in found), found


def test_a_body_that_nothing_holds_is_refused() -> None:
    # it touches the workpiece without friction, and may turn and slide on it
    model = build_model(change(contacts__joint={"between": ["workpiece", "upper"], "contact": "frictionless"}))
    with pytest.raises(StartError, match="nothing holds the body 'upper' against 3 rigid motions"):
        check_start(model)


def test_a_body_that_touches_nothing_is_refused() -> None:
    apart = {"origin": [0, 0, 2.05], "size": [4, 4, 2], "cells": [3, 3, 2]}
    model = build_model(change(bodies__upper__mesh=apart))
    with pytest.raises(StartError, match=r"nothing holds the body 'upper' .* no other body that is held touches it"):
        check_start(model)
