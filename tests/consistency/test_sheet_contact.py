# SPDX-License-Identifier: Apache-2.0
"""Contact of shell nodes with tools in space: the tangent is the derivative of the forces, friction obeys Coulomb."""

import numpy as np
import pytest

from presswork.geometry.pose import SpacePose, turn_about
from presswork.geometry.swept_tool import draw_die, draw_hemispherical_punch, draw_punch
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.sheet_contact import ROUNDING, sheet_nodes
from presswork.interaction.space_contact import NodesOnTool, PlacedSurface, TouchingNodes, find_touched, touch_tool
from presswork.model import Friction

THICKNESS = 0.8
STIFFNESS = 2.1e3
"""Of contact [MPa]: a hundredth of steel."""
SURFACES = {
    "sphere": draw_hemispherical_punch(25.0, 40.0),
    "punch": draw_punch((25.5, 20.0), 10.0, 4.0, 30.0),
    "die": draw_die((27.0, 27.0), 11.5, 4.0, width=40.0, depth=30.0),
}


def place(name: str) -> PlacedSurface:
    """Return a surface; "turned" is the die, turned about a slanting axis and moved."""
    surface = make_surface(SURFACES[name.removeprefix("turned ")])
    turned = turn_about(np.array([0.4, -0.7, 1.1])) if name.startswith("turned") else None
    return PlacedSurface(surface, SpacePose(np.full(3, 2.0), np.zeros(3), np.full(3, 1.0), turned))


def press(name: str, deep: float, n: int = 300) -> tuple[TouchingNodes, np.ndarray, np.ndarray]:
    """Return nodes pressed into a tool by `deep` thicknesses here, by up to twice that there; areas differ."""
    surface = place(name)
    rng = np.random.default_rng(3)
    around = np.column_stack([rng.uniform(-35.0, 35.0, (n, 2)), rng.uniform(-8.0, 12.0, n)])
    _, normal, own, _ = surface.surface.nearest(around)
    normal, on_tool = surface.pose.turn(normal), surface.pose.carry(own)
    sinks = deep * THICKNESS * rng.uniform(1.0, 2.0, n)
    sheet = sheet_nodes(rng.uniform(1.0, 4.0, n), np.full(n, THICKNESS), STIFFNESS)
    return sheet, on_tool + normal * (0.5 * THICKNESS - sinks)[:, None], normal


def touch(
    surface: PlacedSurface, law: Friction, sheet: TouchingNodes, x: np.ndarray, way: np.ndarray, before: np.ndarray
) -> NodesOnTool:
    """Return the forces of a tool on a sheet."""
    return touch_tool(surface, law, find_touched(surface, sheet, x), x, way, before)


@pytest.mark.parametrize("deep", [1e-2, 3e-5], ids=["deep", "within the rounding"])
@pytest.mark.parametrize("state", ["frictionless", "sticks", "slides"])
@pytest.mark.parametrize("name", [*SURFACES, "turned die"])
def test_tangent_is_the_derivative_of_the_forces(name: str, state: str, deep: float) -> None:
    tool = place(name), Friction(mu={"frictionless": 0.0, "sticks": 10.0, "slides": 0.1}[state])
    sheet, x, _ = press(name, deep)
    rng = np.random.default_rng(4)
    way = rng.normal(size=x.shape) * THICKNESS * (1e-3 if state == "sticks" else 1.0)
    before = rng.normal(size=x.shape) * (0.1 if state == "slides" else 1e-3)
    found = touch(*tool, sheet, x, way, before)
    assert len(found.nodes) == len(x)
    h = 1e-7
    slopes = []
    for e in np.eye(3):
        after, ahead = (touch(*tool, sheet, x + s * h * e, way + s * h * e, before) for s in (-1, 1))
        slopes.append((after.force - ahead.force) / (2.0 * h))
    finite = np.stack(slopes, axis=-1)
    scale = np.abs(finite).max(axis=(1, 2), keepdims=True)
    # where the difference reaches over a line at which the curvature of the tool jumps it means nothing
    off = np.abs(found.stiffness - finite).max(axis=(1, 2)) / scale[:, 0, 0]
    assert (off < 1e-5).mean() > 0.99


@pytest.mark.parametrize("name", SURFACES)
def test_friction_lies_in_the_tangent_plane_and_obeys_coulomb(name: str) -> None:
    mu = 0.1
    sheet, x, normal = press(name, 1e-2)
    way = 100.0 * np.random.default_rng(5).normal(size=x.shape)
    found = touch(place(name), Friction(mu=mu), sheet, x, way, np.zeros_like(x))
    push = (found.force * normal).sum(axis=1)
    along = way - (way * normal).sum(axis=1)[:, None] * normal
    np.testing.assert_allclose((found.friction * normal).sum(axis=1), 0.0, atol=1e-9 * push.max())
    np.testing.assert_allclose(np.linalg.norm(found.friction, axis=1), mu * push, rtol=1e-12)
    cosine = (found.friction * along).sum(axis=1) / (mu * push * np.linalg.norm(along, axis=1))
    np.testing.assert_allclose(cosine, -1.0, atol=1e-12)


def test_push_is_that_of_the_sheet_across_its_thickness() -> None:
    area = np.random.default_rng(7).uniform(1.0, 4.0, 300)
    _, x, normal = press("punch", 1e-2)
    sheet = sheet_nodes(area, np.full(300, THICKNESS), STIFFNESS)
    tool = place("punch"), Friction()
    found = touch(*tool, sheet, x, np.zeros_like(x), np.zeros_like(x))
    gap = tool[0].nearest(x, np.inf)[0] - 0.5 * THICKNESS
    stress = (found.force * normal).sum(axis=1) / area
    np.testing.assert_allclose(stress, -STIFFNESS * gap / THICKNESS, rtol=1e-9)
    off = x + normal * (-gap + 1.001 * ROUNDING * THICKNESS)[:, None]
    assert len(touch(*tool, sheet, off, np.zeros_like(x), np.zeros_like(x)).nodes) == 0
