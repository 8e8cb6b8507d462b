# SPDX-License-Identifier: Apache-2.0
"""Hertz contact of an elastic cylinder or sphere with a rigid plane: model, closed forms, and what is measured.

A quarter disc of radius R: in plane strain half of a cylinder between two planes, in axisymmetry of a sphere. The flat
cut through the centre does not move, the plane presses the lowest point. Hertz (1882), after K. L. Johnson, Contact
Mechanics (1985), sections 4.2(a), (c), with E* = E / (1 - nu^2) against a rigid body, load P (cylinder: per length):

    cylinder  a^2 = 4 P R / (pi E*),   p0 = 2 P / (pi a)         sphere  a^3 = 3 P R / (4 E*),   p0 = 3 P / (2 pi a^2)
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from presswork.fields.contact_stress import ContactSurface
from presswork.fields.tool_stress import recover_tool_stress
from presswork.mesh import mesh_rectangle
from presswork.model import (
    Analysis,
    ElementName,
    FloatArray,
    Friction,
    Mesh,
    Model,
    OutputSettings,
    Profile,
    Stage,
    Support,
    Tool,
    ToolMotion,
    find_cell,
)
from tests.problems.plane_solids import elastic, fixed_increments, run

RADIUS, YOUNG, POISSON = 10.0, 200e3, 0.3
MODULUS = YOUNG / (1 - POISSON**2)
HALF_WIDTH = 0.02 * RADIUS
"""About that of the contact; p0 is then 1 % of E*."""


RIM = 1.5
"""Edges at the rim of the contact that are not fitted."""


@dataclass(frozen=True)
class Hertz:
    """The contact as computed, and its closed form for the load that was computed."""

    place: FloatArray
    """Distance of the nodes in contact from the axis, over R (n,)."""
    pressure: FloatArray
    """At those nodes [MPa]."""
    nodal_pressure: FloatArray
    """Nodal force over the node's share, without smoothing [MPa]."""
    load: float
    """[N], or [N/mm] for the cylinder."""
    half_width: float
    """Where the ellipse fitted to the pressure ends [mm]."""
    peak: float
    """Its height [MPa]."""
    exact_half_width: float
    exact_peak: float
    nodes_across: int
    """Nodes in contact beside the axis."""


def grade(fine: float, until: float, growth: float) -> FloatArray:
    """Return grid lines from 0 to 1: steps of `fine` up to `until`, then each step larger by `growth`."""
    lines = list(np.arange(0.0, until + 0.5 * fine, fine))
    step = fine
    while lines[-1] + growth * step < 1.0:
        step *= growth
        lines.append(lines[-1] + step)
    lines = np.array(lines)
    return np.asarray(lines / lines[-1])


def mesh_quarter_disc(element: ElementName, half_width: float, edges: int) -> Mesh:
    """Mesh a quarter disc below y = 0 by transfinite interpolation, with so many edges across the half-width [mm].

    The grid's corners: lowest point, 45 degrees along the arc, the cut's end, the centre.
    """
    arc = 0.25 * np.pi
    fine = half_width / RADIUS / edges
    lines, depth = grade(fine / arc, 1.5 * edges * fine / arc, 1.15), grade(fine, 1.5 * edges * fine, 1.15)
    mesh = mesh_rectangle(lines, depth, element=element)
    x, y = mesh.points.T

    def on_arc(angle: FloatArray) -> FloatArray:
        return np.column_stack([np.sin(angle), -np.cos(angle)])

    bottom, right = on_arc(arc * x), on_arc(arc * (1 + y))
    top, left = np.column_stack([x, 0 * x]), np.column_stack([0 * y, y - 1])
    middle = np.column_stack([x * (1 - y) * np.sin(arc) + x * y, -(1 - x) * (1 - y) - x * (1 - y) * np.cos(arc)])
    x, y = x[:, None], y[:, None]
    points = RADIUS * ((1 - y) * bottom + y * top + (1 - x) * left + x * right - middle)
    points[mesh.node_sets["left"], 0] = 0.0
    points[mesh.node_sets["top"], 1] = 0.0
    _centre_inner_nodes(points, mesh)
    return replace(mesh, points=points)


def _centre_inner_nodes(points: FloatArray, mesh: Mesh) -> None:
    """Put the centres of crossed triangles between their corners and inner mid-sides between their ends, in place."""
    cells = mesh.blocks[0].connectivity
    n = find_cell(2, cells).corners
    if n == 3:
        total, count = np.zeros_like(points), np.zeros(len(points))
        np.add.at(total, cells[:, 2], points[cells[:, 0]])
        np.add.at(count, cells[:, 2], 1.0)
        points[count > 0] = total[count > 0] / count[count > 0, None]
    if cells.shape[1] > n:
        inner = np.ones(len(points), dtype=bool)
        inner[np.unique(mesh.boundary_edges)] = False
        ends = 0.5 * (points[cells[:, :n]] + points[np.roll(cells[:, :n], -1, axis=1)])
        middles = cells[:, n : 2 * n]
        points[middles[inner[middles]]] = ends[inner[middles]]


def press(
    analysis: Analysis, element: ElementName, *, edges: int = 16, half_width: float = HALF_WIDTH, increments: int = 4
) -> Hertz:
    """Press the plane until the contact's half-width is about `half_width`, with so many edges across it."""
    mesh = mesh_quarter_disc(element, half_width, edges)
    a_over_r = half_width / RADIUS
    approach = RADIUS * a_over_r**2 if analysis == "axisymmetric" else _approach_of_cylinder(half_width)
    line = np.array([[-RADIUS, -RADIUS, 2 * RADIUS, -RADIUS, 0, 0, 0]], dtype=float)
    plane = Tool("plane", Profile(line), friction=Friction("frictionless"))
    model = Model(
        title="Hertz",
        analysis=analysis,
        depth=1.0,
        mesh=mesh,
        materials=(elastic(YOUNG, POISSON),),
        tools=(plane,),
        supports=(Support("left", (True, False)), Support("top", (False, True))),
        stages=(Stage("press", tool_motion={"plane": ToolMotion((0.0, approach))}),),
        solver=fixed_increments(increments, max_iterations=60, force_tolerance=1e-7),
        output=OutputSettings(every=1),
    )
    return _measure(model, half_width / edges)


def _approach_of_cylinder(a: float) -> float:
    """Return the approach of centre and plane [mm]: Johnson 1985, eq. 5.59 for one side."""
    load = np.pi * MODULUS * a**2 / (4 * RADIUS)
    return float(load / (np.pi * MODULUS) * (2 * np.log(4 * RADIUS / a) - 1))


def _measure(model: Model, edge: float) -> Hertz:
    procedure, _ = run(model)
    state, contact = procedure.state, procedure.interactions.tools.contact
    forces = contact.forces(state, procedure.interactions.supports.fixed(0))
    points = model.mesh.points + state.nodes.displacement
    depth = None if model.analysis == "axisymmetric" else model.depth
    surface = ContactSurface(model.mesh.boundary_edges, points, forces.status > 0, forces.gap, depth=depth)
    found = recover_tool_stress(model, points, forces, procedure.mechanics.nodal_flow_stress(state))
    push = np.zeros(len(points))
    push[forces.nodes] = forces.push
    nodes = forces.nodes[np.argsort(points[forces.nodes, 0])]
    sides = 1 if model.analysis == "axisymmetric" else 2
    load = sides * float(push.sum())
    pressure, area = found.pressure[nodes], surface.nodal_area[nodes]
    raw = np.divide(push[nodes], area, out=np.full(len(nodes), np.nan), where=area > 0)
    x = points[nodes, 0]
    # p^2 = p0^2 - (p0/a)^2 x^2 is a straight line over x^2. Nodes within RIM edges of the last one are left out,
    # where the pressure is taken to fall linearly
    inside = x < x[-1] - RIM * edge
    slope, height = np.polyfit(x[inside] ** 2, pressure[inside] ** 2, 1)
    if model.analysis == "axisymmetric":
        half_width = (3 * load * RADIUS / (4 * MODULUS)) ** (1 / 3)
        peak = 3 * load / (2 * np.pi * half_width**2)
    else:
        half_width = np.sqrt(4 * load * RADIUS / (np.pi * MODULUS))
        peak = 2 * load / (np.pi * half_width)
    return Hertz(
        place=x / RADIUS,
        pressure=pressure,
        nodal_pressure=raw,
        load=load,
        half_width=float(np.sqrt(-height / slope)),
        peak=float(np.sqrt(height)),
        exact_half_width=float(half_width),
        exact_peak=float(peak),
        nodes_across=int((x[1:] <= half_width).sum()),
    )
