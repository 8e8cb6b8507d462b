# SPDX-License-Identifier: Apache-2.0
"""Heat between solids in space and rigid tools: a slice against plane strain, chilling against two half-spaces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model
from presswork.case.description import describe
from presswork.case.space.schema import SpaceCase
from presswork.implicit.heat_of_forming import HeatArrays
from presswork.implicit.stepping import ImplicitProcedure
from presswork.process.tool_quantities import measure_tools

STEEL = {"conductivity": 30.0, "specific_heat": "650 J/(kg*K)", "density": "7800 kg/m^3"}
HEAT = {
    "initial_temperature": 1100.0,
    "surroundings": {"ambient": 20.0, "emissivity": 0.8, "coefficient": "10 W/(m^2*K)"},
}
RUBS = {"contact": "shear", "m": 0.3}
CONDUCTS = {"conductance": [[0, "2 kW/(m^2*K)"], [100, "10 kW/(m^2*K)"]], "gap": 0.2, "temperature": 200.0}


def in_space(die: dict[str, Any], anvil: dict[str, Any], stage: dict[str, Any], **workpiece: Any) -> SpaceCase:
    """A slice 15 x 1 x 10 mm of a block that lies on an anvil."""
    mesh = {"size": [15, 1, 10], "cells": [12, 1, 10]}
    return SpaceCase.model_validate(
        {
            "title": "hot",
            "analysis": "solid",
            "workpiece": {"material": "c45", "mesh": mesh, **workpiece},
            "materials": {"c45": {"library": "c45"}},
            "heat": HEAT,
            "tools": {
                "die": {"shape": "plane", "normal": [0, 0, -1], "position": [0, 0, 10], **die},
                "anvil": {"shape": "plane", "normal": [0, 0, 1], **anvil},
            },
            "boundary": {
                name: {"set": name, "fix": [axis]} for name, axis in (("left", "x"), ("bottom", "y"), ("top", "y"))
            },
            "stages": [{"name": "press", **stage}],
        }
    )


def in_plane(die: dict[str, Any], anvil: dict[str, Any], stage: dict[str, Any]) -> Case:
    return Case.model_validate(
        {
            "title": "hot",
            "analysis": "plane_strain",
            "workpiece": {"material": "c45", "mesh": {"size": [15, 10], "cells": [12, 10]}},
            "materials": {"c45": {"library": "c45"}},
            "heat": HEAT,
            "tools": {
                "die": {"profile": [[0, 10], [60, 10]], **die},
                "anvil": {"profile": [[60, 0], [0, 0]], **anvil},
            },
            "boundary": {"left": {"set": "left", "fix": ["x"]}},
            "stages": [{"name": "press", **stage}],
        }
    )


def run(case: Any) -> tuple[np.ndarray, ImplicitProcedure]:
    """Return the force of the die over parts of the stage, and the procedure at its end."""
    procedure = ImplicitProcedure(build_model(case))
    rows = [(r.fraction, measure_tools(procedure, 0)["die"].force) for r in procedure.advance()]
    part, force = np.array(rows).T
    return np.interp(np.linspace(0.2, 1.0, 5), part, force), procedure


def check_balance(procedure: ImplicitProcedure) -> np.ndarray:
    """Check that the heat that came in is stored, and return it by kind."""
    assert procedure.heat is not None
    arrays, forming = procedure.state[HeatArrays], procedure.heat.forming
    assert forming.stored(arrays) == pytest.approx(arrays.heat.sum(), rel=1e-8)
    return np.asarray(arrays.heat)


@pytest.mark.parametrize("steel", [{}, {**STEEL, "warms_up": True}], ids=["constant", "warms up"])
def test_a_hot_slice_is_upset_as_in_plane_strain(steel: dict[str, Any]) -> None:
    """30 % in 0.3 s between tools at 200 degrees: forces and temperatures within 1 %.

    They differ by 8 K beside the rim, where the side rolls over onto the tool a little earlier, by 1.5 K elsewhere.
    """
    hot = {**RUBS, "heat": {**CONDUCTS, **steel}}
    ours, space = run(in_space(hot, hot, {"duration": 0.3, "tools": {"die": {"stroke": 3, "direction": [0, 0, -1]}}}))
    theirs, plane = run(in_plane(hot, hot, {"duration": 0.3, "tools": {"die": {"stroke": 3, "direction": [0, -1]}}}))
    np.testing.assert_allclose(ours, theirs, rtol=1e-2)
    front = space.model.mesh.points[:, 1] < 1e-9
    own, other = space.model.mesh.points[front][:, [0, 2]], plane.model.mesh.points
    match = [int(np.abs(other - p).sum(axis=1).argmin()) for p in own]
    here, there = space.state[HeatArrays].temperature[front], plane.state[HeatArrays].temperature[match]
    assert there.min() < 950.0
    np.testing.assert_allclose(here, there, rtol=1e-2)
    assert np.abs(here - there)[own[:, 0] < 12.0].max() < 0.005 * (1100.0 - there.min())
    heat, same = check_balance(space), check_balance(plane)
    np.testing.assert_allclose(heat[:3], same[:3], rtol=1e-2, err_msg="plastic, friction, tools")
    np.testing.assert_allclose(heat[3:], same[3:], rtol=3e-2, err_msg="convection, radiation: 0.5 % of the tools' part")


def test_a_chilled_face_cools_as_a_half_space_on_another() -> None:
    """1200 on 200 degrees, 10 kW/(m2 K): the surface at 0.1 and 1 s (Carslaw & Jaeger 1959)."""
    cold = {
        "contact": "frictionless",
        "heat": {"conductance": "10 kW/(m^2*K)", "temperature": 200.0, **STEEL, "warms_up": True},
    }
    given = in_space(cold, {"contact": "frictionless"}, {"duration": 1.0, "tools": {"die": {"move": [0, 0, -1e-3]}}})
    data = given.model_dump(exclude_unset=True)
    elastic = {"young": 200e3, "poisson": 0.0, "density": STEEL["density"]}
    elastic["hardening"] = {"law": "linear", "yield_stress": 1e3, "modulus": 0.0}
    data["materials"] = {"c45": {**elastic, "thermal": {k: STEEL[k] for k in ("conductivity", "specific_heat")}}}
    data["workpiece"]["mesh"] = {"size": [1, 1, 20], "cells": [1, 1, 60], "grading": [1, 1, 0.05]}
    data["tools"]["die"]["position"] = [0, 0, 20]
    data["heat"] = {"initial_temperature": 1200.0}
    data["stages"] = [  # hardly pressed
        {"name": name, "duration": t, "tools": {"die": {"move": [0, 0, -1e-4]}}} for name, t in (("a", 0.1), ("b", 0.9))
    ]
    procedure = ImplicitProcedure(build_model(SpaceCase.model_validate(data)))
    surface = {}
    for report in procedure.advance():
        surface[report.stage] = procedure.state[HeatArrays].temperature[procedure.model.mesh.points[:, 2] > 20 - 1e-9]
    np.testing.assert_allclose(surface["a"], 1004.59, atol=4.0)
    np.testing.assert_allclose(surface["b"], 851.37, atol=4.0)
    check_balance(procedure)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"heat": {**CONDUCTS, **STEEL, "mesh": {"size": 1, "depth": 5}}},
            r"tools\.die\.heat\.mesh: tools have meshes in the plane",
        ),
        ({"heat": {**CONDUCTS, "warms_up": True}}, "needs a steel"),
        ({"heat": {**CONDUCTS, "gap": -1}}, "gap"),
    ],
)
def test_heat_of_tools_that_means_nothing_is_refused(change: dict[str, Any], said: str) -> None:
    with pytest.raises(CaseError, match=said):
        build_model(in_space({**RUBS, **change}, RUBS, {"duration": 1, "tools": {"die": {"move": [0, 0, -1]}}}))


def test_tools_with_heat_are_told_in_words() -> None:
    hot = {**RUBS, "heat": {**CONDUCTS, **STEEL, "warms_up": True}}
    words = describe(build_model(in_space(hot, RUBS, {"duration": 1, "tools": {"die": {"move": [0, 0, -1]}}})))
    assert "heat passes into die at 200 °C, which warms up behind the nodes that touch it" in words
