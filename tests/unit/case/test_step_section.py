# SPDX-License-Identifier: Apache-2.0
"""The section of a model in STEP is the profile that one would have typed; its plane and half are those asked for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.case import CaseError
from presswork.case.tools.step_section import read_section
from presswork.examples import copy_example
from presswork.geometry.chain import join_pieces

occ = pytest.importorskip("netgen.occ", reason='no netgen: pip install "presswork[cad]"')


def test_section_of_a_turned_punch_has_its_lines_and_its_arc(tmp_path: Path) -> None:
    punch = occ.Cylinder((0.0, 0.0, 15.0), occ.Z, r=30.0, h=10.0)
    punch = punch.MakeFillet([edge for edge in punch.edges if edge.center.z < 16.0], 4.0)
    punch.WriteStep(str(tmp_path / "punch.step"))
    pieces, tolerance = read_section(tmp_path / "punch.step", "xz", None, is_half=True)
    segments = join_pieces(pieces, tolerance).segments
    arcs = segments[segments[:, 6] != 0.0]
    np.testing.assert_allclose(np.hypot(*(arcs[:, 0:2] - arcs[:, 4:6]).T), 4.0, rtol=1e-6)
    np.testing.assert_allclose(arcs[:, 4:6], np.tile([26.0, 19.0], (len(arcs), 1)), atol=1e-5)
    corners = segments[:, 0:4].reshape(-1, 2)
    np.testing.assert_allclose(corners.min(axis=0), [0.0, 15.0], atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=0), [30.0, 25.0], atol=1e-6)


@pytest.mark.parametrize(
    ("plane", "low", "high"), [("xy", (-1, -2), (5, 10)), ("xz", (-1, -3), (5, 30)), ("yz", (-2, -3), (10, 30))]
)
def test_axes_of_a_section_are_those_of_its_plane(
    tmp_path: Path, plane: str, low: tuple[int, int], high: tuple[int, int]
) -> None:
    occ.Box((-1.0, -2.0, -3.0), (5.0, 10.0, 30.0)).WriteStep(str(tmp_path / "box.step"))
    for is_half in (False, True):
        pieces, tolerance = read_section(tmp_path / "box.step", plane, None, is_half=is_half)  # type: ignore[arg-type]
        corners = join_pieces(pieces, tolerance).segments[:, 0:4].reshape(-1, 2)
        np.testing.assert_allclose(corners.min(axis=0), [0.0 if is_half else low[0], low[1]], atol=1e-6)
        np.testing.assert_allclose(corners.max(axis=0), high, atol=1e-6)


def test_case_takes_its_punch_from_a_model(tmp_path: Path) -> None:
    occ.Cylinder((0.0, 0.0, 15.0), occ.Z, r=30.0, h=10.0).WriteStep(str(tmp_path / "punch.step"))
    case = copy_example("upsetting_q4", tmp_path)
    typed = build_model(Case.from_toml(case))
    text = case.read_text(encoding="utf-8")
    drawn = 'profile_file = "punch.step"\nsection = "xz"\nclosed = true'
    case.write_text(text.replace("profile = [[0, 15], [30, 15]]", drawn), encoding="utf-8")
    model = build_model(Case.from_toml(case))
    faces = [tool.shape.segments for tool in (typed.tools[0], model.tools[0])]
    on_face = faces[1][np.abs(faces[1][:, [1, 3]] - 15.0).max(axis=1) < 1e-6]
    assert sorted(on_face[0, [0, 2]]) == pytest.approx(sorted(faces[0][0, [0, 2]]), abs=1e-6)
    for key in ('layer = "a"', 'unit = "m"'):
        case.write_text(text.replace("profile = [[0, 15], [30, 15]]", f"{drawn}\n{key}"), encoding="utf-8")
        with pytest.raises(CaseError, match="no meaning with a CAD file"):
            Case.from_toml(case)
