# SPDX-License-Identifier: Apache-2.0
"""Contact of shell nodes with tools in space: the tangent is the derivative of the forces, friction obeys Coulomb."""

import numpy as np
import pytest

from presswork.geometry.pose import SpacePose, turn_about
from presswork.geometry.swept_tool import draw_die, draw_hemispherical_punch, draw_punch
from presswork.geometry.tool_surface import make_surface
from presswork.interaction.space.sheet_contact import ROUNDING, sheet_nodes
from presswork.interaction.space.space_touch import (
    FrictionOfNodes,
    NodesOnTool,
    PlacedSurface,
    TouchingNodes,
    choose_touched,
    touch_tool,
)
from presswork.model import Friction, FrictionFactors

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
    touched = choose_touched(surface.nearest(x, sheet.farthest), sheet)
    return touch_tool(surface, FrictionOfNodes(law, sheet.area[touched.nodes]), touched, x, way, before)


@pytest.mark.parametrize("deep", [1e-2, 3e-5], ids=["deep", "within the rounding"])
@pytest.mark.parametrize("state", ["frictionless", "sticks", "slides", "slides by pressure"])
@pytest.mark.parametrize("name", [*SURFACES, "turned die"])
def test_tangent_is_the_derivative_of_the_forces(name: str, state: str, deep: float) -> None:
    factors = FrictionFactors(exponent=0.7, reference=4.0) if state == "slides by pressure" else None
    tool = place(name), Friction(mu={"frictionless": 0.0, "sticks": 10.0}.get(state, 0.1), factors=factors)
    sheet, x, _ = press(name, deep)
    rng = np.random.default_rng(4)
    way = rng.normal(size=x.shape) * THICKNESS * (1e-3 if state == "sticks" else 1.0)
    before = rng.normal(size=x.shape) * (0.1 if state.startswith("slides") else 1e-3)
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


class Plane:
    """The plane z = 0 as a tool; answers as PlacedSurface does."""

    def nearest(self, points: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        gap = points[:, 2]
        return np.where(gap < reach, gap, np.inf), np.broadcast_to([0.0, 0.0, 1.0], points.shape)


def count_corrections(start: float, pulled_to: float, softness: float, *, at_own_gap: bool) -> tuple[int, float]:
    """Return Newton's corrections of one node on a spring, and its gap over the rounding in equilibrium.

    start: its gap when the spring's end is moved to a gap of `pulled_to`; both over the rounding. softness: of the
    contact's spring over the node's own.
    """
    sheet = sheet_nodes(np.ones(1), np.full(1, THICKNESS), STIFFNESS)
    k, delta, half = sheet.spring[0], sheet.rounding[0], 0.5 * THICKNESS
    gap, before = start * delta, None
    for corrections in range(60):
        near = Plane().nearest(np.array([[0.0, 0.0, half + gap]]), sheet.farthest)
        touched = choose_touched(near, sheet, before)
        law = choose_touched(near, sheet)
        push, slope = (touched.push[0], touched.slope[0]) if len(touched.nodes) else (0.0, 0.0)
        own = k / softness
        wrong = abs((law.push[0] if len(law.nodes) else 0.0) - push)
        if max(abs(push + own * (pulled_to * delta - gap)), wrong) < 1e-10 * k * delta:
            return corrections, gap / delta
        gap += (push + own * (pulled_to * delta - gap)) / (own - slope)
        before = np.full(1, np.inf)
        before[touched.nodes] = touched.law_gap
        before = None if at_own_gap else before
    raise AssertionError("no equilibrium")


@pytest.mark.parametrize("softness", [10.0, 1e3, 1e5])
def test_a_node_that_is_pulled_off_leaves_within_three_corrections(softness: float) -> None:
    corrections, gap = count_corrections(-3.0, 5.0, softness, at_own_gap=False)
    assert gap == pytest.approx(5.0, rel=1e-9)
    assert corrections <= 3


@pytest.mark.parametrize("softness", [0.1, 10.0, 1e3, 1e5])
@pytest.mark.parametrize("start", [-50.0, 0.3, 0.9, 2.0], ids=["deep", "touches", "hardly touches", "free"])
@pytest.mark.parametrize("pulled_to", [-1e-3, -1.0, 0.9])
def test_a_node_comes_to_equilibrium_on_the_parabola(start: float, pulled_to: float, softness: float) -> None:
    corrections, gap = count_corrections(start, pulled_to, softness, at_own_gap=False)
    # k (1 - g)^2 / 4 = (k / softness) (g - pulled_to)
    b = 1.0 + 2.0 / softness
    exact = b - np.sqrt(b * b - 1.0 - 4.0 * pulled_to / softness)
    assert gap == pytest.approx(max(exact, (pulled_to / (1.0 + softness)) if exact < -1.0 else exact), abs=1e-7)
    assert corrections <= 8


def test_tangent_at_the_nodes_own_gap_halves_what_is_left_again_and_again() -> None:
    assert (
        count_corrections(-3.0, 0.9, 1e5, at_own_gap=True)[0]
        > 2 * count_corrections(-3.0, 0.9, 1e5, at_own_gap=False)[0]
    )
