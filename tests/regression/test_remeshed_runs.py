# SPDX-License-Identifier: Apache-2.0
"""Runs whose mesh changes: from case to results, the same bits, resumed in between, every key with an effect."""

from dataclasses import replace
from itertools import zip_longest

import numpy as np
import pytest

from presswork import Case, CaseError, build_model
from presswork.case.description import describe
from presswork.examples import copy_example
from presswork.mesh.checks import MeshError
from presswork.mesh.topology import find_boundary_edges
from presswork.outcome import GaveUpError, StartError
from presswork.post import measure_die_fill
from presswork.process.begin import begin
from presswork.process.implicit import bodies_in_plane, new_meshes
from presswork.process.implicit.begin_forming import begin_forming
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.recorder import run_model
from presswork.results import Result, read_history

HEIGHT = 15.0
ROUNDED = {"profile": [[0, HEIGHT], {"to": [6, HEIGHT], "radius": 0.4}, [6, 30]], "contact": "frictionless"}


def upsetting(stroke=4.5, cells=(8, 12), remesh=None, contact=None, **changes):
    """The quarter section of a billet under a flat platen."""
    tool = {"profile": [[0, HEIGHT], [40, HEIGHT]], **(contact or {"contact": "shear", "m": 0.15})}
    return Case(
        **{
            "title": "upsetting",
            "analysis": "axisymmetric",
            "workpiece": {"material": "steel", "mesh": {"size": [10, HEIGHT], "cells": cells}},
            "materials": {
                "steel": {
                    "young": 2e5,
                    "poisson": 0.3,
                    "hardening": {"law": "linear", "yield_stress": 700, "modulus": 300},
                }
            },
            "tools": {"punch": tool},
            "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
            "stages": [{"name": "press", "tools": {"punch": {"stroke": stroke, "direction": [0, -1]}}}],
            "output": {"steps": 3},
            "remesh": remesh,
        }
        | changes
    )


@pytest.fixture(scope="module")
def remeshed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("remeshed") / "run"
    assert run_model(build_model(upsetting(remesh={"every": 0.2})), folder, threads=1).status == "completed"
    return folder


def test_history_counts_cells_and_meshes_and_steps_keep_theirs(remeshed):
    result, history = Result(remeshed), read_history(remeshed / "history.csv")
    assert history["remeshes"][-1] == result.summary["remeshes"] == 4
    assert len(np.unique(history["cells"])) > 1
    meshes = [len(result.mesh_at(step).blocks[0].connectivity) for step in range(len(result.times))]
    assert meshes[0] == 96
    assert meshes[-1] == history["cells"][-1]
    for step in range(len(result.times)):
        x, y = result.points(step).T
        top = HEIGHT - result.tool_displacement("punch", step)[1] * -1
        assert y.max() == pytest.approx(top, abs=1e-6)
        assert x.min() == 0.0
        assert y.min() == 0.0


def test_displacements_count_from_the_start_of_the_run(remeshed):
    """The results' points are where the material was: they fill the billet as it was, and follow its flow."""
    result = Result(remeshed)
    start = result.mesh_at(-1).points
    assert start.min() > -0.05
    assert start[:, 0].max() == pytest.approx(10, abs=0.05)
    assert start[:, 1].max() == pytest.approx(HEIGHT, abs=0.05)
    moved = result.field("displacement")
    assert moved[:, 1].min() == pytest.approx(-4.5, abs=0.06)
    assert np.corrcoef(start[:, 1], moved[:, 1])[0, 1] < -0.95


def test_volume_and_energy_are_kept(remeshed):
    summary = Result(remeshed).summary
    volume = summary["volume"]
    assert volume["change_percent"] - volume["elastic_part_percent"] == pytest.approx(0.0, abs=0.01)
    assert abs(summary["energy"]["error_percent"]) < 1.0


def test_resumed_between_meshes_gives_the_same_bits(remeshed, tmp_path):
    model = build_model(upsetting(remesh={"every": 0.2}, output={"steps": 3, "checkpoint_every": 1}))
    half = int(read_history(remeshed / "history.csv")["increment"][-1]) // 2

    def stop(progress):
        if progress.text.startswith(f"press: increment {half},"):
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "run", threads=1, on_increment=stop).status == "interrupted"
    assert 0 < read_history(tmp_path / "run" / "history.csv")["remeshes"][-1] < 4
    assert run_model(model, tmp_path / "run", threads=1, resume=True).status == "completed"
    assert (tmp_path / "run" / "history.csv").read_bytes() == (remeshed / "history.csv").read_bytes()
    for field in ("displacement", "equivalent_plastic_strain", "contact_pressure"):
        one, other = (Result(folder).field(field) for folder in (remeshed, tmp_path / "run"))
        assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize(
    ("base", "change"),
    [
        ({"every": 0.3}, {"size": 0.8}),
        ({"every": 0.3, "size": 0.8}, {"smallest_size": 0.6}),
        ({"every": 0.3, "size": 0.8}, {"max_cells": 60}),
        ({"size": 0.8}, {"quality": 0.55}),
        ({}, {"every": 0.3}),
        ({"every": 0.3, "size": 0.8}, {"windows": [{"box": [0, 0, 2, 2], "size": 0.3}]}),
        ({"every": 0.3, "size": 0.8}, {"tools": {"punch": 0.35}}),
        ({"every": 0.3, "size": 1.2}, {"error": 0.05}),
    ],
)
def test_every_key_changes_the_meshes(base, change):
    """The punch has a rounded edge, which small cells follow."""
    profile = [[0, HEIGHT], {"to": [6, HEIGHT], "radius": 0.8}, [6, 30]]
    contact = {"profile": profile, "contact": "frictionless"}

    def count(keys):
        recording = begin_forming(build_model(upsetting(3.0, remesh=keys, contact=contact)), threads=1)
        return ((row["cells"], row["remeshes"]) for row in map(recording.row, recording.advance()))

    assert any(one != other for one, other in zip_longest(count(base), count(base | change))), "until they differ"


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"solver": {"inertia": 1.0}}, "solver.inertia"),
        ({"solver": {"displacements": "small"}}, "solver.displacements"),
        ({"remesh": {"size": 1.0, "smallest_size": 2.0}}, "remesh.smallest_size"),
        ({"remesh": {"smallest_size": 5.0}}, "remesh.smallest_size"),
        ({"remesh": {"size": 50.0}}, "remesh.size"),
        ({"remesh": {"size": 1e-9}}, "remesh.size"),
        ({"remesh": {"size": 2.0}, "tools": {"punch": ROUNDED}}, "remesh.size: cells of 0.5 mm cannot follow"),
        ({"remesh": {"smallest_size": 0.5}, "tools": {"punch": ROUNDED}}, "give smallest_size = 0.2 or less"),
        ({"remesh": {"windows": [{"box": [0, 0, 2, 2], "size": 0.03}]}}, "remesh.windows.0.size"),
        ({"remesh": {"windows": [{"box": [3, 0, 2, 2], "size": 0.3}]}}, "remesh.windows.0.box"),
        ({"remesh": {"tools": {"punch": 0.03}}}, "remesh.tools.punch"),
        ({"remesh": {"tools": {"die": 0.3}}}, "remesh.tools.die: no such tool"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_told_by_its_key(changes, key):
    with pytest.raises(CaseError) as error:
        build_model(upsetting(**({"remesh": {}} | changes)))
    assert key in str(error.value)


def test_windows_and_tools_have_the_cells_asked_for():
    keys = {"size": 1.2, "windows": [{"box": [0, 0, 3, 3], "size": 0.4}], "tools": {"punch": 0.5}}
    recording = begin_forming(build_model(upsetting(remesh=keys)), threads=1)
    next(recording.advance())
    assert recording.observers.find(NewMeshes).remesh("asked for")
    mesh = recording.procedure.model.mesh
    corners = mesh.points[mesh.blocks[0].connectivity]
    edge = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).mean(axis=1)
    x, y = corners.mean(axis=1).T
    assert edge[(x < 3) & (y < 3)].mean() == pytest.approx(0.4, rel=0.2)
    top = y > y.max() - 0.6
    assert edge[top].mean() == pytest.approx(0.5, rel=0.2)
    far = (x > 6) & (y > 5) & (y < 9)
    assert edge[far].mean() > 0.9


def test_a_budget_too_small_for_thin_metal_is_refused_with_one_that_would_do():
    plate = {"material": "steel", "mesh": {"size": [160, 1.0], "cells": [160, 2]}}
    tool = {"punch": {"profile": [[0, 1.0], [200, 1.0]], "contact": "frictionless"}}
    case = upsetting(0.2, workpiece=plate, tools=tool, remesh={"max_cells": 60})
    with pytest.raises(StartError, match=r"max_cells = 60 leaves .* cells across .*; max_cells = [0-9,]+ for three"):
        begin_forming(build_model(case), threads=1)


def test_a_case_without_the_key_keeps_its_first_mesh_until_an_increment_fails():
    """A billet under a punch that sticks turns its cells inside out; without new meshes the run ends there."""

    def press(**changes):
        case = upsetting(12.0, (6, 9), contact={"contact": "sticking"}, **changes)
        rows = []
        recording = begin(build_model(case), 1)
        try:
            for report in recording.advance():
                rows.append(recording.row(report))
        except GaveUpError:
            return rows, recording, "gave_up"
        return rows, recording, "completed"

    never, _, outcome = press(remesh={"enabled": False})
    assert outcome == "gave_up"
    assert "remeshes" not in never[-1]
    rows, recording, outcome = press()
    assert outcome == "completed"
    assert rows[-1]["remeshes"] >= 1
    for row, alone in zip(rows, never, strict=False):
        if row["remeshes"] == 0:
            assert row["punch.force"] == alone["punch.force"]
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 1.0


PRESSED = {"name": "press", "tools": {"punch": {"stroke": 12.0, "direction": [0, -1]}}}
NOSE = {"profile": [[0, HEIGHT], {"to": [5, HEIGHT], "radius": 1.0}, [5, 40]], "contact": "shear", "m": 0.1}


def of_cells(element):
    return {"material": "steel", "element": element, "mesh": {"size": [10, HEIGHT], "cells": [10, 15]}}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"stages": [PRESSED | {"pressure": [{"set": "right", "value": 100}]}]}, "the next increment fails"),
        ({"stages": [PRESSED | {"edge_force": [{"set": "right", "total": [-2e4, 0]}]}]}, "the next increment fails"),
        ({"workpiece": of_cells("tri3"), "contact": NOSE, "stroke": 4.0}, "deep in an edge"),
        pytest.param(
            {"workpiece": of_cells("tri6_6pt"), "contact": NOSE, "stroke": 5.5},
            "deep in an edge",
            marks=pytest.mark.validation,
        ),
    ],
)
def test_loaded_bodies_and_triangles_get_a_new_mesh_by_themselves(changes, reason):
    stroke, contact = changes.get("stroke", 12.0), changes.get("contact", {"contact": "sticking"})
    own = {key: value for key, value in changes.items() if key not in ("stroke", "contact")}
    recording = begin(build_model(upsetting(stroke, contact=contact, **own)), 1)
    notes = [line for report in recording.advance() for line in recording.log_lines(report) if "remesh" in line]
    assert recording.remaining() == 0.0
    assert recording.epoch >= 1
    assert reason in notes[0]
    assert abs(recording.procedure.energy_balance()["error_percent"]) < 2.0


def test_a_body_whose_first_mesh_holds_keeps_it_where_another_gets_a_new_one(tmp_path):
    """Two bodies without keys: one is asked for a new mesh, the other one is not looked at as new meshes are."""
    recording = begin(build_model(Case.from_toml(copy_example("two_bodies", tmp_path))), 1)
    for _ in zip(range(5), recording.advance(), strict=False):
        pass
    cells = [len(block.connectivity) for block in recording.model.mesh.blocks]
    assert recording.observers.find(NewMeshes).remesh("asked for", {0})
    assert recording.observers.find(NewMeshes)._find_reason() is None
    now = [len(block.connectivity) for block in recording.model.mesh.blocks]
    assert now[0] != cells[0]
    assert now[1] == cells[1]


def test_what_prevents_new_meshes_is_told_by_check_and_log_and_the_mesh_stays(tmp_path):
    """A support inside the body, and inertia: theory forbids new meshes there."""
    mesh = build_model(upsetting()).mesh
    lines = ["*NODE", *(f"{i}, {x}, {y}" for i, (x, y) in enumerate(mesh.points.tolist(), 1))]
    lines += ["*ELEMENT, TYPE=CAX4"]
    lines += [
        f"{i}, {', '.join(map(str, cell))}" for i, cell in enumerate((mesh.blocks[0].connectivity + 1).tolist(), 1)
    ]
    for name, nodes in {"left": mesh.node_sets["left"], "foot": mesh.node_sets["bottom"], "pin": [30, 31]}.items():
        lines += [f"*NSET, NSET={name}", ", ".join(str(node + 1) for node in nodes)]
    (tmp_path / "billet.inp").write_text("\n".join(lines))
    held = {name: {"set": name, "fix": ["x" if name == "left" else "y"]} for name in ("left", "foot")}
    held["pin"] = {"set": "pin", "fix": ["x"]}
    billet = {"material": "steel", "mesh": {"path": str(tmp_path / "billet.inp"), "unit": "mm"}}
    pinned = build_model(upsetting(workpiece=billet, boundary=held))
    assert "new meshes: none (boundary.pin.set: 2 nodes of pin lie inside" in describe(pinned)
    assert "2 nodes of pin lie inside" in begin(pinned, 1).begin_log()
    steel = {
        "young": 2e5,
        "poisson": 0.3,
        "density": "7850 kg/m^3",
        "hardening": {"law": "linear", "yield_stress": 700},
    }
    model = build_model(upsetting(materials={"steel": steel}, solver={"inertia": 1e-6}))
    assert "new meshes: none (solver.inertia does not go together with new meshes)" in describe(model)
    recording = begin(model, 1)
    assert "no new meshes: solver.inertia" in recording.begin_log()
    assert any("solver.inertia" in hint for hint in recording._find_hints())
    assert not recording._change_mesh("fails")


def test_a_run_that_gives_up_tells_why_there_is_no_other_mesh(tmp_path, monkeypatch):
    """A sticking punch turns a cell of the first mesh inside out, and no other mesh can be made."""

    def fold(old, settings, *, part):
        raise MeshError("the boundary folds", "another shape")

    monkeypatch.setattr(bodies_in_plane, "remesh_section", fold)
    case = upsetting(12, (4, 4), remesh={"quality": 1e-9}, contact={"contact": "sticking"})
    outcome = run_model(build_model(case), tmp_path / "run", threads=1)
    assert outcome.status == "gave_up"
    assert "not remeshed (" in outcome.reason
    assert "the boundary folds" in outcome.reason


def test_a_run_that_gives_up_names_a_tool_that_ends_on_the_metal(tmp_path):
    """The billet spreads past the end of the platen, at a radius of 12 mm."""
    contact = {"profile": [[0, HEIGHT], [12, HEIGHT]], "contact": "frictionless"}
    outcome = run_model(build_model(upsetting(14, (4, 4), contact=contact)), tmp_path / "run", threads=1)
    assert outcome.status == "gave_up"
    assert "the profile of punch ends on the metal, at (12, " in outcome.reason


def test_a_mesh_that_changes_the_force_is_refused_unless_it_cannot_wait(monkeypatch):
    """No mesh keeps the force to the last bit: five are tried, and the best one is taken where the old one fails."""

    def log(most, wait):
        monkeypatch.setattr(new_meshes, "MOST_JUMP", most)
        monkeypatch.setattr(new_meshes, "WAIT", wait)
        recording = begin_forming(build_model(upsetting(3.0, remesh={"every": 0.5})), threads=1)
        return [line for report in recording.advance() for line in recording.log_lines(report)]

    assert not any("not remeshed" in line for line in log(1.0, 1.5))
    assert any("not remeshed (due): the largest force of a tool would change by" in line for line in log(0.0, 1.5))
    assert any("none of 5 meshes keeps the force" in line for line in log(0.0, 1e-3))


def test_edges_too_long_are_replaced_just_before_a_tool_lands(tmp_path):
    """Edges of 1.25 mm where 0.9 mm is asked for: the mesh may stay, but a new one changes no force yet."""
    in_the_air = {"contact": "frictionless", "position": [0, 1]}
    case = upsetting(stroke=2.0, remesh={"size": 0.9}, contact=in_the_air, solver={"max_increment": 0.04})
    assert run_model(build_model(case), tmp_path / "run", threads=1).status == "completed"
    history = read_history(tmp_path / "run" / "history.csv")
    first = int(np.flatnonzero(history["remesh_cause"])[0])
    lands = int(np.flatnonzero(history["punch.force"])[0])
    assert history["remesh_cause"][first] == 5
    assert first == lands > 10
    assert "largest force of a tool changes by 0.00%" in (tmp_path / "run" / "run.log").read_text()


def test_check_says_that_there_are_new_meshes():
    words = describe(build_model(upsetting(remesh={"every": 0.2, "size": 0.8})))
    assert "new meshes: cells of 0.2 to 0.8 mm, at most 20,000" in words
    assert "after every 0.2 of a stage" in words


def without_cells(model, cells):
    """The model whose mesh lacks some cells."""
    mesh = model.mesh
    block = replace(mesh.blocks[0], connectivity=np.delete(mesh.blocks[0].connectivity, cells, axis=0))
    return replace(model, mesh=replace(mesh, blocks=(block,), boundary_edges=find_boundary_edges([block.connectivity])))


def test_a_section_with_a_hole_keeps_it_and_its_force():
    """A void of 2.5 by 2.5 mm inside the billet, with new meshes, to 15 % as on one mesh."""
    void = [12 * 16 + 6 + k + 16 * i for k in range(4) for i in range(4)]
    runs = {}
    for name, remesh in (("once", {"quality": 1e-9, "size": 8.0}), ("often", {"every": 0.1, "size": 0.65})):
        model = without_cells(build_model(upsetting(2.25, (16, 24), remesh=remesh)), void)
        recording = begin_forming(model, threads=1)
        rows = [recording.row(report) for report in recording.advance()]
        runs[name] = recording, np.array([[row["punch.stroke"], row["punch.force"]] for row in rows])
    recording, (stroke, force) = runs["often"][0], runs["often"][1].T
    assert recording.epoch >= 5
    assert runs["once"][0].epoch == 0
    loops = [s for section in recording.observers.find(NewMeshes).bodies.find() for s in section.chains]
    assert len(loops) == 2
    np.testing.assert_allclose(force, np.interp(stroke, *runs["once"][1].T), rtol=0.02)
    procedure = recording.procedure
    plastic = procedure.volume() - procedure.mechanics.elastic_dilatation(procedure.state) - procedure.initial_volume
    assert abs(plastic / procedure.initial_volume) < 3e-4


def test_a_section_whose_boundary_touches_itself_is_refused_before_anything_is_computed():
    """Two cells are missing that share a corner: the boundary passes it twice."""
    model = without_cells(build_model(upsetting(remesh={})), [43, 43 + 9])
    with pytest.raises(StartError, match="not made of closed lines"):
        begin_forming(model, threads=1)


def test_die_fill_is_measured_on_the_mesh_of_its_step(remeshed):
    fill = measure_die_fill(Result(remeshed), "punch", x_range=(0, 8))
    assert fill.filled == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        (
            {"workpiece": {"material": "steel", "element": "tri3", "mesh": {"size": [10, HEIGHT], "cells": [4, 6]}}},
            False,
        ),
        ({"remesh": {"enabled": False}}, True),
        ({}, False),
        ({"remesh": {"enabled": False}, "solver": {"displacements": "small"}}, False),
    ],
)
def test_a_run_that_keeps_its_mesh_says_what_new_ones_need(changes, told):
    """Where it gives up and new meshes have been switched off, or small displacements need none."""
    hints = begin(build_model(upsetting(**changes)), 1)._find_hints()
    assert any("with [remesh] in the case" in hint for hint in hints) == told
