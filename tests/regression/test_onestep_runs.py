# SPDX-License-Identifier: Apache-2.0
"""presswork onestep from a part's file to its folder; what it refuses, and with which status."""

import json
from pathlib import Path

import matplotlib.image
import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

from presswork.case import CaseError
from presswork.case.onestep.schema import OneStepCase
from presswork.cli import app
from presswork.results import Result
from tests.problems.one_step import cup_profile, fan, revolve

SHEET = ["--material", "numisheet93_mild_steel", "--thickness", "0.8 mm"]


@pytest.fixture(scope="module")
def part(tmp_path_factory) -> Path:
    points, quads = revolve(cup_profile(25.0, 5.0, 12.0, 36.0, 4.0), 32)
    path = tmp_path_factory.mktemp("part") / "cup.vtk"
    meshio.Mesh(points, [("triangle", fan(32)), ("quad", quads)]).write(path)
    return path


def fan_area(corners: np.ndarray) -> np.ndarray:
    """Return the areas of cells (n, corners, 3), cut from their first corner."""
    out = corners - corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(out[:, 1:-1], out[:, 2:]), axis=2).sum(axis=1)


def run(*words: object):
    return CliRunner().invoke(app, ["onestep", *map(str, words)])


def test_a_part_becomes_a_folder(part, tmp_path):
    done = run(part, *SHEET, "--bhf", "5 kN", "--output", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert "punch force" in done.output
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"results.vtkhdf", "history.csv", "summary.json", "blank.csv", "blank.dxf", "case.toml", "plots"} <= names
    result = Result(tmp_path / "out")
    blank, formed = result.points(0), result.points(-1)
    assert np.ptp(blank[:, 2]) == 0.0
    assert formed == pytest.approx(meshio.read(part).points, abs=1e-9)
    assert result.summary["punch_force_kN"] > 10.0
    volume = result.summary["blank"]["area_mm2"] * 0.8
    corners = [formed[b.connectivity] for b in result.mesh.blocks]
    areas = [fan_area(c) for c in corners]
    assert (np.concatenate(areas) * result.field("thickness")).sum() == pytest.approx(volume, rel=2e-3)
    assert "formability_zone" in result.field_names
    assert "Keeler" in result.summary["formability"]["forming_limit"]
    assert (tmp_path / "out" / "plots" / "forming_limit_001.png").is_file()
    loops = np.loadtxt(tmp_path / "out" / "blank.csv", delimiter=",", skiprows=1)
    assert len(loops) == 32


def test_the_case_it_leaves_gives_the_same(part, tmp_path):
    assert run(part, *SHEET, "--output", tmp_path / "one", "--no-plot").exit_code == 0
    again = CliRunner().invoke(
        app, ["run", str(tmp_path / "one" / "case.toml"), "--output", str(tmp_path / "two"), "--no-plot", "--quiet"]
    )
    assert again.exit_code == 0, again.output
    assert Result(tmp_path / "one").points(0).tobytes() == Result(tmp_path / "two").points(0).tobytes()
    told = CliRunner().invoke(app, ["check", str(tmp_path / "one" / "case.toml")])
    assert told.exit_code == 0
    assert "32 triangles and" in told.output


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--thickness", "0.8"], "--material"),
        (["--material", "dc99", "--thickness", "0.8"], "the library has no material"),
        (["--material", "numisheet93_mild_steel", "--thickness", "-1"], "blank.thickness"),
        (["--material", "numisheet93_mild_steel", "--thickness", "0.8 kN"], "blank.thickness"),
        ([*SHEET, "--unit", "furlong"], "part.unit"),
        ([*SHEET, "--unit", "um"], "another unit"),
        ([*SHEET, "--draw-direction", "up"], "part.draw_direction"),
        ([*SHEET, "--mu", "-0.1"], "process.mu"),
        ([*SHEET, "--bhf", "5 mm"], "process.holder_force"),
        ([*SHEET, "--symmetry", "x"], "both sides"),
        ([*SHEET, "--addendum", "-3"], "part.addendum"),
        ([*SHEET, "--stages", "12"], "--stages"),
    ],
)
def test_bad_input_is_refused(part, tmp_path, words, said):
    done = run(part, *words, "--output", tmp_path / "out", "--no-plot")
    assert done.exit_code in (2, 3), done.output
    assert said in done.output
    assert "Traceback" not in done.output


def test_stages_come_from_the_command_line_and_from_the_case(part, tmp_path):
    """This part has no wall that could be raised: the summary says that the blank is that of one step."""
    done = run(part, *SHEET, "--stages", "3", "--output", tmp_path / "out", "--no-plot")
    assert done.exit_code == 0, done.output
    assert "stages = 3" in (tmp_path / "out" / "case.toml").read_text()
    told = Result(tmp_path / "out").summary
    assert told["stages"] == 1
    assert any("the stages were left out" in warning for warning in told["warnings"])


def test_resume_is_refused_and_keeps_what_is_there(part, tmp_path):
    assert run(part, *SHEET, "--output", tmp_path / "out", "--no-plot").exit_code == 0
    case = str(tmp_path / "out" / "case.toml")
    again = CliRunner().invoke(app, ["run", case, "--output", str(tmp_path / "out"), "--resume"])
    assert again.exit_code == 2
    assert (tmp_path / "out" / "blank.dxf").is_file()
    assert Result(tmp_path / "out").summary["status"] == "completed"


def test_options_beside_a_case_file_are_refused(part, tmp_path):
    assert run(part, *SHEET, "--output", tmp_path / "out", "--no-plot").exit_code == 0
    case = tmp_path / "out" / "case.toml"
    done = run(case, "--bhf", "20 kN", "--element-size", "2", "--output", tmp_path / "other")
    assert done.exit_code == 2
    assert "--bhf (process.holder_force), --element-size (part.element_size)" in done.output
    assert not (tmp_path / "other").exists()


def test_an_addendum_gives_the_holder_a_flange(tmp_path):
    """A cup that ends at its shoulder has the blank of the cup with a flange of that width, holder and all."""
    corner = 30.0 + 12.0 / np.cos(np.pi / 48)  # of the outline, whose edges move out by 12 mm
    points, quads = revolve(cup_profile(25.0, 5.0, 12.0, corner, 4.1), 48)
    cells = [("triangle", fan(48)), ("quad", quads)]
    meshio.Mesh(points, cells).write(tmp_path / "whole.vtk")
    inside = np.linalg.norm(points[:, :2], axis=1) < 30.0 + 1e-9
    kept = quads[inside[quads].all(axis=1)]
    meshio.Mesh(points[inside], [("triangle", fan(48)), ("quad", kept)]).write(tmp_path / "cut.vtk")
    wanted = ("--bhf", "5 kN", "--no-plot", "--output")
    assert run(tmp_path / "whole.vtk", *SHEET, *wanted, tmp_path / "whole").exit_code == 0
    done = run(tmp_path / "cut.vtk", *SHEET, "--addendum", "12 mm", *wanted, tmp_path / "cut")
    assert done.exit_code == 0, done.output
    assert "12 mm wide was added" in done.output
    whole, cut = (Result(tmp_path / name).summary for name in ("whole", "cut"))
    assert cut["blank"]["area_mm2"] == pytest.approx(whole["blank"]["area_mm2"], rel=1e-6)
    assert cut["punch_force_kN"] == pytest.approx(whole["punch_force_kN"], rel=1e-6)
    assert run(tmp_path / "cut.vtk", *SHEET, "--output", tmp_path / "bare", "--no-plot").exit_code == 0
    assert Result(tmp_path / "bare").summary["blank"]["area_mm2"] < 0.7 * cut["blank"]["area_mm2"]


def test_a_file_that_is_not_there(tmp_path):
    done = run(tmp_path / "no.stl", *SHEET)
    assert done.exit_code == 2
    assert "no such file" in done.output


def test_a_law_without_closed_form_is_refused(part, tmp_path):
    done = run(part, "--material", "aa5754_o", "--thickness", "1", "--output", tmp_path / "out")
    assert done.exit_code == 2
    assert "hill1948" in done.output


def test_hills_function_stands_for_yld2000(part, tmp_path):
    done = run(part, "--material", "aa6016_t4", "--thickness", "1", "--output", tmp_path / "out", "--no-plot")
    assert done.exit_code == 0, done.output
    (warning,) = [w for w in Result(tmp_path / "out").summary["warnings"] if "yld2000" in w]
    assert warning == "one step takes Hill's yield function of the r-values in place of yld2000"


def test_the_blank_starts_a_stamping(part, tmp_path):
    """The case is drawn as it stands, from the outline that one step has found, by tools of the part's surface."""
    case = tmp_path / "stamping.toml"
    words = [
        part,
        *SHEET,
        "--bhf",
        "5 kN",
        "--mu",
        "0.12",
        "--rolling",
        "30",
        "--output",
        tmp_path / "one",
        "--no-plot",
    ]
    assert run(*words, "--write-case", case).exit_code == 0
    checked = CliRunner().invoke(app, ["check", str(case)])
    assert checked.exit_code == 0, checked.output
    for said in ("0.8 mm of numisheet93_mild_steel", "rolling direction: 30 degrees", "5000 N", "punch moves by 12"):
        assert said in checked.output
    assert run(*words, "--overwrite", "--write-case", case).exit_code == 0, "the tools are replaced with it"
    case.unlink()
    again = run(*words, "--overwrite")
    assert again.exit_code == 0
    refused = run(*words[:-2], tmp_path / "two", "--no-plot", "--write-case", case)
    assert refused.exit_code == 2
    assert "stamping_punch.stl is there already" in refused.output
    assert run(*words, "--overwrite", "--write-case", case).exit_code == 0
    short = ["--set", "stages.0.velocity=10000", "--set", "blank.element_size=6", "--set", "output.rows=1", "--set",
             "output.steps=1", "--set", "stages.0.tools.punch.stroke=1"]  # fmt: skip
    done = CliRunner().invoke(
        app, ["run", str(case), *short, "--output", str(tmp_path / "drawn"), "--no-plot", "--quiet"]
    )
    assert done.exit_code == 0, done.output
    edge = np.loadtxt(tmp_path / "one" / "blank.csv", delimiter=",", skiprows=1)[:, 1:]
    one, both = (json.loads((tmp_path / name / "summary.json").read_text())["formability"] for name in ("one", "drawn"))
    assert both["one_step_thinning_percent"] == pytest.approx(one["largest_thinning_percent"]["value"], rel=1e-3)
    drawn = Result(tmp_path / "drawn")
    rim = drawn.mesh.points[np.unique(drawn.mesh.boundary_edges[:, :2])]
    corner, radius = np.arctan2(edge[:, 1], edge[:, 0]), np.linalg.norm(edge, axis=1)
    expected = np.interp(np.arctan2(rim[:, 1], rim[:, 0]), corner, radius, period=2 * np.pi)
    assert np.linalg.norm(rim[:, :2], axis=1) == pytest.approx(expected, rel=6e-3), "chords of 32 corners"


@pytest.mark.parametrize(
    ("name", "said"), [("case.csv", ".toml"), ("no/case.toml", "no folder"), ("old.toml", "--overwrite")]
)
def test_a_case_that_cannot_be_written_is_refused_before_computing(part, tmp_path, name, said):
    (tmp_path / "old.toml").touch()
    done = run(part, *SHEET, "--output", tmp_path / "out", "--write-case", tmp_path / name)
    assert done.exit_code == 2
    assert said in done.output
    assert not (tmp_path / "out").exists()


def trough(lean: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a trough along y whose walls lean out by so much [mm], of triangles."""
    x = np.array([-40.0, -20.0 - lean, -20.0, 20.0, 20.0 + lean, 40.0])
    points = np.array([[a, b, c] for a, c in zip(x, [10.0, 10.0, 0.0, 0.0, 10.0, 10.0], strict=True) for b in (0, 30)])
    index = np.arange(12).reshape(6, 2)
    quads = np.stack([index[:-1, 0], index[1:, 0], index[1:, 1], index[:-1, 1]], axis=-1)
    return points, quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)


def write_stl(path: Path, lean: float = 5.0, scale: float = 1.0, *, binary: bool = True) -> Path:
    points, triangles = trough(lean)
    meshio.Mesh(points * scale, [("triangle", triangles)]).write(path, binary=binary)
    return path


def test_an_undercut_leaves_a_picture(tmp_path):
    done = run(write_stl(tmp_path / "part.stl", -5.0), *SHEET, "--output", tmp_path / "out")
    assert done.exit_code == 2
    assert "undercut" in done.output
    picture = tmp_path / "out" / "undercut.png"
    assert str(picture) in done.output
    assert matplotlib.image.imread(picture).shape[0] > 300
    red, green = (matplotlib.image.imread(picture)[..., k] for k in (0, 1))
    assert (red > green + 0.3).mean() > 0.005, "what is undercut is red"


@pytest.mark.parametrize(
    ("binary", "keep", "said"),
    [(True, 0.5, "cut short"), (False, 0.5, "cut short"), (True, 0.0, "the file is empty")],
)
def test_a_truncated_stl_is_refused(tmp_path, binary, keep, said):
    path = write_stl(tmp_path / "part.stl", binary=binary)
    content = path.read_bytes()
    path.write_bytes(content[: int(keep * len(content))])
    done = run(path, *SHEET)
    assert done.exit_code == 2
    assert said in done.output
    assert "part.path = " in done.output


def test_a_part_of_a_twentieth_of_a_millimetre_is_refused(tmp_path):
    done = run(write_stl(tmp_path / "part.stl", scale=0.05 / 80), *SHEET)
    assert done.exit_code == 2
    assert 'part.unit = "mm"' in done.output


def test_missing_thickness_is_named(part):
    done = run(part, "--material", "dc04")
    assert done.exit_code == 2
    assert "--thickness" in done.output
    assert "--material" not in done.output


@pytest.mark.parametrize(
    ("material", "key"),
    [
        ({"damage": {"critical": 0.3}}, "damage"),
        ({"library": "dc04", "damage": {"critical": 0.3}}, "damage"),
        ({"library": "dc04", "rate": {"law": "cowper_symonds", "D": 40, "q": 5}}, "rate"),
    ],
)
def test_what_one_step_cannot_use_is_refused(part, material, key):
    """Beside a material of the library, too, whose own keys that it cannot use are not heeded."""
    steel = {"young": 206e3, "poisson": 0.3, "hardening": {"law": "swift", "K": 565, "e0": 0.007, "n": 0.26}}
    data = {
        "title": "cup",
        "analysis": "onestep",
        "part": {"path": str(part)},
        "blank": {"material": "steel", "thickness": 0.8},
        "materials": {"steel": material if "library" in material else steel | material},
    }
    with pytest.raises(CaseError, match="one step has no") as error:
        OneStepCase.from_data(data)
    assert [problem.key for problem in error.value.problems] == [f"materials.steel.{key}"]
