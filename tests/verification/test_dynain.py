# SPDX-License-Identifier: Apache-2.0
"""A part goes to another case by a dynain as it goes to the next operation of a line."""

from __future__ import annotations

import copy
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Result
from presswork.case import CaseError, StampingCase, build_model
from presswork.mesh.checks import MeshError
from presswork.mesh.files.dynain import first_sides, read_dynain
from tests.regression.whole_runs import run_stamping
from tests.verification.test_press_line import DRAW, REDRAW, STEEL, distance, line, thinner

OUTPUT = {"rows": 100, "steps": 1, "dynain": True}


@pytest.fixture(scope="module")
def drawn_twice(tmp_path_factory: pytest.TempPathFactory) -> Result:
    return line(tmp_path_factory.mktemp("line") / "out", DRAW, REDRAW, output=OUTPUT)


def laid_at(result: Result) -> dict[str, list[float]]:
    """Return where the log says that tools of the second operation begin."""
    text = next(row for row in (result.folder / "run.log").read_text().splitlines() if "is laid in" in row)
    return {name: [0.0, 0.0, float(z)] for name, z in re.findall(r"redraw_(\w+) at z = (\S+) mm", text)}


def redraw_alone(drawn: Result, folder: Path, **changes: Any) -> dict[str, Any]:
    """Return the case of the second operation alone, on the part that the first has left."""
    own = copy.deepcopy({key: value for key, value in REDRAW.items() if key != "name"})
    for name, position in laid_at(drawn).items():
        own["tools"][name]["position"] = position
    return {
        "title": "redrawn alone",
        "analysis": "stamping",
        "blank": {"shape": "file", "path": str(drawn.folder / "draw.dynain"), "thickness": 1.0, "material": "steel",
                  "symmetry": ["x", "y"]},
        "materials": {"steel": STEEL},
        "output": OUTPUT,
        **own,
        **changes,
    }  # fmt: skip


@pytest.mark.validation
def test_the_second_operation_alone_is_as_in_the_line(drawn_twice, tmp_path) -> None:
    """By the numbers of the file, ten digits, and of the log, six digits of where tools stand."""
    alone = run_stamping(redraw_alone(drawn_twice, tmp_path), tmp_path / "alone")
    for step in (-2, -1):
        assert distance(drawn_twice, alone, step, step) < 2e-3
        assert thinner(drawn_twice, alone, step, step) < 2e-4
        strain = [run.field("equivalent_plastic_strain", step) for run in (drawn_twice, alone)]
        np.testing.assert_allclose(strain[0], strain[1], atol=2e-3)
    whole, own = (read_dynain(f) for f in (drawn_twice.folder / "redraw.dynain", tmp_path / "alone" / "part.dynain"))
    np.testing.assert_allclose(whole.strain, own.strain, atol=2e-3)  # goes on from that of the file
    force = [float(drawn_twice.history["redraw_punch.force"].max()), float(alone.history["punch.force"].max())]
    assert force[0] == pytest.approx(force[1], rel=2e-3)


def test_a_dynain_has_thickness_strain_and_plane_stress(drawn_twice) -> None:
    """Logarithmic strain keeps the volume where it is plastic; stress has no part across the sheet."""
    part = read_dynain(drawn_twice.folder / "draw.dynain")
    step = 2  # drawn, sprung back
    np.testing.assert_allclose(part.thickness, drawn_twice.field("thickness", step), rtol=1e-8)
    np.testing.assert_allclose(part.points, drawn_twice.points(step), atol=1e-7)
    assert part.strain is not None
    assert np.abs(part.strain[:, :3].sum(axis=1)).max() < 3e-3
    assert np.linalg.norm(part.strain[:, :3], axis=1).max() > 0.15
    _, normal = first_sides(part.points, part.cells)
    s = part.stress
    across = np.stack([
        s[..., 0] * normal[:, None, 0] + s[..., 3] * normal[:, None, 1] + s[..., 5] * normal[:, None, 2],
        s[..., 3] * normal[:, None, 0] + s[..., 1] * normal[:, None, 1] + s[..., 4] * normal[:, None, 2],
        s[..., 5] * normal[:, None, 0] + s[..., 4] * normal[:, None, 1] + s[..., 2] * normal[:, None, 2],
    ])  # fmt: skip
    assert np.abs(across).max() < 1e-5
    assert np.abs(s).max() > 100.0


def test_formed_sheets_that_cannot_begin_are_refused(drawn_twice, tmp_path) -> None:
    text = (drawn_twice.folder / "draw.dynain").read_text()
    for cut, told in (
        (
            text.replace("*INITIAL_STRESS_SHELL", "*CONTACT_FORMING"),
            "CONTACT_FORMING is not read as a part of a formed sheet",
        ),
        (text[: text.index("*INITIAL_STRESS") + 400], "cut short"),
        ("*KEYWORD\n*END\n", "expected \\*NODE"),
    ):
        (tmp_path / "cut.dynain").write_text(cut)
        with pytest.raises(MeshError, match=told):
            read_dynain(tmp_path / "cut.dynain")
    data = redraw_alone(drawn_twice, tmp_path)
    data["materials"] = {"steel": STEEL | {"kinematic": {"law": "chaboche", "C": [500], "gamma": [10]}}}
    with pytest.raises(CaseError, match="back stresses of a formed sheet are not in its file"):
        build_model(StampingCase.model_validate(data))
