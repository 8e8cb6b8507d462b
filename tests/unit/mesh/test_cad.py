# SPDX-License-Identifier: Apache-2.0
"""Models in STEP and IGES become triangles within a tolerance, normals outwards; the unreadable has a remedy."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
import tomli_w

from presswork import build_model, read_case
from presswork.case import CaseError
from presswork.case.tools.step_section import read_section
from presswork.examples import copy_example
from presswork.geometry.chain import ProfileFileError
from presswork.mesh.checks import MeshError
from presswork.mesh.files.cad import read_cad
from presswork.mesh.files.tool_file import read_tool
from presswork.mesh.triangles import double_areas, enclosed_volumes
from tests.problems.iges_file import write_iges

RADIUS, HEIGHT = 20.0, 30.0


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A punch with a hemispherical nose at z = 0, its shaft upwards."""
    occ = pytest.importorskip("netgen.occ", reason='no netgen: pip install "presswork[cad]"')
    nose = occ.Sphere((0.0, 0.0, RADIUS), RADIUS)
    shaft = occ.Cylinder((0.0, 0.0, RADIUS), occ.Z, r=RADIUS, h=HEIGHT)
    path = tmp_path / "punch.step"
    (nose + shaft).WriteStep(str(path))
    return path


@pytest.mark.parametrize("tolerance", [0.02, 0.2])
def test_triangles_lie_within_the_tolerance_and_face_outwards(model: Path, tolerance: float) -> None:
    tool, notes = read_tool(model, closed=True, tolerance=tolerance)
    assert not [note for note in notes if "rims" in note]
    assert tool.is_closed
    corners = tool.points[tool.triangles]
    is_nose = (corners[..., 2] < RADIUS - 1e-3).any(axis=1)
    middles = corners[is_nose].mean(axis=1) - [0.0, 0.0, RADIUS]
    inside = RADIUS - np.linalg.norm(middles, axis=1)
    assert inside.max() <= tolerance
    assert np.abs(np.linalg.norm(corners[is_nose] - [0.0, 0.0, RADIUS], axis=2) - RADIUS).max() < 1e-4
    volume = 2.0 / 3.0 * np.pi * RADIUS**3 + np.pi * RADIUS**2 * HEIGHT
    part = np.zeros(len(tool.triangles), dtype=np.int64)
    found = float(enclosed_volumes(tool.points, tool.triangles, part)[0])
    assert 1.0 - 4.0 * tolerance / RADIUS < found / volume < 1.0


def test_finer_tolerance_gives_more_triangles(model: Path) -> None:
    counts = [len(read_cad(model, tolerance).points) for tolerance in (0.5, 0.05, 0.005)]
    assert counts[0] < counts[1] < counts[2]


def test_unit_of_the_file_becomes_mm(model: Path) -> None:
    size = np.ptp(read_cad(model).points, axis=0)
    np.testing.assert_allclose(size, [2 * RADIUS, 2 * RADIUS, RADIUS + HEIGHT], rtol=1e-3)
    text = model.read_text()
    model.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.CENTI.,.METRE.)"))
    np.testing.assert_allclose(np.ptp(read_cad(model).points, axis=0), 10.0 * size, rtol=1e-3)


def test_damaged_models_are_refused_with_a_remedy(model: Path) -> None:
    text = model.read_text()
    faults = {
        text[: len(text) // 2]: "export it again",
        "solid x": "ISO-10303-21",
        text.replace("PRODUCT_CONTEXT", "DOCUMENT_FILE"): "as one file",
    }
    for content, words in faults.items():
        model.write_text(content)
        with pytest.raises(MeshError, match=words):
            read_cad(model)
    with pytest.raises(MeshError, match="no such file"):
        read_cad(model.with_name("other.step"))


def test_a_model_on_which_open_cascade_crashes_is_refused_with_a_remedy(model: Path) -> None:
    model.write_text(re.sub(r"= LINE\('',#\d+", "= LINE('',2147483648", model.read_text(), count=1))
    with pytest.raises(MeshError, match=r"crashes \(SIGSEGV\).*export it again"):
        read_cad(model)
    with pytest.raises(ProfileFileError, match=r"crashes \(SIGSEGV\).*export it again"):
        read_section(model, "xz", None, is_half=True)


def test_without_netgen_the_remedy_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "netgen", None)
    with pytest.raises(MeshError, match=r"presswork\[cad\].*STL"):
        read_cad(tmp_path / "punch.step")


def test_stamping_takes_its_punch_from_a_model(model: Path) -> None:
    """The same as one drawn by its dimensions: they touch the blank at the same place."""
    case = copy_example("square_cup", model.parent)
    data = tomllib.loads(case.read_text(encoding="utf-8"))
    punch = next(name for name, tool in data["tools"].items() if tool["kind"] == "punch")
    data["tools"][punch] = {"kind": "punch", "shape": "file", "path": "punch.step", "mu": 0.1, "tolerance": 0.1}
    case.write_text(tomli_w.dumps(data), encoding="utf-8")
    tool = next(tool for tool in build_model(read_case(case)).tools if tool.name == punch)
    assert tool.shape.points[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert tool.position[2] == pytest.approx(0.5 * data["blank"]["thickness"], abs=1e-6)
    faults = {"unit": ("inch", "holds its unit itself"), "path": ("punch.stl", "no meaning with triangles")}
    for key, (value, words) in faults.items():
        changed = {**data["tools"][punch], key: value}
        case.write_text(tomli_w.dumps({**data, "tools": {**data["tools"], punch: changed}}), encoding="utf-8")
        with pytest.raises(CaseError, match=words):
            read_case(case)


WALL = [(20.0, 0.0), (30.0, 0.0), (40.0, 10.0), (40.0, 25.0)]
"""Of a die: a ring, a cone, a cylinder (r, z) [mm]."""
AREA = np.pi * (30.0**2 - 20.0**2 + (30.0 + 40.0) * np.hypot(10.0, 10.0) + 2.0 * 40.0 * 15.0) / 4.0


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("inch", 25.4), ("m", 1e3)])
@pytest.mark.parametrize("ending", ["igs", "iges"])
def test_faces_in_iges_are_sewn_into_one_surface_in_mm(tmp_path: Path, unit: str, factor: float, ending: str) -> None:
    pytest.importorskip("netgen.occ", reason='no netgen: pip install "presswork[cad]"')
    path = tmp_path / f"die.{ending}"
    path.write_text(write_iges([(r / factor, z / factor) for r, z in WALL], 0.5 * np.pi, unit))
    tool, notes = read_tool(path, facing=(0.0, 0.0, 1.0), tolerance=0.05)
    assert len([note for note in notes if "open rim" in note]) == 1
    assert not [note for note in notes if "parts that share no edge" in note]
    area = 0.5 * np.linalg.norm(double_areas(tool.points, tool.triangles), axis=1).sum()
    assert area == pytest.approx(AREA, rel=3e-3)
    r = np.linalg.norm(tool.points[:, :2], axis=1)
    profile = np.array(WALL)
    on = np.interp(tool.points[:, 2], profile[1:, 1], profile[1:, 0])
    is_ring = tool.points[:, 2] < 1e-9
    np.testing.assert_allclose(r[~is_ring], on[~is_ring], atol=1e-6)
    middles = tool.points[tool.triangles].mean(axis=1)
    is_wall = middles[:, 2] > 10.0
    assert (40.0 - np.linalg.norm(middles[is_wall, :2], axis=1)).max() < 0.05


def test_damaged_models_in_iges_are_refused_with_a_remedy(tmp_path: Path) -> None:
    pytest.importorskip("netgen.occ", reason='no netgen: pip install "presswork[cad]"')
    text = write_iges(WALL, 0.5 * np.pi)
    faults = {
        text[: len(text) // 2]: "not a whole IGES file",
        "solid x": "not a whole IGES file",
        write_iges(WALL[:1], 0.5 * np.pi): "no faces|cannot be read",
    }
    for content, words in faults.items():
        (tmp_path / "die.igs").write_text(content)
        with pytest.raises(MeshError, match=words):
            read_cad(tmp_path / "die.igs")
