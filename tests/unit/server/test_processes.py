# SPDX-License-Identifier: Apache-2.0
"""Each process of a new case becomes a sound case of what was answered, and says what an answer lacks."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from presswork.case import build_model, read_case
from presswork.geometry.pose import start_profile
from presswork.server.drafts import Drafts
from presswork.server.opened_folder import OpenedFolder, RefusedError
from presswork.server.processes import PROCESSES
from presswork.server.processes.metals import COLD, HOT, SHEETS
from tests.problems.cup_surface import write_cup_tools

OTHERS: dict[str, dict[str, str]] = {
    "closed_die": {"diameter": "60", "height": "50 mm", "material": "aa6061_o", "stroke": "11,5"},
    "closed_die_hot": {"material": "aa6082_hot", "temperature": "480 °C", "diameter": "5 cm", "height": "30"},
    "closed_die_3d": {"diameter": "60", "height": "42", "part": "half", "stroke": "9"},
    "extrusion": {"diameter": "60", "length": "70", "product": "30", "angle": "60", "stroke": "30"},
    "rolling": {"before": "40", "after": "32", "roll": "800", "mu": "0.3"},
    "wire_drawing": {"before": "2", "after": "1.7", "angle": "6"},
    "shrink_fit": {"shaft": "100", "outer": "180", "width": "60", "interference": "0.15", "temperature": "350"},
    "cylindrical_cup": {"diameter": "80", "thickness": "0.8", "punch": "40", "edge": "5", "depth": "12", "force": "8"},
    "tools_from_files": {"length": "95", "width": "90", "depth": "10"},
    "rail": {"length": "300", "thickness": "1.5", "material": "dp600", "punch": "80", "edge": "6", "depth": "50"},
    "cup_line": {"diameter": "120", "punch": "60", "edge": "8", "depth": "15", "rim": "105", "hole": "30"},
    "hot_stamping": {"length": "200", "thickness": "1.2", "temperature": "930", "punch": "80", "depth": "25"},
    "one_step": {"material": "dc05", "thickness": "0.8", "force": "20"},
}
FILES = {"punch": "punch.stl", "die": "die.stl", "holder": "holder.stl", "part": "part.stl"}


@pytest.fixture
def drafts(tmp_path: Path) -> Iterator[Drafts]:
    for name in ("cases", "scratch"):
        (tmp_path / name).mkdir()
    write_cup_tools(tmp_path / "cases")
    made = Drafts(OpenedFolder(tmp_path / "cases"), tmp_path / "scratch")
    yield made
    made.close()


def asked_files(key: str) -> dict[str, str]:
    asks = [ask for question in PROCESSES[key].questions for ask in question.asks]
    return {ask.key: FILES[ask.key] for ask in asks if ask.what == "file" and ask.key in FILES}


@pytest.mark.parametrize("has_others", [False, True])
@pytest.mark.parametrize("key", list(PROCESSES))
def test_answers_make_a_sound_case(drafts: Drafts, tmp_path: Path, key: str, has_others: bool) -> None:
    name = drafts.set_up(
        key, "mine", {**asked_files(key), **(OTHERS[key] if has_others or key == "tools_from_files" else {})}
    )
    model = build_model(read_case(tmp_path / "cases" / name))
    assert model.title == "mine"


@pytest.mark.parametrize("material", COLD)
@pytest.mark.parametrize("key", ["closed_die", "closed_die_3d", "extrusion", "rolling", "wire_drawing"])
def test_every_metal_offered_makes_a_sound_case(drafts: Drafts, tmp_path: Path, key: str, material: str) -> None:
    build_model(read_case(tmp_path / "cases" / drafts.set_up(key, "mine", {"material": material})))


@pytest.mark.parametrize("material", HOT)
def test_every_hot_metal_offered_makes_a_sound_case(drafts: Drafts, tmp_path: Path, material: str) -> None:
    build_model(read_case(tmp_path / "cases" / drafts.set_up("closed_die_hot", "mine", {"material": material})))


@pytest.mark.parametrize("material", SHEETS)
def test_every_sheet_offered_makes_a_sound_case(drafts: Drafts, tmp_path: Path, material: str) -> None:
    build_model(read_case(tmp_path / "cases" / drafts.set_up("cylindrical_cup", "mine", {"material": material})))


def test_answers_are_those_of_the_model(drafts: Drafts, tmp_path: Path) -> None:
    name = drafts.set_up("extrusion", "mine", OTHERS["extrusion"])
    model = build_model(read_case(tmp_path / "cases" / name))
    np.testing.assert_allclose(np.ptp(model.mesh.points, axis=0), [30.0, 70.0])
    die = start_profile(next(tool for tool in model.plane_tools if tool.name == "die"))
    assert die[:, [0, 2]].min() == pytest.approx(15.0)
    slopes = np.degrees(np.arctan2(np.abs(die[:, 2] - die[:, 0]), np.abs(die[:, 3] - die[:, 1])))
    assert np.abs(slopes[die[:, 6] == 0.0] - 60.0).min() < 1e-3


def test_dies_of_two_drawings_touch_the_whole_billet(drafts: Drafts, tmp_path: Path) -> None:
    for name, points in (("upper", [(0, 90), (40, 90), (44, 80), (90, 80)]), ("lower", [(0, -7), (40, -7), (90, 1)])):
        drawing = ezdxf.new()
        drawing.header["$INSUNITS"] = 4
        drawing.modelspace().add_lwpolyline(points)
        drawing.saveas(tmp_path / "cases" / f"{name}.dxf")
    given = {"diameter": "60", "height": "50", "upper": "upper.dxf", "lower": "lower.dxf"}
    model = build_model(read_case(tmp_path / "cases" / drafts.set_up("closed_die_hot", "mine", given)))
    upper, lower = (start_profile(tool) for tool in model.plane_tools)
    assert upper[:, [1, 3]].max() == pytest.approx(50.0, abs=1e-6)
    assert lower[:, [1, 3]].min() == pytest.approx(0.0, abs=1e-6)
    assert np.ptp(model.mesh.points, axis=0) == pytest.approx([30.0, 50.0])


@pytest.mark.parametrize(
    ("key", "given", "fault"),
    [
        ("extrusion", {"product": "25"}, "Product diameter: must be below"),
        ("rolling", {"after": "1"}, "Friction: .* take in at most 2.25 mm"),
        ("shrink_fit", {"temperature": "100"}, "Temperature: the ring goes over the shaft only above 271 °C"),
        ("wire_drawing", {"before": "thick"}, "Diameter before: expected a length"),
        ("cylindrical_cup", {"punch": "120"}, "Diameter of the blank: must be above the die's opening"),
        ("tools_from_files", {}, "Punch: choose a file"),
        ("closed_die", {"height": "-3"}, "Height: must be above 0"),
    ],
)
def test_what_an_answer_lacks_is_said(drafts: Drafts, tmp_path: Path, key: str, given: Any, fault: str) -> None:
    with pytest.raises(RefusedError, match=fault):
        drafts.set_up(key, "mine", given)
    assert not (tmp_path / "cases" / "mine.toml").exists()


def test_comments_of_the_starter_stay(drafts: Drafts, tmp_path: Path) -> None:
    text = (tmp_path / "cases" / drafts.set_up("rail", "mine", OTHERS["rail"])).read_text("utf-8")
    assert "# a quarter is computed" in text
    assert tomllib.loads(text)["tools"]["die"]["width"] == pytest.approx(80 + 2.25 * 1.5)
