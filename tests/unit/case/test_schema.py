# SPDX-License-Identifier: Apache-2.0
"""The schema: the same names in TOML and in Python, overrides, defaults of the Model, the JSON schema."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from presswork import model
from presswork.case import (
    Boundary,
    Case,
    CaseError,
    Linear,
    Material,
    Output,
    ProfilePoint,
    Rectangle,
    Solver,
    Stage,
    Terms,
    Tool,
    ToolMotion,
    Workpiece,
    json_schema,
)
from presswork.case.space.schema import SpaceSolver
from presswork.case.stamping.schema import Implicit, StampingOutput

WriteCase = Callable[..., Path]


def case_in_python(**changes: Any) -> Case:
    values: dict[str, Any] = {
        "title": "A small upsetting",
        "analysis": "axisymmetric",
        "workpiece": Workpiece(
            material="steel", element="tri3", mesh=Rectangle(size=(10, 15), cells=(2, 3), pattern="crossed")
        ),
        "materials": {
            "steel": Material(young=200e3, poisson=0.3, hardening=Linear(yield_stress=700, modulus=300)),
        },
        "tools": {"punch": Tool(profile=(ProfilePoint(to=(0, 15)), ProfilePoint(to=(30, 15))), contact="sticking")},
        "boundary": {"axis": Boundary(set="left", fix=("x",)), "middle_plane": Boundary(set="bottom", fix=("y",))},
        "stages": (Stage(name="upset", tools={"punch": ToolMotion(stroke=9.0, direction=(0, -1))}),),
    }
    return Case(**{**values, **changes})


def test_toml_and_python_give_the_same_case(write_case: WriteCase) -> None:
    assert Case.from_toml(write_case()).model_dump() == case_in_python().model_dump()


def test_case_built_in_python_raises_case_error() -> None:
    with pytest.raises(CaseError, match=r"case: analysis = \"3d\": unknown choice"):
        case_in_python(analysis="3d")


def test_case_is_frozen() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        case_in_python().title = "another"  # type: ignore[misc]


def test_case_keeps_the_text_and_the_overrides(write_case: WriteCase) -> None:
    path = write_case()
    case = Case.from_toml(path, ["title=short"])
    assert tomllib.loads(case.text) == {**tomllib.loads(path.read_text()), "title": "short"}
    assert case.source == path


def test_override_values_are_toml_or_strings(write_case: WriteCase) -> None:
    overrides = [
        "workpiece.mesh.cells=[30, 40]",
        "stages.0.tools.punch.stroke=5",
        "materials.steel.young=70 GPa",
        "solver.line_search=false",
    ]
    case = Case.from_toml(write_case(), overrides)
    assert isinstance(case.workpiece.mesh, Rectangle)
    assert case.workpiece.mesh.cells == (30, 40)
    assert case.stages[0].tools["punch"].stroke == 5.0
    assert case.materials["steel"].young == pytest.approx(70e3)
    assert case.solver.line_search is False


def test_an_override_without_a_value_removes_a_key(write_case: WriteCase) -> None:
    whole = Case.from_toml(write_case())
    assert {"axis", "middle_plane"} <= set(whole.boundary)
    cut = Case.from_toml(write_case(), ["boundary.middle_plane=", "solver.line_search=false", "solver.line_search="])
    assert set(cut.boundary) == set(whole.boundary) - {"middle_plane"}
    assert cut.solver == whole.solver
    assert Case.from_toml(write_case(), ['title=""']).title == ""


@pytest.mark.parametrize(
    ("override", "fragments"),
    [
        ("solver.line_serch=false", ["solver.line_serch", "did you mean `line_search`?"]),
        ("stages.3.name=x", ["stages.3.name", "a list of 1", "`3` is not an index"]),
        ("title.x=1", ["title.x", "`title` is a value, not a table"]),
        ("title", ["`title` is not of the form", "--set key=value"]),
        ("solver.line_search=", ["solver.line_search", "no such key to remove"]),
        ("boundary.middle_plan=", ["boundary.middle_plan", "did you mean `middle_plane`?"]),
        ("stages.1=", ["stages.1", "no such key to remove"]),
    ],
)
def test_bad_override_is_named(write_case: WriteCase, override: str, fragments: list[str]) -> None:
    with pytest.raises(CaseError) as caught:
        Case.from_toml(write_case(), [override])
    assert [fragment for fragment in fragments if fragment not in str(caught.value)] == [], str(caught.value)


@pytest.mark.parametrize(
    ("part", "data"),
    [(Solver, model.SolverSettings), (Output, model.OutputSettings), (Terms, model.TangentTerms)],
)
def test_settings_have_the_names_and_defaults_of_the_model(part: type[BaseModel], data: type) -> None:
    names = [field.name for field in dataclasses.fields(data)]
    if part is Solver:
        # of sheets between tools and of solids in space, so keys of those
        for name, owner in (("contact_stiffness", Implicit), ("linear_solver", SpaceSolver)):
            names.remove(name)
            assert name in owner.model_fields
    if part is Output:
        names.remove("dynain")  # of stampings
        assert "dynain" in StampingOutput.model_fields
    assert list(part.model_fields) == names
    for name in names:
        if name not in ("terms", "symmetric", "line_search"):  # those depend on tools and elements
            assert getattr(part(), name) == getattr(data(), name)


def test_stroke_along_a_direction_of_any_length_is_a_displacement() -> None:
    assert ToolMotion(stroke=10.0, direction=(3, -4)).build().move == pytest.approx((6.0, -8.0, 0.0))
    assert ToolMotion(move=(1.0, 2.0)).build().move == (1.0, 2.0, 0.0)


def test_every_key_of_the_json_schema_has_a_description() -> None:
    def properties(node: object) -> list[tuple[str, dict[str, Any]]]:
        if isinstance(node, list):
            return [entry for item in node for entry in properties(item)]
        if not isinstance(node, dict):
            return []
        own = [(name, value) for name, value in node.get("properties", {}).items() if isinstance(value, dict)]
        return own + [entry for item in node.values() for entry in properties(item)]

    without = [name for name, value in properties(json_schema()) if "description" not in value and name != "law"]
    assert without == []


def test_json_schema_allows_the_short_forms() -> None:
    definitions = json_schema()["$defs"]
    for name in ("ProfilePoint", "Zone"):
        assert [option["type"] for option in definitions[name]["anyOf"]] == ["object", "array"]
