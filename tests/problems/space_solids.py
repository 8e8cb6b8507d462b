# SPDX-License-Identifier: Apache-2.0
"""Models of solids in space that tests and validation share."""

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.mesh.faces import face_areas
from presswork.mesh.make.box import finish_mesh, mesh_box
from presswork.model import (
    CELLS,
    FaceForce,
    FacePressure,
    Hardening,
    Material,
    Mesh,
    Model,
    OutputSettings,
    SolverSettings,
    SpaceElement,
    Stage,
    Support,
)

STEEL = Material("steel", 200e3, 0.3, Hardening("swift", np.array([565.0, 0.007, 0.26])))
SYMMETRY = tuple(
    Support(side, tuple(axis == own for axis in "xyz")) for side, own in (("left", "x"), ("bottom", "y"), ("back", "z"))
)


def box(element: SpaceElement, size: tuple[float, float, float], cells: tuple[int, int, int], distort=0.0) -> Mesh:
    """Return a box; inner nodes are moved at random by `distort` of a cell, those on sides within their side."""
    lines = [np.linspace(0.0, length, n + 1) for length, n in zip(size, cells, strict=True)]
    mesh = mesh_box(*lines, element=element)
    if distort == 0.0:
        return mesh
    points, cell = mesh.points.copy(), np.array(size) / cells
    move = np.random.default_rng(7).uniform(-distort, distort, points.shape) * cell
    for axis, length in enumerate(size):
        move[(points[:, axis] == 0.0) | (points[:, axis] == length), axis] = 0.0
    cells = mesh.blocks[0].connectivity
    return finish_mesh(straighten(points + move, cells), cells, {}, element, 0)


def straighten(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the points with the middles of tetrahedra of 10 nodes halfway between the ends of their edges."""
    if cells.shape[1] == 10:
        points[cells[:, 4:]] = points[cells[:, CELLS["tet4"].edges]].mean(axis=2)
    return points


def make_model(mesh: Mesh, supports, stages, *, material: Material = STEEL, increments: int = 10, **solver) -> Model:
    """Return a model whose increments are equal parts of each stage."""
    part = 1.0 / increments
    tolerances = {"force_tolerance": 1e-10, "displacement_tolerance": 1e-8}
    settings = SolverSettings(initial_increment=part, max_increment=part, **(tolerances | solver))
    return Model(
        title="solid in space",
        analysis="solid",
        depth=1.0,
        mesh=mesh,
        materials=(material,),
        tools=(),
        supports=tuple(supports),
        stages=tuple(stages) if isinstance(stages, (list, tuple)) else (stages,),
        solver=settings,
        output=OutputSettings(steps=1),
    )


def compute(model: Model) -> ImplicitProcedure:
    """Take a model to its end."""
    procedure = ImplicitProcedure(model, threads=1)
    for _ in procedure.advance():
        pass
    return procedure


def cook_mesh(element: SpaceElement, n: int, layers: int = 1) -> Mesh:
    """Return Cook's membrane of unit thickness, n x n cells in its plane."""
    mesh = box(element, (1.0, 1.0, 1.0), (n, n, layers))
    x, y, z = mesh.points.T
    points = np.column_stack([48.0 * x, 44.0 * x + y * (44.0 - 28.0 * x), z])
    sides = {name: mesh.node_sets[name] for name in ("left", "right", "bottom", "top", "back", "front")}
    cells = mesh.blocks[0].connectivity
    return finish_mesh(straighten(points, cells), cells, sides, element, 0)


CLAMPED = Support("left", (True, True, True))
FLAT = Support("all", (False, False, True))
"""Plane strain: nothing moves along z."""


def elastic(young: float, poisson: float) -> Material:
    return Material("elastic", young, poisson, Hardening("linear", np.array([1e9, 0.0])))


def cook_plane_stress(element: SpaceElement, n: int) -> Model:
    """Return Cook's membrane as he put it: E = 1, nu = 1/3, force 1, geometrically linear, faces free."""
    load = Stage("load", face_forces=(FaceForce("right", (0.0, 1.0 / 16.0, 0.0)),))
    return make_model(
        cook_mesh(element, n), [CLAMPED], load, material=elastic(1.0, 1.0 / 3.0), increments=1, displacements="small"
    )


def cook_in_space(element: SpaceElement, n: int, layers: int) -> Model:
    """Return the membrane of depth 10, nearly incompressible (E = 240.565, nu = 0.4999), traction 6.25, large."""
    mesh = cook_mesh(element, n, layers)
    points = mesh.points * [1.0, 1.0, 10.0]
    sides = {name: mesh.node_sets[name] for name in ("left", "right")}
    mesh = finish_mesh(points, mesh.blocks[0].connectivity, sides, element, 0)
    load = Stage("load", face_forces=(FaceForce("right", (0.0, 6.25, 0.0)),))
    return make_model(mesh, [CLAMPED], load, material=elastic(240.565, 0.4999), increments=5)


def cook_plastic(element: SpaceElement, n: int) -> Model:
    """Return the membrane of Simo & Armero 1992 in plane strain, saturating hardening, force 5."""
    law = Hardening("linear_voce", np.array([0.45, 0.715, 16.93, 0.12924]))
    load = Stage("load", face_forces=(FaceForce("right", (0.0, 5.0 / 16.0, 0.0)),))
    return make_model(
        cook_mesh(element, n), [CLAMPED, FLAT], load, material=Material("metal", 206.9, 0.29, law), increments=20
    )


def thick_cylinder(n_radial: int, n_around: int, front: float) -> Model:
    """Return a quarter of a thick cylinder, bore 10 and outside 20 mm, whose plastic zone has come to `front` [mm].

    Ideally plastic, nearly incompressible, small displacements, plane strain: Hill 1950, chapter 5.
    """
    bore, outside, young, yield_stress = 10.0, 20.0, 200e3, 300.0
    mesh = box("hex8_fbar", (1.0, 1.0, 1.0), (n_radial, n_around, 1))
    radius, angle, z = bore + (outside - bore) * mesh.points[:, 0], 0.5 * np.pi * mesh.points[:, 1], mesh.points[:, 2]
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), z])
    sides = {"inside": mesh.node_sets["left"], "outside": mesh.node_sets["right"]}
    sides |= {"bottom": mesh.node_sets["bottom"], "left": mesh.node_sets["top"]}
    mesh = finish_mesh(points, mesh.blocks[0].connectivity, sides, "hex8_fbar", 0)
    shear_yield = yield_stress / np.sqrt(3.0)
    pressure = shear_yield * (2.0 * np.log(front / bore) + 1.0 - front**2 / outside**2)
    load = Stage("press", face_pressures=(FacePressure("inside", pressure),))
    supports = [Support("bottom", (False, True, False)), Support("left", (True, False, False)), FLAT]
    material = Material("ideal", young, 0.4999, Hardening("linear", np.array([yield_stress, 0.0])))
    return make_model(
        mesh, supports, load, material=material, increments=20, displacements="small", force_tolerance=1e-6
    )


def _rise_at(procedure: ImplicitProcedure, y: float) -> float:
    points = procedure.model.mesh.points
    nodes = np.flatnonzero((points[:, 0] == 48.0) & (np.abs(points[:, 1] - y) < 1e-9))
    return float(procedure.state.nodes.displacement[nodes, 1].mean())


def upper_rise(procedure: ImplicitProcedure) -> float:
    """Return how far the upper corner of the loaded end of Cook's membrane has risen [mm]."""
    return _rise_at(procedure, 60.0)


def middle_rise(procedure: ImplicitProcedure) -> float:
    """Return how far the middle of the loaded end has risen [mm]."""
    return _rise_at(procedure, 52.0)


def mean_rise(procedure: ImplicitProcedure) -> float:
    """Return the mean rise of the loaded face [mm]."""
    faces = procedure.model.mesh.face_sets["right"]
    areas = face_areas(procedure.model.mesh.points, faces)
    return float((areas * procedure.state.nodes.displacement[faces, 1]).sum() / areas.sum())
