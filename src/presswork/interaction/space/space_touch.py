# SPDX-License-Identifier: Apache-2.0
"""The law of contact of nodes with a rigid tool in space, and of friction, with the consistent tangent.

A node touches where the gap between it and the tool is less than its reach: half the thickness of a sheet; at a solid
what its multiplier stands for. With g the gap less the reach, a spring k pushes it out, N = -k g, rounded off over a
small gap so that the derivative has no jump.

Friction is a return mapping over the increment, as in friction.py: T = P (T_n - k_t d), P the tangent plane at the
node's present place and d its slip along the tool, shortened to what the law allows. The tangent holds all derivatives:
of N, of the direction of sliding, and of the normal by the curvature of the tool; it is not symmetric.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from presswork import _core
from presswork.body.contract import Near
from presswork.geometry.pose import SpacePose
from presswork.geometry.rounded_surface import RoundedSurface
from presswork.law.friction import is_plain, limit_stress
from presswork.model import FloatArray, Friction, IndexArray

TANGENTIAL = 0.1
"""Tangential stiffness that holds a sticking node over the stiffness of contact."""
STEEPEST = 5.0
"""Largest friction of a node over its normal force, where the law has more: a node that hardly touches is not held."""

LEAST_AREA = 1e-12
"""Area that is none [mm2]."""
BY_FACTOR = ("shear", "wanheim_bay", "levanov")
"""Laws of friction by a friction factor alone."""


@dataclass(frozen=True)
class NodesOnTool:
    """What one tool does to the nodes that it touches."""

    nodes: IndexArray
    force: FloatArray
    """Force on the node (n, 3) [N]."""
    friction: FloatArray
    """The part of it along the tool (n, 3) [N]."""
    stiffness: FloatArray
    """d(-force)/dx (n, 3, 3) [N/mm]."""
    energy: float
    """Stored by the normal forces [N mm]."""


@dataclass(frozen=True)
class TouchingNodes:
    """What contact must know of the nodes."""

    spring: FloatArray
    """Stiffness of the spring that pushes a node out of a tool (n_points,) [N/mm]."""
    reach: FloatArray
    """Distance from the tool below which it pushes (n_points,) [mm]."""
    rounding: FloatArray
    """Distance over which that begins (n_points,) [mm]."""
    area: FloatArray
    """Share of the surface (n_points,) [mm2]."""

    @property
    def farthest(self) -> float:
        """Distance from the tool beyond which no node touches [mm]."""
        return float((self.reach + self.rounding).max())

    def gap_at(self, push: FloatArray) -> FloatArray:
        """Return the gap beyond the reach at which a node is pushed with so much [N] (n_points,) [mm]."""
        return gap_at(push, self.spring, self.rounding)


def push_at(gap: FloatArray, spring: FloatArray, rounding: FloatArray) -> FloatArray:
    """Return the push (n,) [N] at gaps beyond the reach (n,) [mm]: a parabola within the rounding."""
    return np.where(gap < -rounding, -spring * gap, spring * (rounding - gap) ** 2 / (4.0 * rounding))


def gap_at(push: FloatArray, spring: FloatArray, rounding: FloatArray) -> FloatArray:
    """Return the gap beyond the reach (n,) [mm] at which the push is so much (n,) [N]."""
    parabola = rounding - np.sqrt(4.0 * rounding * np.maximum(push, 0.0) / spring)
    return np.where(push > spring * rounding, -push / spring, parabola)


@dataclass(frozen=True)
class TouchedNodes:
    """Nodes that touch a tool, or are about to."""

    nodes: IndexArray
    gap: FloatArray
    """Gap beyond their reach (n,) [mm]."""
    normal: FloatArray
    """Normal of the tool (n, 3)."""
    spring: FloatArray
    """Stiffness of the spring, as in TouchingNodes (n,) [N/mm]."""
    rounding: FloatArray
    """The same (n,) [mm]."""
    law_gap: FloatArray
    """Gap beyond their reach where the tangent of the law is taken (n,) [mm]; `gap` itself: the law."""

    @property
    def slope(self) -> FloatArray:
        """Derivative of the push by the gap (n,) [N/mm]."""
        k, delta = self.spring, self.rounding
        return np.where(self.law_gap < -delta, -k, -0.5 * k * (delta - self.law_gap) / delta)

    @property
    def push(self) -> FloatArray:
        """Return the push of the tool on the nodes (n,) [N], by the tangent of the law at law_gap."""
        return push_at(self.law_gap, self.spring, self.rounding) + self.slope * (self.gap - self.law_gap)

    @property
    def energy(self) -> float:
        """Stored by the normal forces [N mm]."""
        g, k, delta = self.gap, self.spring, self.rounding
        rounded = k * (delta - np.maximum(g, -delta)) ** 3 / (12.0 * delta)
        return float((rounded + np.where(g < -delta, 0.5 * k * (g**2 - delta**2), 0.0)).sum())


@dataclass(frozen=True)
class PlacedSurface:
    """A tool's surface where it stands; answers as _core.ToolSurface does, in space."""

    surface: _core.ToolSurface | RoundedSurface
    pose: SpacePose

    def nearest(self, points: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the gap of points (n, 3) closer than reach [mm], infinite of others, and the normal there (n, 3)."""
        gap, normal, _, _ = self.surface.nearest(np.ascontiguousarray(self.pose.to_frame(points)), reach)
        return gap, self.pose.turn(normal)

    def slopes(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the derivatives of gap (n, 3) and normal (n, 3, 3) to points [1/mm]."""
        rise, bend = self.surface.slopes(np.ascontiguousarray(self.pose.to_frame(points)))
        turned = self.pose.turned
        return self.pose.turn(rise), bend if turned is None else turned @ bend @ turned.T


def choose_touched(near: Near, touching: TouchingNodes, before: FloatArray | None = None) -> TouchedNodes:
    """Return the nodes that touch a tool. near: of all nodes, found within touching.farthest.

    before: law_gap of all nodes before a correction, infinite of those that did not touch (n_points,) [mm]. The law's
    tangent is then taken where the push is what the correction has asked for, and nodes at which it has led to a pull
    are released. At the nodes' own gap Newton's method would only halve what is left of a parabola, again and again.
    """
    gap, normal = near
    nodes = np.flatnonzero(gap - touching.reach < touching.rounding)
    k, delta, beyond = touching.spring[nodes], touching.rounding[nodes], (gap - touching.reach)[nodes]
    law_gap = beyond
    if before is not None:
        touched = np.isfinite(before[nodes])
        last = np.where(touched, before[nodes], 0.0)
        asked = TouchedNodes(nodes, beyond, normal[nodes], k, delta, last).push
        law_gap = np.where(touched, np.maximum(gap_at(asked, k, delta), beyond), beyond)
        kept = ~touched | (asked > 0.0)
        nodes, k, delta, beyond, law_gap = nodes[kept], k[kept], delta[kept], beyond[kept], law_gap[kept]
    return TouchedNodes(nodes, beyond, normal[nodes], k, delta, law_gap)


@dataclass(frozen=True)
class FrictionOfNodes:
    """What a law of friction asks of the nodes that touch a tool, n."""

    law: Friction
    area: FloatArray
    """Area over which each is pressed (n,) [mm2]."""
    shear: FloatArray | None = None
    """Largest friction whatever the push, for a factor of one, and on tools on which nodes stick (n,) [N]."""
    factor: FloatArray | None = None
    """Factor on m and mu, by speed, path and temperature (n,); None: one."""

    def limit(self, push: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the largest friction (n,) [N] at normal forces `push` (n,) [N], and its derivative by these."""
        if is_plain(self.law):
            return limit_friction(self.law, push, self.shear)
        factor = np.ones_like(push) if self.factor is None else self.factor
        area = np.maximum(self.area, LEAST_AREA)
        shear_flow = np.full_like(push, math.inf) if self.shear is None else self.shear / area
        m, mu = float(self.law.m) * factor, float(self.law.mu) * factor
        stress, rise = limit_stress(self.law, m, mu, push / area, shear_flow)
        limit = np.where(self.area > 0.0, stress * area, 0.0)
        if self.law.law == "shear":
            return np.minimum(limit, STEEPEST * push), np.zeros_like(push)
        return limit, np.where(self.area > 0.0, rise, 0.0)


def touch_tool(
    surface: PlacedSurface,
    law: FrictionOfNodes,
    touched: TouchedNodes,
    x: FloatArray,
    slip: FloatArray,
    friction_n: FloatArray,
) -> NodesOnTool:
    """Return the forces of a tool on the nodes that touch it.

    x: places of all nodes (n_points, 3) [mm]. slip: of the nodes along with the increment, less that of the tool
    (n_points, 3) [mm]. friction_n: their friction when the increment began, turned with the tool (n_points, 3) [N].
    """
    nodes, n, energy = touched.nodes, touched.normal, touched.energy
    rise, bend = surface.slopes(x[nodes])
    # 1. normal force
    push, slope = touched.push, touched.slope
    force, stiffness = _core.push_nodes(push, slope, n, rise, bend)
    if is_frictionless(law.law):
        return NodesOnTool(nodes, force, np.zeros_like(force), stiffness, energy)
    # 2. friction
    hanging = TANGENTIAL * touched.spring
    pulled = friction_n[nodes] - hanging[:, None] * slip[nodes]
    limit, by_push = law.limit(push)
    friction = _core.rub_nodes(
        push, slope, n, rise, bend, hanging=hanging, pulled=pulled, limit=limit, by_push=by_push, tangent=stiffness
    )
    return NodesOnTool(nodes, force + friction, friction, stiffness, energy)


def is_frictionless(law: Friction) -> bool:
    """Return whether a tool lets nodes slide freely."""
    if law.law == "coulomb":
        return float(law.mu) == 0.0
    return law.law == "frictionless" or (law.law in BY_FACTOR and float(law.m) == 0.0)


def limit_friction(law: Friction, push: FloatArray, shear: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Return the largest friction (n,) [N] at normal forces `push` (n,) [N], and its derivative by these."""
    if law.law == "sticking":
        return np.full_like(push, math.inf) if shear is None else shear, np.zeros_like(push)
    if law.law == "frictionless":
        return np.zeros_like(push), np.zeros_like(push)
    steep = float(law.mu) if law.law in ("coulomb", "coulomb_capped") else STEEPEST
    limit, by_push = steep * push, np.full_like(push, steep)
    if law.law == "coulomb":
        return limit, by_push
    assert shear is not None, "the law needs the shear flow stress"
    most = float(law.m) * shear
    if law.law == "shear":  # the symmetric part of a derivative by so steep a law would be indefinite
        return np.minimum(limit, most), np.zeros_like(push)
    return np.minimum(limit, most), np.where(limit < most, by_push, 0.0)
