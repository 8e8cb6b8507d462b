# SPDX-License-Identifier: Apache-2.0
"""What a symmetry plane cuts has two halves alike, or is refused with where they differ most."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, read_case
from presswork.geometry.asymmetry import HalfSpace, find_asymmetry
from presswork.geometry.swept_tool import draw_die, draw_holder, draw_punch, triangulate
from tests.unit.case.round_cup import CUP, changed
from tests.unit.case.test_stamping_clashes import write_stl

SHAPES = {
    "punch": draw_punch((25, 25), 25, 5, 30),
    "die": draw_die((26.25, 26.25), 26.25, 6, width=60, depth=40),
    "holder": draw_holder((27, 27), 27, 1, width=60, height=20),
}


def build(*changes: tuple[str, object]) -> None:
    build_model(StampingCase.model_validate(changed(CUP, ("stages.0.tools.punch.stroke", 1), *changes)))


@pytest.mark.parametrize("kind", list(SHAPES))
def test_a_file_of_each_kind_of_tool_is_halved_by_the_planes(kind: str, tmp_path: Path) -> None:
    """A wall that is 1.2 mm off its mirror image: twice the shift. The half of a tool has no other half."""
    points, triangles = triangulate(SHAPES[kind], 0.02)

    def tool(shift: list[float], kept: np.ndarray = triangles) -> tuple[str, object]:
        return f"tools.{kind}", {"kind": kind, **write_stl(tmp_path / "tool.stl", points + np.array(shift), kept)}

    build(tool([0, 0, 0]))
    for axis, plane in enumerate("xy"):
        with pytest.raises(CaseError) as error:
            build(tool([0.6 * (axis == i) for i in range(3)]))
        assert f"tools.{kind}: the symmetry plane {plane} = 0 cuts this tool" in str(error.value)
        found = re.search(r"halves differ, by (.*) mm at \(", str(error.value))
        assert found
        assert float(found[1]) == pytest.approx(1.2, abs=0.03)
        build(tool([0.6 * (axis == i) for i in range(3)]), ("blank.symmetry", ["xy"[1 - axis]]))
    build(tool([0, 0, 0], triangles[(points[triangles, 0] > -1e-9).all(axis=1)]))


def test_a_boss_on_either_side_of_a_flat_punch_is_found(tmp_path: Path) -> None:
    """The flat side is one large facet, whose corners alone say nothing of a boss 2 mm high on the other side."""
    for side in (-1, 1):
        xs = side * np.array([-20.0, 0, 8, 10, 12, 20])[::side]
        points = np.array([[x, y, -2.0 * (abs(x - side * 10) < 1)] for x in xs for y in (-60.0, 60.0)])
        i = 2 * np.arange(5)
        faces = np.concatenate([np.column_stack([i, i + 1, i + 2]), np.column_stack([i + 1, i + 3, i + 2])])
        strip = {"kind": "punch", **write_stl(tmp_path / "strip.stl", points, faces)}
        with pytest.raises(CaseError, match=r"x = 0 cuts this tool, but its halves differ, by 2 mm at \(10, -?50, "):
            build(("tools.punch", strip), ("blank.symmetry", ["x"]))


@pytest.mark.parametrize(("key", "line", "place"), [
    ("trim", {"t": {"shape": "circle", "diameter": 80, "centre": [2, 0]}}, r"trim\.t: .* by 4 mm at \(38, 0\)"),
    ("beads", [{"points": [[-30, 40], [36, 38]], "force": 50}], r"beads\.0\.points: .* by 1\.8\d* mm at \(30, "),
])  # fmt: skip
def test_lines_that_a_plane_cuts_are_halved_by_it(key: str, line: object, place: str) -> None:
    with pytest.raises(CaseError, match=place):
        build((key, line))
    build((key, line), ("blank.symmetry", ["y"] if key == "trim" else []))
    build(
        (
            key,
            {"t": {"shape": "circle", "diameter": 80}}
            if key == "trim"
            else [line[0] | {"points": [[-3, 40], [36, 40]]}],
        )
    )  # type: ignore[index]


def test_a_profile_that_the_axis_or_a_plane_cuts_is_halved_by_it(
    write_case: Callable[..., Path], tmp_path: Path
) -> None:
    """A punch drawn whole, its right side 1 mm farther out than its left one: 14 and 13 mm from the axis."""
    for left, fault in ((-14, ""), (-13, "x = 0 cuts this profile, but its halves differ, by 1 mm at ")):
        (tmp_path / "punch.csv").write_text(f"{left}, 30\n{left}, 15\n14, 15\n14, 30\n")
        file = ("profile = [[0, 15], [30, 15]]", 'profile_file = "punch.csv"\ncurve = "polyline"')
        for plane in ((), (('analysis = "axisymmetric"', 'analysis = "plane_strain"\ndepth = 5'),)):
            path = write_case(file, *plane)
            if not fault:
                build_model(read_case(path))
                continue
            with pytest.raises(CaseError, match=fault):
                build_model(read_case(path))


def test_a_half_that_ends_first_is_compared_as_far_as_it_goes() -> None:
    """A line along x from -4 to 10 and the step at 3 of its right half alone."""
    half, window = HalfSpace(0, 0.0), (np.array([0.0, -9.0]), np.array([20.0, 9.0]))
    flat = np.column_stack([np.linspace(-4, 10, 29), np.zeros(29)])
    assert find_asymmetry(flat, lambda at: np.abs(at[:, 1]), half, window, 0.5, 0.1) is None
    stepped = np.column_stack([flat[:, 0], 2.0 * (flat[:, 0] > 3)])
    found = find_asymmetry(stepped, lambda at: np.abs(at[:, 1] - 2.0 * (at[:, 0] > 3)), half, window, 0.5, 0.1)
    assert found is not None
    assert found.deviation == 2.0
    assert 3.0 < found.place[0] <= 4.0
    assert find_asymmetry(stepped, lambda at: at[:, 1] - 2.0, half, window, 5.0, 0.1) is None
