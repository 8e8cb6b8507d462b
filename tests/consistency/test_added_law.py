# SPDX-License-Identifier: Apache-2.0
"""A law of one's own (tests/data/umat/fibres.cpp) with a history of its own, which new meshes carry by its names."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.explicit.arrays import SolidArrays
from presswork.law.history import History, list_history
from presswork.law.umat import compile_law, open_umat
from presswork.model import FloatArray, Material, Umat
from presswork.process.begin import begin
from presswork.process.explicit.new_meshes import IntervalMeshes
from presswork.process.implicit.new_meshes import NewMeshes
from presswork.process.mesh_change import carrying
from presswork.remesh.carrier import place_points
from tests.problems.plane_solids import block_mesh, drive_boundary, fixed_increments, run
from tests.regression.test_remeshed_impact import upsetting
from tests.regression.test_remeshed_space_impact import upset

FIBRES = Path(__file__).parents[1] / "data" / "umat" / "fibres.cpp"
PARTS = ["eqps", "plastic_strain", "travel", "fibres", "deformation_gradient", "strain", "energy", "heat", "work"]


@pytest.fixture(scope="module")
def steel(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The keys of a material with this law."""
    library = compile_law(FIBRES, tmp_path_factory.mktemp("law") / "fibres.so")
    return {
        "umat": str(library), "props": [2e5, 0.3, 500.0], "state_variables": 9, "plastic_strain": 1,
        "thread_safe": True, "density": "7850 kg/m^3",
    }  # fmt: skip


def find_angle(points: FloatArray) -> FloatArray:
    """Return the angle of the fibres in the plane of x and y that tests give to places (n, d) [rad]."""
    return 0.3 + 0.02 * points[:, 0] - 0.01 * points[:, 1]


def find_travel(points: FloatArray) -> FloatArray:
    """Return the sums that tests give to places (n, d), linear in them (n, 2)."""
    return 0.5 + points[:, :2] @ np.array([[0.01, 0.02], [0.03, -0.01]])


def fill(kept: History, values: FloatArray, points: FloatArray) -> None:
    """Give what the law keeps (n, n_history) at places, in place."""
    c, s, zero = np.cos(find_angle(points)), np.sin(find_angle(points)), np.zeros(len(points))
    values[:, kept["fibres"]] = np.stack([c, s, zero, -s, c, zero], axis=1)
    values[:, kept["travel"]] = find_travel(points)


def check(kept: History, values: FloatArray, points: FloatArray) -> None:
    """Axes are orthonormal and have the angle of their place, sums those of theirs."""
    x, y = values[:, kept["fibres"]].reshape(-1, 2, 3).transpose(1, 0, 2)
    np.testing.assert_allclose(np.linalg.norm(x, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(y, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose((x * y).sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.arctan2(x[:, 1], x[:, 0]), find_angle(points), atol=1e-3)
    np.testing.assert_allclose(values[:, kept["travel"]], find_travel(points), rtol=1e-6)


@pytest.mark.parametrize("components", [3, 4, 6])
def test_a_library_declares_the_names_of_its_state(steel: dict[str, Any], components: int) -> None:
    kept = list_history(open_umat(Umat(steel["umat"], (2e5, 0.3, 500.0), 9)), components)
    assert [part.name for part in kept.parts] == PARTS
    assert [kept["travel"], kept["fibres"]] == [slice(2, 4), slice(4, 10)]
    assert [part.name for part in kept.parts if part.is_axes] == ["fibres"]


def test_parts_that_are_not_all_of_the_state_are_refused(tmp_path: Path) -> None:
    source = tmp_path / "short.cpp"
    source.write_text(FIBRES.read_text().replace("n_state = 9", "n_state = 10"))
    library = compile_law(source)
    with pytest.raises(RuntimeError, match="its parts of the state have 9 values, not 10"):
        open_umat(Umat(str(library), (2e5, 0.3, 500.0), 10))


def test_declared_axes_turn_with_the_material(steel: dict[str, Any]) -> None:
    """A square turned by 0.4 rad in four steps has its fibres turned as much, and has lost no right angle."""
    material = Material("fibres", 2e5, 0.3, None, umat=Umat(steel["umat"], (2e5, 0.3, 500.0), 9))
    turned = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in (0.1, 0.2, 0.3, 0.4)]
    mesh = block_mesh("quad4_fbar", (2, 2), origin=(0.0, 0.0), size=(1.0, 1.0))
    solver = fixed_increments(1)
    procedure, _ = run(drive_boundary(mesh, turned, material, analysis="plane_strain", solver=solver))
    fibres = procedure.state.cells.find_kept(0, "fibres").reshape(-1, 6)
    c, s = np.cos(0.4), np.sin(0.4)
    np.testing.assert_allclose(fibres, np.tile([c, s, 0.0, -s, c, 0.0], (len(fibres), 1)), atol=1e-9)


def test_an_implicit_run_carries_them_to_a_new_mesh(steel: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    case = upsetting("implicit", remesh={}, materials={"steel": steel}, points={})
    recording = begin(build_model(case), 1)
    next(recording.advance())
    before, found = recording.procedure, {}
    block, kept = before.model.mesh.blocks[0], before.state.cells.kept[0]
    position = before.model.mesh.points + before.state.nodes.displacement
    fill(kept, before.state.cells.history[0].reshape(-1, kept.size), place_points(block, position))

    def look(run_n: Any, run: Any, carrier: Any) -> None:
        real(run_n, run, carrier)
        found["state"], found["mesh"] = run.state.duplicate(), run.model.mesh

    real = carrying.carry_surface
    monkeypatch.setattr(carrying, "carry_surface", look)
    assert recording.observers.find(NewMeshes).remesh("asked for")
    cells, mesh = found["state"].cells, found["mesh"]
    check(kept, cells.history[0].reshape(-1, kept.size), place_points(mesh.blocks[0], mesh.points))


def carry_in_explicit_run(recording: Any) -> None:
    next(recording.advance())

    def place() -> FloatArray:
        return np.asarray(recording.solids.position[recording.model.mesh.blocks[0].connectivity].mean(axis=1))

    state = recording.solids.state_as_given()
    kept = state[SolidArrays].kept[0]
    fill(kept, state[SolidArrays].points[0][:, 0], place())
    recording.solids.take_state_as_given(state)
    assert recording.observers.find(IntervalMeshes).remesh("asked for")
    check(kept, recording.solids.state_as_given()[SolidArrays].points[0][:, 0], place())


def test_an_explicit_run_in_the_plane_carries_them_to_a_new_mesh(steel: dict[str, Any]) -> None:
    carry_in_explicit_run(begin(build_model(upsetting(remesh={}, materials={"steel": steel}, points={})), 1))


def test_an_explicit_run_in_space_carries_them_to_a_new_mesh(steel: dict[str, Any]) -> None:
    pytest.importorskip("mmgpy", reason="new meshes in space are made by mmgpy")
    data = copy.deepcopy(upset(every=1.0)) | {"explicit": {}}
    data["materials"] = dict.fromkeys(data["materials"], steel)
    carry_in_explicit_run(begin(build_model(SpaceCase(**data)), 1))
