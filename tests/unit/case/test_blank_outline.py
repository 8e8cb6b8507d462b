# SPDX-License-Identifier: Apache-2.0
"""Blanks within an outline from a file: what is read, meshed, and refused."""

from __future__ import annotations

import copy
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model
from presswork.case.errors import Problem
from presswork.case.stamping.plan_line import LineFile, draw_line
from presswork.results import write_outline
from tests.unit.case.test_stamping_case import CUP

ANGLE = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
CIRCLE = 50.0 * np.stack([np.cos(ANGLE), np.sin(ANGLE)], axis=1)


def read(path: Path, unit: str | None = None):
    line = draw_line(LineFile(shape="file", path=path.name, unit=unit), "blank", path.parent)
    assert not isinstance(line, Problem), line
    return line


def build(path: Path, **changes: object):
    data = copy.deepcopy(CUP)
    data["blank"] = {k: v for k, v in data["blank"].items() if k != "diameter"}
    data["blank"] |= {"shape": "outline", "path": str(path), **changes}
    return build_model(StampingCase.model_validate(data))


@pytest.mark.parametrize("name", ["blank.csv", "blank.dxf"])
def test_an_outline_becomes_a_meshed_blank(tmp_path, name):
    write_outline((CIRCLE, 0.1 * CIRCLE)[: 1 if name.endswith("dxf") else 2], tmp_path / name)
    mesh = build(tmp_path / name).mesh
    assert mesh.blocks[0].element == "shell4_1pt"
    edge = np.linalg.norm(mesh.points[mesh.node_sets["edge"], :2], axis=1)
    assert edge == pytest.approx(np.full(len(edge), 50.0), rel=4e-4)
    assert {"symmetry_x", "symmetry_y"} <= set(mesh.node_sets)


def test_units_and_arcs_of_a_drawing(tmp_path):
    drawing = ezdxf.new("R2010", units=1)  # inches
    drawing.modelspace().add_circle((0.0, 0.0), 2.0)
    drawing.saveas(tmp_path / "disc.dxf")
    for unit, radius in ((None, 50.8), ("mm", 2.0)):
        points = read(tmp_path / "disc.dxf", unit)
        assert np.linalg.norm(points, axis=1) == pytest.approx(np.full(len(points), radius))
        assert len(points) > 100


def test_plain_columns_in_another_unit(tmp_path):
    (tmp_path / "blank.csv").write_text("x,y\n" + "\n".join(f"{x / 10},{y / 10}" for x, y in CIRCLE))
    assert np.roll(read(tmp_path / "blank.csv", "cm"), -1, axis=0) == pytest.approx(CIRCLE)


def test_columns_are_found_by_name_and_the_first_loop_is_taken(tmp_path):
    write_outline((CIRCLE, 0.1 * CIRCLE), tmp_path / "blank.csv")
    assert np.roll(read(tmp_path / "blank.csv"), -1, axis=0) == pytest.approx(CIRCLE, abs=1e-5)
    (tmp_path / "other.csv").write_text("y_mm;z_mm;x_mm\n0;7;10,5\n5;7;10\n5;7;0\n")
    assert sorted(read(tmp_path / "other.csv").tolist()) == [[0, 5], [10, 5], [10.5, 0]]


@pytest.mark.parametrize(
    ("content", "changes", "said"),
    [
        (None, {}, "no such file"),
        ("", {}, "0 points"),
        ("x_mm,y_mm\n0,0\n50,oops\n", {}, "line 3: expected two numbers"),
        ("loop,x_mm,y_mm\n0,0,0\n0,50\n", {}, "line 3: expected 3 numbers, as the first line names"),
        ("x_mm,y_mm\n0,0\n50,50\n50,0\n0,50\n", {}, "crosses or touches itself"),
        ("x_mm,y_mm\n0,0\n50,0\n", {}, "2 points"),
        ("0,0\n50,0,3\n", {}, "line 2"),
        ("x_mm,y_mm\n-50,-50\n50,-50\n50,50\n-50,50\n", {"unit": "kN"}, "blank.unit"),
        ("x_mm,y_mm\n-50,-50\n50,-50\n50,50\n-50,50\n", {"element_size": 0.01}, "memory"),
        ("x_mm,y_mm\n-50,-50\n50,-50\n50,50\n-50,50\n", {"element_size": 60}, "too narrow"),
        ("x_mm,y_mm\n10,10\n50,10\n50,50\n10,50\n", {}, "does not reach the symmetry plane"),
    ],
)
def test_bad_outlines_are_refused(tmp_path, content, changes, said):
    path = tmp_path / "blank.csv"
    if content is not None:
        path.write_text(content)
    with pytest.raises(CaseError, match=said):
        build(path, **changes)


def test_an_open_drawing_is_refused(tmp_path):
    drawing = ezdxf.new("R2010", units=4)
    drawing.modelspace().add_lwpolyline([(0, 0), (50, 0), (50, 50)])
    drawing.saveas(tmp_path / "open.dxf")
    with pytest.raises(CaseError, match="open"):
        build(tmp_path / "open.dxf")
