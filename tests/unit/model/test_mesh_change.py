# SPDX-License-Identifier: Apache-2.0
"""A model on another mesh: bodies have their points there, and a mesh that lacks what the model names is refused."""

from dataclasses import replace

import pytest

from presswork import Case, build_model
from presswork.examples import copy_example
from presswork.model import Mesh, Model, change_mesh


@pytest.fixture
def model(tmp_path) -> Model:
    return build_model(Case.from_toml(copy_example("two_bodies", tmp_path), ["workpiece.mesh.cells=[6,10]"]))


def mesh_with_more_cells(tmp_path) -> tuple[Mesh, Model]:
    finer = build_model(Case.from_toml(copy_example("two_bodies", tmp_path / "fine"), ["workpiece.mesh.cells=[8,12]"]))
    return finer.mesh, finer


def test_bodies_have_the_points_that_their_blocks_have_in_the_new_mesh(model, tmp_path) -> None:
    (tmp_path / "fine").mkdir()
    mesh, finer = mesh_with_more_cells(tmp_path)
    assert change_mesh(model, model.mesh).bodies == model.bodies
    assert change_mesh(model, mesh).bodies == finer.bodies != model.bodies


def test_a_mesh_without_a_set_a_block_or_a_body_of_its_own_is_refused(model) -> None:
    mesh = model.mesh
    with pytest.raises(ValueError, match="no node set"):
        change_mesh(model, replace(mesh, node_sets={}))
    with pytest.raises(ValueError, match="has 1 blocks of cells, the bodies 2"):
        change_mesh(model, replace(mesh, blocks=mesh.blocks[:1]))
    with pytest.raises(ValueError, match="points of the body 'ring' lie among those of another"):
        change_mesh(model, replace(mesh, blocks=mesh.blocks[::-1]))
