# SPDX-License-Identifier: Apache-2.0
"""Punch and holder of the die's face, and paths of files in the case that is kept with the results."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

from presswork.case import CaseError, build_model, read_case
from presswork.geometry.swept_tool import draw_closed_die, triangulate
from presswork.geometry.tool_surface import make_surface
from presswork.model import Model, Triangulation
from tests.unit.case.round_cup import CUP, changed
from tests.unit.mesh.test_tool_file import write_stl

GAP = 1.1


def write_case(folder: Path, *changes: tuple[str, Any]) -> Path:
    """Write a cup whose die is a file; its punch is its face inside of 60 mm, moved up, its holder beyond 66."""
    die = draw_closed_die((26.25, 26.25), 26.25, 6.0, width=40.0, depth=20.0, bottom=6.0)
    write_stl(folder / "die.stl", *triangulate(die, 0.02, size=5.0))
    face = {"shape": "file", "path": "die.stl"}
    line = {"shape": "circle", "diameter": 60}
    tools = {
        "die": {"kind": "die", **face},
        "punch": {"kind": "punch", **face, "offset": GAP, "cut": line},
        "holder": {"kind": "holder", **face, "cut": {**line, "diameter": 66, "keep": "outside"}},
    }
    data = changed(CUP, ("tools", tools), ("stages", [{"name": "draw", "tools": {"punch": {"stroke": 10}}}]), *changes)
    path = folder / "cup.toml"
    path.write_text(tomli_w.dumps(data), encoding="utf-8")
    return path


def build(path: Path) -> Model:
    return build_model(read_case(path))


def test_punch_and_holder_are_made_of_the_dies_face(tmp_path: Path) -> None:
    die, punch, holder = build(write_case(tmp_path)).tools
    assert isinstance(punch.shape, Triangulation)
    assert isinstance(holder.shape, Triangulation)
    away = make_surface(die.surface).nearest(punch.shape.points)[0]
    np.testing.assert_allclose(away, GAP, atol=0.05)
    across = np.hypot(*punch.shape.points[:, :2].T)
    np.testing.assert_allclose(across.max(), 30.0, atol=0.01)
    np.testing.assert_allclose(np.hypot(*holder.shape.points[:, :2].T).min(), 33.0, atol=0.05)
    assert np.ptp(holder.shape.points[:, 2]) < 0.02  # the flat binder


@pytest.mark.validation
def test_punch_and_holder_may_share_their_line(tmp_path: Path) -> None:
    line = {"shape": "circle", "diameter": 66}
    holder = ("tools.holder.cut", {**line, "keep": "outside"})
    build(write_case(tmp_path, ("tools.punch.cut", line), holder))
    with pytest.raises(CaseError, match="punch strikes holder"):
        build(write_case(tmp_path, ("tools.punch.cut", {**line, "diameter": 68}), holder))


@pytest.mark.parametrize(("change", "fault"), [
    (("tools.punch.offset", 8), "tools.punch.offset = 8.0: moved by 8 mm the surface turns over"),
    (("tools.punch.cut.diameter", 300), "tools.punch.cut = \"circle\": the line cuts nothing off: it lies in x -66"),
    (("tools.punch.cut", {"shape": "file", "path": "no.dxf"}), "tools.punch.cut.path = \"no.dxf\": no such file"),
])  # fmt: skip
def test_what_cannot_be_made_is_named(tmp_path: Path, change: tuple[str, Any], fault: str) -> None:
    with pytest.raises(CaseError) as error:
        build(write_case(tmp_path, change))
    assert fault in str(error.value)


def test_files_of_operations_have_full_paths_in_the_case_that_is_kept(tmp_path: Path) -> None:
    path = write_case(tmp_path)
    data = tomllib.loads(path.read_text("utf-8"))
    (tmp_path / "rim.csv").write_text("-40 -40\n40 -40\n40 40\n-40 40\n")
    trim = {"rim": {"shape": "file", "path": "rim.csv"}}
    line = {"name": "draw", "tools": data.pop("tools"), "stages": data.pop("stages"), "trim": trim}
    line["tools"]["punch"]["cut"] = {"shape": "file", "path": "rim.csv"}
    path.write_text(tomli_w.dumps({**data, "operations": [line]}), encoding="utf-8")
    kept = tomllib.loads(read_case(path, ["blank.thickness=0.9"]).text)["operations"][0]
    for table in (*kept["tools"].values(), kept["tools"]["punch"]["cut"], kept["trim"]["rim"]):
        assert Path(table["path"]).is_file()
        assert Path(table["path"]).is_absolute()
