# SPDX-License-Identifier: Apache-2.0
"""Contact patch test: distorted blocks between rigid frictionless tools, straight or tilted, are stressed uniformly.

The block's side is free, so the only stress in the plane is that along the tools' normal: E / (1 - nu^2) ln(h/h0) in
plane strain, E ln(h/h0) in a solid cylinder.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.fields.table import compute_fields
from presswork.model import (
    Analysis,
    ElementName,
    Friction,
    Mesh,
    Model,
    OutputSettings,
    Profile,
    Stage,
    Support,
    Tool,
    ToolMotion,
)
from tests.problems.plane_solids import ELEMENTS, block_mesh, distort, elastic, fixed_increments, run

YOUNG, POISSON = 200e3, 0.3
WIDTH, HEIGHT, STROKE = 8.0, 6.0, 0.3
ROUND_OFF = 1e-11
"""Of the stress."""


def uneven(mesh: Mesh) -> Mesh:
    """Move the nodes along the sides too, so that their edges are unequal; mid-sides are left to distort()."""
    x, y = mesh.points[:, 0] / WIDTH, mesh.points[:, 1] / HEIGHT
    shift = np.column_stack([0.35 * np.sin(np.pi * x), 0.3 * np.sin(np.pi * y)])
    return replace(mesh, points=mesh.points + shift)


def turn(points: np.ndarray, degrees: float) -> np.ndarray:
    """Turn points about the origin, counter-clockwise."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s], [-s, c]])


def line(*corners: tuple[float, float], degrees: float) -> np.ndarray:
    """A tool's segments along corners in the block's own frame."""
    at = turn(np.array(corners, dtype=float), degrees)
    return np.column_stack([at[:-1], at[1:], np.zeros((len(at) - 1, 3))])


def patch(element: ElementName, analysis: Analysis, degrees: float) -> Model:
    """A distorted block on the floor of a corner, its other side free, pressed from above; the corner turned."""
    mesh = distort(uneven(block_mesh(element, (4, 3), origin=(0, 0), size=(WIDTH, HEIGHT))), 0.3)
    mesh = replace(mesh, points=turn(mesh.points, degrees))
    far = 3 * WIDTH
    floor = [(0.0, far), (0.0, 0.0), (far, 0.0)] if analysis == "plane_strain" else [(-1.0, 0.0), (far, 0.0)]
    corner = Tool("corner", Profile(line(*floor, degrees=degrees)), friction=Friction("frictionless"))
    above = Profile(line((far, HEIGHT), (-1.0, HEIGHT), degrees=degrees))
    punch = Tool("punch", above, friction=Friction("frictionless"))
    move = turn(np.array([0.0, -STROKE]), degrees)
    return Model(
        title="contact patch test",
        analysis=analysis,
        depth=1.0,
        mesh=mesh,
        materials=(elastic(YOUNG, POISSON),),
        tools=(corner, punch),
        supports=(Support("left", (True, False)),) if analysis == "axisymmetric" else (),
        stages=(Stage("press", tool_motion={"punch": ToolMotion((float(move[0]), float(move[1])))}),),
        solver=fixed_increments(2),
        output=OutputSettings(every=1),
    )


def stress_error(model: Model, degrees: float) -> float:
    """Return the largest deviation of stress and of contact pressure from the closed form, over it."""
    procedure, _ = run(model)
    factor = YOUNG / (1 - POISSON**2) if model.analysis == "plane_strain" else YOUNG
    along = factor * np.log(1 - STROKE / HEIGHT)
    normal = turn(np.array([0.0, 1.0]), degrees)
    out_of_plane = POISSON * along if model.analysis == "plane_strain" else 0.0
    exact = np.array([along * normal[0] ** 2, along * normal[1] ** 2, out_of_plane, along * normal[0] * normal[1]])
    state, fixed = procedure.state, procedure.interactions.supports.fixed(0)
    errors = [np.abs(block - exact).max() for block in state.cells.stress]
    forces = procedure.interactions.tools.contact.forces(state, fixed)
    fields, _ = compute_fields(procedure.mechanics.show(state, forces))
    beside_wall = np.zeros(len(model.mesh.points), dtype=bool)  # a corner node has the mean of both faces
    if model.analysis == "plane_strain":
        edges = model.mesh.boundary_edges
        beside_wall[edges[np.isin(edges, model.mesh.node_sets["left"]).any(axis=1)]] = True
    for side, tool, traction in (("top", "punch", along * normal), ("bottom", "corner", -along * normal)):
        nodes = model.mesh.node_sets[side]
        nodes = nodes[~beside_wall[nodes]]
        assert len(nodes) >= 3
        errors.append(np.abs(fields[f"contact_traction_{tool}"][nodes, :2] - traction).max())
        errors.append(np.abs(fields["contact_pressure"][nodes] + along).max())
    return float(max(errors) / abs(along))


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_a_distorted_block_between_flat_tools_is_stressed_uniformly(element, degrees) -> None:
    assert stress_error(patch(element, "plane_strain", degrees), degrees) < ROUND_OFF


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_distorted_cylinder_between_flat_tools_is_stressed_uniformly(element) -> None:
    assert stress_error(patch(element, "axisymmetric", 0.0), 0.0) < ROUND_OFF
