# SPDX-License-Identifier: Apache-2.0
"""Tools of a stamping are judged by their surfaces: drawn by keys or read from files, the verdict is one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError, StampingCase, build_model, describe
from presswork.case.stamping.shapes import draw_shape
from presswork.geometry.swept_tool import triangulate
from presswork.model import SweptProfile
from tests.unit.case.round_cup import CUP, changed
from tests.unit.case.test_stamping_clashes import write_stl

PLANS = {"round": {"diameter": 1.0}, "rectangular": {"size": (1.0, 1.3)}, "strip": {"width": 1.0}}


@dataclass(frozen=True)
class Draw:
    """A draw with a punch and a die."""

    case: dict[str, Any]
    is_possible: bool
    """By their dimensions."""


def draw_by_seed(seed: int) -> Draw:
    """Return a draw whose clearance, depth, thickness, radii and offset a seed has drawn, well off what is allowed."""
    rng = np.random.default_rng(seed)
    t, size, plan = float(rng.uniform(0.6, 1.6)), float(rng.uniform(44, 52)), str(rng.choice(list(PLANS)))
    clearance = t * float(rng.choice([rng.uniform(0.2, 0.5), rng.uniform(0.7, 0.9), rng.uniform(1.1, 1.6)]))
    offset = float(rng.choice([0.0, rng.uniform(0.05, 0.3) * t]))
    stroke = float(rng.uniform(16, 22))
    depth = [None, stroke + t * rng.uniform(0.05, 0.6), stroke - t * rng.uniform(0.2, 2.0)][int(rng.integers(3))]
    if 0.5 * t < clearance - offset < 0.7 * t:
        offset = 0.0
    tools = {}
    for kind, wider, radius in (("punch", 0.0, rng.uniform(4, 6)), ("die", clearance, rng.uniform(4, 6))):
        sizes = {
            key: (size + 2 * wider if isinstance(part, float) else [p * size + 2 * wider for p in part])
            for key, part in PLANS[plan].items()
        }
        tools[kind] = {"kind": kind, "shape": plan, "edge_radius": float(radius), **sizes}
        if plan == "rectangular":
            tools[kind]["corner_radius"] = 8.0 + wider
    if depth is not None:
        tools["die"] |= {"depth": float(depth), "bottom_radius": 2.0}
    if offset:
        tools["die"]["position"] = [offset, 0.0, -0.5 * t]
    blank = {"shape": "rectangle", "size": [100, 110], "thickness": t, "element_size": 10, "material": "steel"}
    stages = [{"name": "draw", "tools": {"punch": {"stroke": stroke}}}]
    case = {**CUP, "blank": blank, "tools": tools, "stages": stages}
    return Draw(case, clearance - offset >= 0.6 * t and (depth is None or stroke <= depth + 0.05 * t))


def judge(case: dict[str, Any]) -> bool:
    """Say whether a case is accepted; what is refused must be its punch or the stroke."""
    try:
        build_model(StampingCase.model_validate(case))
    except CaseError as error:
        if all(each.key in ("tools.punch", "stages.0.tools.punch.stroke") for each in error.problems):
            return False
        raise
    return True


def as_files(case: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the case with its tools as STL files."""
    read = {}
    for name, tool in StampingCase.model_validate(case).tools.items():
        shape = draw_shape(tool, 60.0, 90.0)  # type: ignore[arg-type]
        assert isinstance(shape, SweptProfile)
        points, triangles = triangulate(shape, 0.04, length=140.0)
        place = {"position": list(tool.position)} if tool.position is not None else {}
        read[name] = {"kind": tool.kind, **write_stl(folder / f"{name}.stl", points, triangles), **place}
    return {**case, "tools": read}


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(i, marks=pytest.mark.validation) for i in range(4, 60))])
def test_drawn_tools_and_their_facets_get_the_verdict_of_their_dimensions(seed: int, tmp_path: Path) -> None:
    draw = draw_by_seed(seed)
    assert judge(draw.case) == draw.is_possible
    assert judge(as_files(draw.case, tmp_path)) == draw.is_possible


def hat(stroke: float, pressure: float | None) -> dict[str, Any]:
    """A slice of a hot hat between a punch and a die that is 30 mm deep."""
    strip = {"shape": "strip", "edge_radius": 6}
    dwell = {"duration": 4, "place": "tools"} | ({} if pressure is None else {"pressure": pressure})
    steel = CUP["materials"]["steel"] | {"thermal": {"conductivity": 25, "specific_heat": "650 J/(kg*K)"}}
    return {
        **CUP,
        "blank": {"shape": "rectangle", "size": [170, 4], "thickness": 1.2, "element_size": [8, 4], "material": "steel",
                  "symmetry": ["x"]},
        "materials": {"steel": steel | {"density": "7830 kg/m^3"}},
        "heat": {"initial_temperature": 950},
        "tools": {"punch": {"kind": "punch", "width": 60, **strip},
                  "die": {"kind": "die", "width": 63.4, "depth": 30, "bottom_radius": 7, **strip}},
        "stages": [{"name": "form", "process_time": 1, "tools": {"punch": {"stroke": stroke}}},
                   {"name": "quench", "dwell": dwell}],
    }  # fmt: skip


def test_a_drawn_die_says_after_which_stroke_it_closes_and_what_is_left() -> None:
    """Bottom 30 mm below the face, sheet 1.2 mm: closed after 30 mm, a twentieth of the thickness allowed."""
    said = describe(build_model(StampingCase.model_validate(hat(28.75, None))))
    assert "punch and die close on the sheet when they have come 30.06 mm nearer" in said
    assert "the strokes bring them 28.75 mm nearer, which leaves the sheet 1.25 mm more than it is thick" in said
    with pytest.raises(CaseError, match=r"stages\.1\.dwell\.pressure = 5.0: .* are 1\.25 mm from closing.*after 30 mm"):
        build_model(StampingCase.model_validate(hat(28.75, 5)))
    assert "more than it is thick" not in describe(build_model(StampingCase.model_validate(hat(30, 5))))
    with pytest.raises(
        CaseError, match=r"stages\.0\.tools\.punch\.stroke = 31.0: after 30\.06 mm of stroke punch leaves"
    ):
        build_model(StampingCase.model_validate(hat(31, 5)))


@pytest.mark.parametrize(("velocity", "verdict"), [
    ("2 m/s", ""), ("12 m/s", ""), ("30 m/s", "warned"), ("100 m/s", "refused"), ("2000 m/s", "refused"),
])  # fmt: skip
def test_a_speed_at_which_the_sheet_is_thrown_is_refused(velocity: str, verdict: str, caplog) -> None:
    """Steel of 200 MPa: 7850 kg/m3 at 100 m/s carry 39 MPa, and 0.2 of strain takes 40."""
    case = StampingCase.model_validate(changed(CUP, ("stages.0.velocity", velocity)))
    if verdict == "refused":
        with pytest.raises(CaseError, match=r"stages\.0\.velocity"):
            build_model(case)
        return
    build_model(case)
    assert ("inertia forms it" in caplog.text) == (verdict == "warned")


def test_a_curved_holder_presses_what_lies_below_its_face(tmp_path: Path) -> None:
    """A ridge touches a flat blank of 60 mm by 80 mm along a line, and presses all of it once it has closed."""
    xs = np.linspace(-30, 30, 13)
    points = np.array([[x, y, x * x / 300] for x in xs for y in (-40.0, 40.0)])
    i = 2 * np.arange(12)
    faces = np.concatenate([np.column_stack([i, i + 1, i + 2]), np.column_stack([i + 1, i + 3, i + 2])])
    holder = {"kind": "holder", **write_stl(tmp_path / "holder.stl", points, faces)}
    blank = {"shape": "rectangle", "size": [60, 80], "thickness": 0.8, "element_size": 4, "material": "steel"}
    die = {"kind": "die", "shape": "strip", "width": 10, "edge_radius": 2}
    case = changed(CUP, ("tools", {"die": die, "holder": holder}), ("blank", blank),
                   ("stages", [{"name": "hold", "duration": 0.01, "tools": {"holder": {"force": 48e3}}}]))  # fmt: skip
    said = describe(build_model(StampingCase.model_validate(case)))
    pressure = float(said.split("pushes with 48000 N, at most ")[1].split()[0])
    assert pressure == pytest.approx(48e3 / (60 * 80), rel=0.1)
    with pytest.raises(CaseError, match="would press the flange with"):
        build_model(StampingCase.model_validate(changed(case, ("stages.0.tools.holder.force", "2 GN"))))
