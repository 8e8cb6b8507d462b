# SPDX-License-Identifier: Apache-2.0
"""Zones of welded blanks and tables of thickness: what a case takes, what it refuses, and how the mesh is divided."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.stamping.schema import StampingCase
from presswork.fields.formability_fields import formability_fields
from presswork.mesh.topology import find_boundary_edges
from presswork.model import FloatArray, Model

HARDENING = {"law": "swift", "K": 500, "n": 0.2, "e0": 0.002}
STEEL = {"young": "210 GPa", "poisson": 0.3, "density": "7850 kg/m^3", "hardening": HARDENING}
THERMAL = {"conductivity": 30, "specific_heat": "600 J/(kg*K)"}
RIGHT = {"line": [[5, -50], [5, 50]], "side": "right"}


def blank(*zones: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Return a case of a blank of 60 mm by 40 mm."""
    own = {"shape": "rectangle", "size": [60, 40], "element_size": 4, "thickness": 1.0, "material": "steel"}
    return {
        "title": "zones", "analysis": "stamping", "blank": own | {"zones": list(zones)} | changes,
        "materials": {"steel": STEEL, "strong": STEEL | {"hardening": HARDENING | {"K": 900}}},
        "stages": [{"name": "wait", "duration": 1e-3}],
    }  # fmt: skip


def make(case: dict[str, Any], source: Path | None = None) -> Model:
    """Build the Model of a case."""
    return build_model(StampingCase.model_validate(case, context={"source": source}))


def refuse(case: dict[str, Any]) -> str:
    """Return the errors of a case."""
    with pytest.raises(CaseError) as caught:
        make(case)
    return str(caught.value)


def measure_areas(model: Model) -> dict[int, float]:
    """Return the area of each zone [mm2]."""
    found: dict[int, float] = {}
    for block in model.mesh.blocks:
        x, y = np.moveaxis(model.mesh.points[block.connectivity][..., :2], -1, 0)
        area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum()
        found[block.zone] = found.get(block.zone, 0.0) + float(area)
    return found


def least_sine(model: Model) -> float:
    """Return the least sine of all corners."""
    sines = []
    for block in model.mesh.blocks:
        side = np.roll(model.mesh.points[block.connectivity][..., :2], -1, axis=1)
        side = side - model.mesh.points[block.connectivity][..., :2]
        side /= np.linalg.norm(side, axis=2, keepdims=True)
        last = np.roll(side, 1, axis=1)
        sines.append((last[..., 0] * side[..., 1] - last[..., 1] * side[..., 0]).min())
    return float(min(sines))


# --- what is refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("zone", "words"),
    [
        ({"line": [[50, 0], [50, 9]], "side": "right", "thickness": 1.2}, ["zones.0.line", "no element", "-30 to 30"]),
        ({"line": [[50, 0], [50, 9]], "side": "left", "thickness": 1.2}, ["zones.0.line", "whole blank"]),
        ({"inside": {"shape": "circle", "diameter": 2, "centre": [1.1, 1.2]}, "thickness": 1.2}, ["no element"]),
        ({**RIGHT, "thickness": 0.0012}, ["zones.0.thickness", "thinner than any rolled metal", "mm"]),
        ({**RIGHT, "thickness": -1}, ["zones.0.thickness"]),
        ({**RIGHT, "material": "stel"}, ["zones.0.material", "no such material", "steel"]),
        ({**RIGHT}, ["differs from the blank in nothing", "rolling_direction"]),
        ({"thickness": 1.2}, ["none is given", "line with side"]),
        ({**RIGHT, "set": "left", "thickness": 1.2}, ["line and set is given"]),
        ({"line": RIGHT["line"], "thickness": 1.2}, ["a line has a side"]),
        ({"set": "left", "side": "left", "thickness": 1.2}, ["a line has a side"]),
        ({"line": [[5, 0], [5, 0]], "side": "left", "thickness": 1.2}, ["the same"]),
        ({"set": "thick", "thickness": 1.2}, ["zones.0.set", "no such set"]),
    ],
)  # fmt: skip
def test_bad_zone_is_refused_at_its_key_with_a_remedy(zone, words) -> None:
    text = refuse(blank({"name": "z", **zone}))
    for word in words:
        assert word in text


def test_zones_that_overlap_are_refused_with_a_place() -> None:
    circle = {"name": "patch", "inside": {"shape": "circle", "diameter": 20}, "thickness": 1.5}
    text = refuse(blank({"name": "thick", **RIGHT, "thickness": 1.2}, circle))
    assert "zones.1" in text
    assert "overlaps the zone thick, at (" in text


def test_two_zones_of_one_name_are_refused() -> None:
    left = {"line": RIGHT["line"], "side": "left", "thickness": 0.8}
    assert "two zones have this name" in refuse(blank({"name": "z", **RIGHT, "thickness": 1.2}, {"name": "z", **left}))


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ([[-20, 1.0], [30, 1.5]], "the table ends within the blank: it has -20 to 30 mm, the blank -30 to 30"),
        ([[-30, 1.0], [10, 1.2], [10, 1.5], [30, 1.5]], "distance 10 mm follows 10 mm"),
        ([[-30, 1.0], [10, 1.2], [0, 1.5]], "distance 0 mm follows 10 mm"),
        ([[-30, 1.0], [30, 0.0]], "not above 0"),
        ([[-30, 1.0]], "two or more rows"),
        ([[-30, 0.001], [30, 0.0012]], "thinner than any rolled metal"),
    ],
)
def test_bad_table_of_thickness_is_refused(table, words) -> None:
    text = refuse(blank(thickness=table))
    assert "blank.thickness" in text
    assert words in text


def test_tube_takes_neither_zones_nor_a_table() -> None:
    case = blank()
    tube = {"shape": "tube", "diameter": 40, "length": 80, "element_size": 5, "thickness": 1.0, "material": "steel"}
    case["blank"] = tube | {"zones": [{"name": "z", **RIGHT, "thickness": 1.2}]}
    assert "unknown key" in refuse(case)
    case["blank"] = tube | {"thickness": [[-40, 1.0], [40, 1.5]]}
    assert "blank.thickness" in refuse(case)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"explicit": {"device": "host"}}, "explicit.device"),
        ({"procedure": "implicit", "gradients": {"by": ["blank.thickness"]}}, "gradients"),
        (
            {
                "heat": {"initial_temperature": 900},
                "materials": {name: STEEL | {"thermal": THERMAL} for name in ("steel", "strong")},
            },
            "heat is not conducted in",
        ),
        ({"materials": {"steel": STEEL, "strong": STEEL | {"kinematic": {"law": "linear", "C": 1000}}}}, "kinematic"),
    ],
)
def test_what_a_welded_blank_cannot_have_is_refused(changes, words) -> None:
    text = refuse(blank({"name": "z", **RIGHT, "material": "strong"}) | changes)
    assert words in text


# --- the mesh --------------------------------------------------------------------------------------------------------


def test_grid_of_a_rectangle_has_lines_on_weld_lines_along_its_sides() -> None:
    model = make(blank({"name": "z", **RIGHT, "thickness": 1.5}))
    assert [(b.zone, b.section.thickness, b.element) for b in model.mesh.blocks if b.section] == [
        (0, 1.0, "shell4_1pt"), (1, 1.5, "shell4_1pt"),
    ]  # fmt: skip
    assert measure_areas(model) == pytest.approx({0: 35 * 40, 1: 25 * 40}, rel=1e-12)
    assert least_sine(model) == pytest.approx(1.0)


@pytest.mark.parametrize("cells", ["quadrilaterals", "triangles"])
@pytest.mark.parametrize("angle", [5.0, 30.0, 45.0, 70.0])
def test_aslant_line_divides_the_mesh_without_gaps_and_exactly(angle, cells) -> None:
    """A line through the middle halves the rectangle; cells keep corners of more than 15 degrees."""
    along = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    zone = {"name": "z", "line": [[0, 0], along.tolist()], "side": "left", "thickness": 1.5}
    model = make(blank(zone, cells=cells))
    assert measure_areas(model) == pytest.approx({0: 1200, 1: 1200}, rel=1e-9)
    assert least_sine(model) > np.sin(np.radians(15.0))
    ends = find_boundary_edges([block.connectivity for block in model.mesh.blocks])
    assert (np.bincount(ends.ravel())[np.unique(ends)] == 2).all()
    outline = model.mesh.points[ends]
    assert np.linalg.norm(outline[:, 1] - outline[:, 0], axis=1).sum() == pytest.approx(200.0)


def test_circular_zone_has_the_area_of_its_circle_within_chords() -> None:
    zone = {"name": "z", "inside": {"shape": "circle", "diameter": 24, "centre": [3, 1]}, "thickness": 1.5}
    model = make(blank(zone, element_size=2))
    assert measure_areas(model)[1] == pytest.approx(np.pi * 12**2, rel=0.01)


def test_zone_outside_a_line_is_the_rest() -> None:
    zone = {"name": "rim", "outside": {"shape": "rectangle", "size": [40, 20]}, "material": "strong"}
    model = make(blank(zone))
    assert measure_areas(model) == pytest.approx({0: 800, 1: 1600}, rel=1e-9)
    assert [model.materials[block.material].name for block in model.mesh.blocks][-1] == "strong"


def test_material_of_the_library_and_rolling_direction_are_those_of_the_zone() -> None:
    model = make(blank({"name": "z", **RIGHT, "material": "dp600", "rolling_direction": 90}))
    own = model.mesh.blocks[1]
    assert model.materials[own.material].name == "dp600"
    assert own.rolling == pytest.approx((0.0, 1.0, 0.0))
    assert model.mesh.blocks[0].rolling is None


def write_plate(path: Path, *, with_group: bool) -> None:
    """Write a mesh of 8 x 4 cells of 5 mm; the group has the cells at x >= 20."""
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(0, 40, 9), np.linspace(0, 20, 5)))
    first = (np.arange(8)[None, :] + 9 * np.arange(4)[:, None]).ravel()
    cells = np.stack([first, first + 1, first + 10, first + 9], axis=1)
    points = np.column_stack([x, y, np.zeros_like(x)])
    nodes = {"thick": np.flatnonzero(x >= 20)} if with_group else {}
    meshio.write(path, meshio.Mesh(points, [("quad", cells)], point_sets=nodes), file_format="abaqus")


def test_group_of_a_mesh_file_is_a_zone_and_an_unknown_one_is_refused(tmp_path: Path) -> None:
    write_plate(tmp_path / "plate.inp", with_group=True)
    case = blank({"name": "z", "set": "thick", "thickness": 1.5})
    case["blank"] = {"shape": "file", "path": str(tmp_path / "plate.inp"), "thickness": 1.0, "material": "steel",
                     "zones": [{"name": "z", "set": "thick", "thickness": 1.5}]}  # fmt: skip
    assert measure_areas(make(case)) == pytest.approx({0: 400, 1: 400})
    case["blank"]["zones"][0]["set"] = "thik"
    assert "did you mean `thick`" in refuse(case)


def test_line_through_cells_of_a_mesh_file_warns_of_how_far_it_is_off(tmp_path: Path, caplog: Any) -> None:
    write_plate(tmp_path / "plate.inp", with_group=False)
    case = blank()
    zone = {"name": "z", "line": [[22, 0], [22, 5]], "side": "right", "thickness": 1.5}
    case["blank"] = {"shape": "file", "path": str(tmp_path / "plate.inp"), "thickness": 1.0, "material": "steel",
                     "zones": [zone]}  # fmt: skip
    with caplog.at_level(logging.WARNING):
        model = make(case)
    assert measure_areas(model) == pytest.approx({0: 400, 1: 400})
    assert "up to 2 mm off its line" in caplog.text


# --- thickness and limits --------------------------------------------------------------------------------------------


def test_rolled_blank_has_the_mass_of_its_table() -> None:
    model = make(blank(thickness=[[-30, 1.0], [-4, 1.0], [4, 1.6], [30, 1.6]], thickness_direction=0))
    (block,) = model.mesh.blocks
    area = measure_areas(model)[0] / len(block.connectivity)
    assert float(block.thickness.sum()) * area == pytest.approx(40 * (26 * 1.0 + 8 * 1.3 + 26 * 1.6))
    across = make(blank(thickness=[[-20, 1.0], [20, 1.4]], thickness_direction=90)).mesh.blocks[0]
    y = model.mesh.points[across.connectivity].mean(axis=1)[:, 1]
    assert across.thickness == pytest.approx(1.2 + 0.01 * y)


def test_each_zone_is_judged_by_the_keeler_limit_of_its_own_thickness() -> None:
    """Keeler: FLD0 = ln(1 + (23.3 + 14.13 t) n/0.21/100) grows with thickness; the same strain has two margins."""
    case = blank({"name": "z", **RIGHT, "thickness": 2.0})
    case["materials"] = {"steel": STEEL | {"forming_limit": {"law": "keeler", "n": 0.2}}}
    model = make(case)
    limits = [np.log(1 + (23.3 + 14.13 * t) * 0.2 / 0.21 / 100) for t in (1.0, 2.0)]
    n = len(model.cells)
    strains: dict[str, FloatArray] = {
        "major_strain_middle": np.full(n, 0.2),
        "minor_strain_middle": np.zeros(n),
        "thickness_strain": np.full(n, -0.2),
    }
    margins = formability_fields(strains, model.judged)["forming_limit_margin"]
    counts = [len(block.connectivity) for block in model.mesh.blocks]
    assert margins[0] == pytest.approx(1 - 0.2 / limits[0])
    assert margins[-1] == pytest.approx(1 - 0.2 / limits[1])
    assert len(set(margins[: counts[0]])) == len(set(margins[counts[0] :])) == 1


def test_zone_without_a_forming_limit_is_not_judged() -> None:
    case = blank({"name": "z", **RIGHT, "material": "strong"})
    case["materials"]["steel"] = STEEL | {"forming_limit": {"law": "keeler", "n": 0.2}}
    model = make(case)
    n = len(model.cells)
    names = ("major_strain_middle", "minor_strain_middle", "thickness_strain")
    found = formability_fields({name: np.zeros(n) for name in names}, model.judged)
    first = len(model.mesh.blocks[0].connectivity)
    assert np.isfinite(found["forming_limit_margin"][:first]).all()
    assert np.isnan(found["forming_limit_margin"][first:]).all()
    assert found["thinning"].max() == 0.0
