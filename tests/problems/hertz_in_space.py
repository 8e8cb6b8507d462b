# SPDX-License-Identifier: Apache-2.0
"""Hertz contact of two elastic bodies in space: a sphere pressed on a block, both of steel, without friction.

A quarter is modelled. Both bodies reach seven half-widths from the contact; only the surface of the upper one near the
contact is that of a sphere. Hertz (1882), after K. L. Johnson, Contact Mechanics (1985), section 4.2(c), with the
combined modulus E* = E / (2 (1 - nu^2)) and the load P of the whole:

    a^3 = 3 P R / (4 E*),   p0 = 3 P / (2 pi a^2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.mesh import grade_line
from presswork.mesh.faces import face_areas
from presswork.mesh.joined import join_meshes
from presswork.mesh.make.box import finish_mesh, mesh_box
from presswork.model import (
    BodyContact,
    FloatArray,
    Hardening,
    Material,
    Mesh,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    SolverSettings,
    SpaceElement,
    Stage,
    Support,
)

RADIUS, HALF_WIDTH = 25.0, 0.5
"""[mm]; the half-width is about that of the contact."""
YOUNG, POISSON = 200e3, 0.3
MODULUS = YOUNG / (2 * (1 - POISSON**2))
REACH = 7.0
ELASTIC = Material("steel", YOUNG, POISSON, Hardening("linear", np.array([1e12, 0.0])))


@dataclass(frozen=True)
class Hertz:
    """The contact as computed, and its closed form for the load that was computed."""

    place: FloatArray
    """Distance of the slave's nodes that push from the axis (n,) [mm]."""
    pressure: FloatArray
    """There (n,) [MPa]."""
    area: FloatArray
    """Share of the surface that belongs to these nodes (n,) [mm2]."""
    load: float
    """Of the whole [N]."""

    @property
    def half_width(self) -> float:
        """By the second moment of the pressure, which is 2 a^2 / 5 over the load [mm]."""
        force = self.pressure * self.area
        return float(np.sqrt(2.5 * (force * self.place**2).sum() / force.sum()))

    @property
    def exact_half_width(self) -> float:
        """[mm]."""
        return float((0.75 * self.load * RADIUS / MODULUS) ** (1 / 3))

    @property
    def exact_peak(self) -> float:
        """[MPa]."""
        return 1.5 * self.load / (np.pi * self.exact_half_width**2)


def mesh_block(element: SpaceElement, cells: int, *, below: bool) -> Mesh:
    """Return a block on either side of z = 0, so many cells over the half-width, which grow from 1.5 of it on."""
    near, far = 1.5 * HALF_WIDTH, (REACH - 1.5) * HALF_WIDTH
    fine = round(1.5 * cells)
    lines = grade_line(0.0, [(near, fine, 1.0), (far, cells + 1, 12.0)])
    return mesh_box(lines, lines, -lines[::-1] if below else lines, element=element)


def make_model(element: SpaceElement, cells: tuple[int, int], approach: float) -> Model:
    """Return the model; cells: over the half-width, of the sphere (the slave) and of the block; approach [mm]."""
    ball, block = (mesh_block(element, n, below=below) for n, below in zip(cells, (False, True), strict=True))
    points = ball.points.copy()
    x, y, z = points.T
    sphere = RADIUS - np.sqrt(RADIUS**2 - x**2 - y**2)
    points[:, 2] += sphere * (1.0 - z / z.max())
    ball = finish_mesh(points, ball.blocks[0].connectivity, dict(ball.node_sets), element, 0)
    mesh, bodies = join_meshes({"block": block, "ball": ball})
    sides = {"x": ("left", "ball.left"), "y": ("bottom", "ball.bottom"), "z": ("back",)}
    return Model(
        title="Hertz",
        analysis="solid",
        depth=1.0,
        mesh=mesh,
        materials=(ELASTIC,),
        tools=(),
        supports=tuple(Support(s, tuple(a == axis for a in "xyz")) for axis, sets in sides.items() for s in sets),
        stages=(Stage("press", prescribed=(PrescribedDisplacement("ball.front", 2, -approach),)),),
        solver=SolverSettings(initial_increment=0.25, max_increment=0.25, symmetric=False),
        output=OutputSettings(steps=1),
        bodies=bodies,
        contacts=(BodyContact("joint", (0, 1), 1, "frictionless"),),
    )


def press(element: SpaceElement, cells: tuple[int, int] = (4, 3), approach: float = 0.0105) -> Hertz:
    """Press the sphere on the block."""
    run = ImplicitProcedure(make_model(element, cells, approach))
    for _ in run.advance():
        pass
    mesh, (interface,) = run.model.mesh, run.interactions.bodies.interfaces
    pressure = run.state[InterfaceArrays].pressure
    nodes = interface.nodes[pressure > 0.0]
    faces = mesh.face_sets["ball.back"]
    area = np.bincount(faces.ravel(), face_areas(mesh.points, faces).ravel(), minlength=len(mesh.points))[nodes]
    place = np.linalg.norm((mesh.points + run.state.nodes.moved)[nodes, :2], axis=1)
    load = 4.0 * abs(float(run.contact_forces()["joint"][2]))
    return Hertz(place, pressure[pressure > 0.0], area, load)
