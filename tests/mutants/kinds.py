# SPDX-License-Identifier: Apache-2.0
"""A valid file of every kind that the program reads, and the way that it is read."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
import tomli_w
from typer.testing import CliRunner

from presswork.case import CaseError, build_model, read_case
from presswork.case.description import describe
from presswork.case.material.forming_limit.build import build_formability
from presswork.case.material.library import read_sheet
from presswork.cli import app
from presswork.examples import copy_example
from presswork.mesh.make.structured import mesh_rectangle
from presswork.model import Model
from presswork.onestep.part import OneStepError
from presswork.outcome import StartError
from presswork.process.begin import check_start
from presswork.recorder import run_model
from presswork.results import OutputError, Result
from presswork.study.measured import read_measured
from tests.unit.case.round_cup import CUP, changed
from tests.unit.mesh.test_readers import FORMATS

REFUSALS = (CaseError, StartError, OutputError, OneStepError)
"""What says in words that a file is refused."""


@dataclass(frozen=True)
class Kind:
    """Files of one kind."""

    name: str
    """Of the file that is changed, in a folder with what goes with it."""
    make: Callable[[Path], None]
    """Write the valid file and what goes with it."""
    read: Callable[[Path], object]
    """Read it as the program would; raises one of REFUSALS."""
    share: float = 1.0
    """Of the mutants, relative to other kinds: few where a mutant takes long."""


SOLID = """
title = "billet"
analysis = "plane_strain"
[workpiece]
material = "steel"
element = "{element}"
mesh = {mesh}
[materials.steel]
young = "200 GPa"
poisson = 0.3
hardening = {{ law = "voce", yield_stress = 200, saturation_stress = 400, rate = 5 }}
[tools.punch]
{tool}
contact = "coulomb"
mu = 0.1
[boundary.floor]
set = "bottom"
fix = ["x", "y"]
[[stages]]
name = "upset"
tools.punch = {{ stroke = 2, direction = [0, -1] }}
[[stages]]
name = "pull"
displacement = [{{ set = "top", component = "y", value = 0.1 }}]
force = [{{ set = "right", value = [1, "2 kN"] }}]
pressure = [{{ set = "right", value = 3 }}]
[solver]
max_increment = 0.1
[output]
steps = 2
"""
RECTANGLE = "{ size = [10, 15], cells = [2, 3], grading = [1, 2] }"
PROFILE = "profile = [[-5, 15], { to = [15, 15], radius = 2 }, [20, 20]]"
SHELL = """
title = "strip"
analysis = "shell"
[workpiece]
material = "steel"
element = "shell4_mitc_plus"
section = { thickness = 0.8, points = 5 }
mesh = { size = [20, 10], cells = [2, 1], roll_radius = 50 }
[materials.steel]
library = "numisheet93_mild_steel"
kinematic = { law = "chaboche", C = [4000, 500], gamma = [20, 0] }
[boundary.grip]
set = "left"
hold = "clamped"
[[stages]]
name = "bend"
rotation = [{ set = "right", axis = "y", angle = 10 }]
[[stages]]
name = "load"
force = [{ set = "right", value = [1, 0, 0], moment = [0, 1, 0] }]
edge_force = [{ set = "right", value = [0, 0, 1] }]
pressure = [{ set = "all", value = 0.1 }]
body_force = [{ value = [0, 0, 1e-4] }]
"""
MATERIAL = """
name = "my steel"
summary = "what it is"
thickness = 0.8
[material]
young = "206 GPa"
poisson = 0.3
yield_function = { law = "hill1948", r00 = 1.79, r45 = 1.51, r90 = 2.27 }
hardening = { law = "swift", K = 565.32, e0 = 0.007117, n = 0.2589 }
rate = { law = "cowper_symonds", D = 40, q = 5 }
young_decrease = { saturated = "160 GPa", rate = 60 }
forming_limit = { law = "keeler", thickness = 0.8, n = 0.2589 }
[sources]
all = "where the numbers come from"
"""


def _case(path: Path) -> None:
    """Go all the way that `presswork check` goes."""
    case = read_case(path)
    model = build_model(case)
    describe(model)
    if isinstance(model, Model) and sum(len(block.connectivity) for block in model.mesh.blocks) < 2000:
        check_start(model)


def _beside(name: str, case: str) -> Callable[[Path], object]:
    return lambda path: _case(path.with_name(case)) if path.name == name else None


def _text(name: str, text: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).write_text(text) and None


def _solid(folder: Path, mesh: str = RECTANGLE, tool: str = PROFILE, element: str = "quad4_fbar") -> None:
    (folder / "case.toml").write_text(SOLID.format(mesh=mesh, tool=tool, element=element))


def _with_mesh(ending: str) -> Kind:
    def make(folder: Path) -> None:
        x, y = np.array([0.0, 4.0, 10.0]), np.array([0.0, 5.0, 10.0, 15.0])
        FORMATS[ending](folder / f"m.{ending}", mesh_rectangle(x, y, element="quad4"))
        _solid(folder, mesh=f'{{ path = "m.{ending}" }}')

    return Kind(f"m.{ending}", make, _beside(f"m.{ending}", "case.toml"))


def _with_profile(name: str, write: Callable[[Path], None]) -> Kind:
    def make(folder: Path) -> None:
        write(folder / name)
        _solid(folder, tool=f'profile_file = "{name}"')

    return Kind(name, make, _beside(name, "case.toml"))


def _write_profile(path: Path) -> None:
    x = np.linspace(-5.0, 20.0, 12)
    path.write_text("x, y\n" + "".join(f"{a:g}, {15.0 + 0.001 * a * a:g}\n" for a in x))


def _write_drawing(path: Path) -> None:
    """Write a short drawing: what is changed is then mostly what is read."""
    line = "LINE 8 0 10 -5 20 15 30 0 11 10 21 15 31 0"
    arc = "ARC 8 0 10 10 20 20 30 0 40 5 50 270 51 360"
    knots = "".join(f" 40 {k}" for k in (0, 0, 0, 0, 1, 1, 1, 1))
    points = "".join(f" 10 {x} 20 {y} 30 0" for x, y in ((15, 20), (15, 22), (18, 23), (20, 26)))
    spline = f"SPLINE 8 0 100 AcDbEntity 100 AcDbSpline 70 8 71 3 72 8 73 4 74 0{knots}{points}"
    ellipse = "ELLIPSE 8 0 100 AcDbEntity 100 AcDbEllipse 10 20 20 30 30 0 11 0 21 -4 31 0 40 0.5 41 0 42 1.570796"
    bulge = "LWPOLYLINE 8 0 100 AcDbEntity 100 AcDbPolyline 90 2 70 0 10 22 20 30 42 0.2 10 25 20 30"
    _write_dxf(path, line, arc, spline, ellipse, bulge)


def _write_dxf(path: Path, *entities: str) -> None:
    """Write entities, each of words that are group codes and values in turn."""
    header = "SECTION 2 HEADER 9 $ACADVER 1 AC1015 9 $INSUNITS 70 4 0 ENDSEC"
    words = f"0 {header} 0 SECTION 2 ENTITIES 0 {' 0 '.join(entities)} 0 ENDSEC 0 EOF".split()
    path.write_text("\n".join(words) + "\n")


def _cup(folder: Path, *changes: tuple[str, object]) -> None:
    data = changed(CUP, ("blank.element_size", 12), ("trim", {"edge": {"shape": "circle", "diameter": 90}}), *changes)
    (folder / "case.toml").write_text(tomli_w.dumps(data))


def _with_outline(name: str, write: Callable[[Path], None]) -> Kind:
    def make(folder: Path) -> None:
        write(folder / name)
        blank = {**CUP["blank"], "shape": "outline", "path": name, "element_size": 12}
        blank.pop("diameter")
        _cup(folder, ("blank", blank))

    return Kind(name, make, _beside(name, "case.toml"), 0.7)


def _write_outline(path: Path) -> None:
    turn = np.radians(np.arange(0, 360, 15))
    path.write_text("loop,x_mm,y_mm\n" + "".join(f"0,{45 * np.cos(t):.4f},{45 * np.sin(t):.4f}\n" for t in turn))


def _write_outline_drawing(path: Path) -> None:
    corners = "".join(f" 10 {x} 20 {y}" for x, y in ((45, 45), (-45, 45), (-45, -45), (45, -45)))
    _write_dxf(path, f"LWPOLYLINE 8 0 100 AcDbEntity 100 AcDbPolyline 90 4 70 1{corners}", "POINT 8 0 10 0 20 0 30 0")


def _box(path: Path, *, binary: bool, open_below: bool = False, unit: float = 1.0) -> None:
    """Write a block of 60 x 60 x 20 mm; open below it is a pan."""
    corners = np.array([[x, y, z] for z in (0, 20) for y in (-30, 30) for x in (-30, 30)], dtype=float) * unit
    quads = [[4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]]
    quads += [] if open_below else [[0, 2, 3, 1]]
    cells = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    meshio.Mesh(corners, [("triangle", cells)]).write(path, binary=binary)


def _with_tool(name: str, *, binary: bool) -> Kind:
    def make(folder: Path) -> None:
        _box(folder / name, binary=binary)
        _cup(
            folder,
            ("tools.punch", {"kind": "punch", "shape": "file", "path": name}),
            ("tools.die.diameter", 90), ("tools.holder.diameter", 90),
        )  # fmt: skip

    return Kind(name, make, _beside(name, "case.toml"), 0.7)


def _write_pan(folder: Path) -> None:
    """Write a shallow dish of triangles, and a one-step case of it."""
    rings, turn = np.array([0.0, 15.0, 25.0, 35.0, 45.0]), np.radians(np.arange(0, 360, 30))
    heights = [0.0, 0.0, 3.0, 6.0, 6.0]
    points = [[0.0, 0.0, 0.0]]
    points += [[r * np.cos(t), r * np.sin(t), h] for r, h in zip(rings[1:], heights[1:], strict=True) for t in turn]
    n = len(turn)
    cells = [[0, 1 + k, 1 + (k + 1) % n] for k in range(n)]
    for ring in range(3):
        for k in range(n):
            a, b = 1 + ring * n + k, 1 + ring * n + (k + 1) % n
            cells += [[a, a + n, b], [b, a + n, b + n]]
    meshio.Mesh(np.array(points), [("triangle", np.array(cells))]).write(folder / "pan.stl", binary=False)
    (folder / "case.toml").write_text(
        'title = "pan"\nanalysis = "onestep"\npart = { path = "pan.stl", element_size = 20 }\n'
        'blank = { material = "numisheet93_mild_steel", thickness = 0.8 }\n'
        '[process]\nholder_force = "10 kN"\nmu = 0.1\n'
        'beads = [{ points = [[-20, 40], [20, 40]], force = "80 N/mm" }]\n'
    )


def _write_tensile(folder: Path) -> None:
    strain = np.linspace(0.002, 0.2, 15)
    rows = [f"{a},{e:.5f},{500 * (0.01 + e) ** 0.2:.3f},{-0.4 * e:.5f}" for a in (0, 45, 90) for e in strain]
    (folder / "tensile.csv").write_text("angle,strain,stress,width_strain\n" + "\n".join(rows) + "\n")


def _read_tensile(path: Path) -> None:
    fitted = path.with_suffix(".toml")
    told = CliRunner().invoke(app, ["material", "fit", str(path), "--young", "206 GPa", "--output", str(fitted)])
    fitted.unlink(missing_ok=True)
    if told.exception is not None and not isinstance(told.exception, SystemExit):
        raise told.exception
    if told.exit_code:
        raise OutputError(told.output)


def _read_material(path: Path) -> None:
    sheet = read_sheet(path)
    sheet.material.build_law()
    build_formability(sheet.material, "material", sheet.thickness or 1.0)


def _write_rings(folder: Path) -> None:
    (folder / "rings.csv").write_text("height_reduction_percent,bore_diameter_mm\n10,9.8\n20,9.5\n30,9.1\n50,8\n")


_SHORT = ["stages.0.tools.punch.stroke=0.1", "solver.max_increment=0.5", "output.checkpoint_every=1"]


def _write_run(folder: Path) -> None:
    """Write the results of a billet, upset in two increments, stopped after one."""
    _solid(folder)
    run_model(build_model(read_case(folder / "case.toml", _SHORT)), folder / "out", threads=1)


def _read_results(path: Path) -> None:
    """Read all that pictures and users read."""
    result = Result(path.parent)
    _ = result.summary, result.info, result.formability, result.history, result.surfaces, result.is_shell
    for step in range(len(result.times)):
        mesh = result.mesh_at(step)
        assert len(mesh.points) == len(result.points(step))
        for name in result.field_names:
            result.field(name, step)
            result.unit(name)
        for tool in result.tools:
            result.placed_tool(tool, step)


def _resume(path: Path) -> None:
    """Go on from a checkpoint, in a copy: a run writes."""
    folder = path.parent.with_name("resumed")
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(path.parent, folder)
    run_model(build_model(read_case(path.parent.with_name("case.toml"), _SHORT)), folder, resume=True, threads=1)


def _example(name: str) -> Callable[[Path], None]:
    return lambda folder: copy_example(name, folder).rename(folder / "case.toml") and None


KINDS: dict[str, Kind] = {
    "solid case": Kind("case.toml", _solid, _case, 2.5),
    "bodies case": Kind("case.toml", _example("two_bodies"), _case, 1.5),
    "impact case": Kind("case.toml", _example("taylor_bar"), _case, 1.5),
    "shell case": Kind("case.toml", _text("case.toml", SHELL), _case, 1.5),
    "stamping case": Kind("case.toml", _cup, _case, 1.5),
    "onestep case": Kind("case.toml", _write_pan, _case, 1.0),
    "gmsh": _with_mesh("msh"),
    "abaqus": _with_mesh("inp"),
    "ideas": _with_mesh("unv"),
    "vtk": _with_mesh("vtk"),
    "vtu": _with_mesh("vtu"),
    "profile text": _with_profile("p.csv", _write_profile),
    "profile dxf": _with_profile("p.dxf", _write_drawing),
    "outline csv": _with_outline("b.csv", _write_outline),
    "outline dxf": _with_outline("b.dxf", _write_outline_drawing),
    "tool stl": _with_tool("t.stl", binary=False),
    "tool stl binary": _with_tool("t.stl", binary=True),
    "part stl": Kind("pan.stl", _write_pan, _beside("pan.stl", "case.toml")),
    "tensile": Kind("tensile.csv", _write_tensile, _read_tensile),
    "rings": Kind("rings.csv", _write_rings, lambda path: read_measured(path, 10.0)),
    "material": Kind("m.toml", _text("m.toml", MATERIAL), _read_material),
    "results": Kind("out/results.vtkhdf", _write_run, _read_results, 2.0),
    "history": Kind("out/history.csv", _write_run, _read_results, 0.5),
    "summary": Kind("out/summary.json", _write_run, _read_results, 0.5),
    "checkpoint": Kind("out/checkpoint.h5", _write_run, _resume, 0.5),
}
