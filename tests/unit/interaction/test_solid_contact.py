# SPDX-License-Identifier: Apache-2.0
"""Contact of a solid's nodes with tools in space."""

import numpy as np
import pytest

from presswork import build_model, read_case
from presswork.implicit.stepping import ImplicitProcedure
from tests.problems.upset_block import describe_block


def test_a_node_is_pushed_by_a_spring_as_stiff_as_all_its_surface_where_faces_turn_away_from_each_other(tmp_path):
    """A spike, as at the root of a fold: the area vectors of its faces cancel, and the metal beneath it does not."""
    text = describe_block(
        'element = "tet4_mini"\nmesh = {kind = "box", size = [4, 4, 4], cells = [4, 4, 4]}',
        4, 0.2, "duration = 1.0\ntools.die = {stroke = 1.0, direction = [0, 0, -1]}",
    )  # fmt: skip
    (tmp_path / "case.toml").write_text(text)
    run = ImplicitProcedure(build_model(read_case(tmp_path / "case.toml")))
    assert run.interactions.space_tools is not None
    contact, points = run.interactions.space_tools.contact, run.model.mesh.points
    top = int(np.flatnonzero((points == [2.0, 2.0, 4.0]).all(axis=1))[0])
    run.state.nodes.displacement[top, 2] = 20.0
    contact.begin_increment(run.state)
    faces = run.model.mesh.boundary_faces
    x = (points + run.state.nodes.displacement[:, :3])[faces[(faces == top).any(axis=1)]]
    vectors = 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    share, resultant = np.linalg.norm(vectors, axis=1).sum() / 3, np.linalg.norm(vectors.sum(axis=0)) / 3
    assert resultant < 0.1 * share
    young = run.model.materials[0].young
    assert contact.touching(0).spring[top] == pytest.approx(young * np.sqrt(share))
