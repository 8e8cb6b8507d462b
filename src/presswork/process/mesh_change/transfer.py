# SPDX-License-Identifier: Apache-2.0
"""The state of a sheet from explicit dynamics to the implicit procedure, and back.

Positions, thickness, and stress and history of the law of every layer are carried over (SheetState); their components
stay as they are, in the frame of the law, and the frame goes with them. A one-point shell gives what it has to all
points of the implicit shell; in the opposite direction it takes the mean of the points. A fully integrated one has the
same points; its thickness is one for all of them.

Explicit shells keep no directors, so the implicit ones begin with the sheet's normals, without transverse shear.
Hourglass forces stay behind, being no stress. So the state carried over is nearly, not wholly, in balance: what it
lacks is held by forces that fade over the first stage, as the reactions of one stage do in the next.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from presswork import _core
from presswork.body.law_failed import LawFailed
from presswork.body.model_directors import lay_directors
from presswork.body.shell_arrays import ShellArrays
from presswork.body.shells import ShellFailed, ShellMechanics
from presswork.evolution.points import EvolvedArrays, find_evolved
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells, Precision
from presswork.fields.instant import Instant
from presswork.implicit.energy import Work
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.loads import LoadArrays
from presswork.law.history import EQPS
from presswork.law.umat import open_sheet_law
from presswork.mesh.directors import cell_normals
from presswork.mesh.thickness_rule import thickness_rule
from presswork.mesh.topology import is_triangle, with_four_nodes
from presswork.model import CellBlock, FloatArray, IntArray, Section, find_cell

TEMPERATURE = "temperature"
"""Name of the mean temperature in SheetState.heated."""
CENTRE = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]]) / 4.0
"""Slopes of the shape functions at the centre (2, 4)."""


class TransferError(ValueError):
    """A state that does not fit the model that it is to go on in."""


@dataclass(frozen=True)
class SheetBlock:
    """Shells of one kind: q points in the plane, k layers, from bottom to top."""

    connectivity: IntArray
    """(n_cells, 3 | 4)."""
    axis: FloatArray
    """x of the law in space, unit vectors (n_cells, q or 1, 3)."""
    thickness: FloatArray
    """(n_cells, q or 1) [mm]."""
    stress: FloatArray
    """xx, yy, xy in the frame of the law (n_cells, q, k, 3) [MPa]."""
    history: FloatArray
    """What the law keeps (n_cells, q, k, n_history)."""
    evolved: Mapping[str, FloatArray] = field(default_factory=dict)
    """What evolution laws keep, by quantity (n_cells, q, k)."""
    temperature: FloatArray | None = None
    """Temperature given to the layers (n_cells, q, k) [degrees C]; None: that of the law's start."""


@dataclass(frozen=True)
class SheetState:
    """A deformed sheet, whatever computed it."""

    position: FloatArray
    """Position of the nodes (n_points, 3) [mm]."""
    blocks: tuple[SheetBlock, ...]
    """Quadrilaterals, then triangles of each zone: those that there are."""
    heated: Mapping[str, FloatArray] = field(default_factory=dict)
    """Fields at the nodes of a sheet that conducts heat (n_points,), as of Instant; `temperature` is the mean."""


def keep_heated(now: Instant) -> dict[str, FloatArray]:
    """Return what SheetState keeps of the heat of an instant."""
    return {} if now.temperature is None else {**now.heated, TEMPERATURE: now.temperature}


def sheet_of_explicit(shells: ExplicitShells, evolved: Mapping[str, FloatArray] | None = None) -> SheetState:
    """Return the present state of explicit shells: of one point each, or of four of quadrilaterals.

    evolved: what evolution laws keep at the layers beside damage, by quantity (n_cells, q, k).
    Where tools squeeze them the pressure is taken away, elastically, with the sheet held in its plane.
    """
    axis = law_axes(shells)[:, None]
    stress, thickness = shells.released()
    thickness, layers = thickness[:, None], (stress, shells.history_at_points)
    kept = {**shells.damage, **(evolved or {})}
    degrees = shells.prescribed_temperature
    blocks = []
    three = is_triangle(shells.connectivity)
    for zone, (n_nodes, kind) in itertools.product(shells.zones, ((4, ~three), (3, three))):
        own = kind.copy()
        own[: zone.start] = own[zone.stop :] = False
        if own.any():
            stress, history = (values[own] if n_nodes == 4 else values[own][:, :1] for values in layers)
            cells = shells.connectivity[own][:, :n_nodes]
            of_block = {name: v[own] if n_nodes == 4 else v[own][:, :1] for name, v in kept.items()}
            given = None if degrees is None else degrees[own] if n_nodes == 4 else degrees[own][:, :1]
            blocks.append(SheetBlock(cells, axis[own], thickness[own], stress, history, of_block, given))
    return SheetState(shells.position, tuple(blocks))


def sheet_of_implicit(procedure: ImplicitProcedure) -> SheetState:
    """Return the present state of an implicit procedure of 3- and 4-node shells."""
    mechanics, _ = _shells_of(procedure)
    state, mesh = procedure.state, procedure.model.mesh
    points = mesh.points + state.nodes.displacement[:, :3]
    blocks = []
    for i, block in enumerate(mesh.blocks):
        g = _layer_bases(
            block, points, state[ShellArrays].director[mechanics.directors.of_cell[i]], state[ShellArrays].thickness[i]
        )
        along = _unit(g[..., 0, :])
        across = np.cross(_unit(np.cross(g[..., 0, :], g[..., 1, :])), along)
        direction, history = state[ShellArrays].direction[i], state.cells.history[i]
        axis = _unit((direction[..., :1] * along - direction[..., 1:] * across).mean(axis=2))
        stress = state.cells.stress[i].reshape(*history.shape[:3], 3)
        evolved = {name: of[i].reshape(history.shape[:3]) for name, of in find_evolved(state).items()}
        thickness, given = state[ShellArrays].thickness[i], state.cells.temperature[i]
        degrees = given.reshape(history.shape[:3]) if given.size else None
        blocks.append(SheetBlock(block.connectivity, axis, thickness, stress, history, evolved, degrees))
    return SheetState(points, tuple(blocks))


def carry_to_implicit(shells: ExplicitShells, procedure: ImplicitProcedure) -> None:
    """Let an implicit procedure, fresh from its model, begin with the present state of explicit shells.

    Its mesh is the undeformed one that strains are counted from, with the nodes and cells of the explicit shells in the
    same order, quadrilaterals before triangles; its section has their rule through the thickness. Velocities are left
    behind, and what is out of balance is held by forces that fade over the first stage. The energy stored counts as
    work done. Raises TransferError for another mesh, section or law, or cells that have folded.
    """
    section, options = _shells_of(procedure)[1], shells.options
    if len(shells.start) != len(procedure.model.mesh.points):
        raise TransferError(_name_meshes(procedure, len(shells.start), len(shells.connectivity)))
    if (section.points, section.rule) != (options.n_points, options.rule):
        raise TransferError(
            f"the model's section has {section.points} points of the {section.rule} rule, the explicit shells "
            f"{options.n_points} of the {options.rule} rule: stresses of layers have no place in others"
        )
    begin_with(sheet_of_explicit(shells), procedure)


def begin_with(sheet: SheetState, procedure: ImplicitProcedure) -> None:
    """Let an implicit procedure, fresh from its model, begin with a sheet's state, as carry_to_implicit.

    A block of one point gives what it has to all points of its shells, shells of one point take the mean of several.
    Raises TransferError.
    """
    mechanics, _ = _shells_of(procedure)
    _check_fit(sheet, procedure)
    state, mesh, points = procedure.state, procedure.model.mesh, sheet.position
    state.nodes.displacement[:, :3] = points - mesh.points
    own, loads = state[ShellArrays], state[LoadArrays]
    own.director[:] = _normals(procedure, points)
    for i, block in enumerate(sheet.blocks):
        cells, q, k = state.cells.history[i].shape[:3]
        own.thickness[i][:] = block.thickness
        g = _layer_bases(mesh.blocks[i], points, own.director[mechanics.directors.of_cell[i]], own.thickness[i])
        normal = _unit(np.cross(g[..., 0, :], g[..., 1, :]))
        axis = block.axis[:, :, None]
        first = _unit(axis - (axis * normal).sum(axis=-1, keepdims=True) * normal)
        along = _unit(g[..., 0, :])
        own.direction[i][:] = np.stack(
            [(along * first).sum(axis=-1), (along * np.cross(normal, first)).sum(axis=-1)], axis=-1
        )
        state.cells.history[i][:] = at_points(block.history, q)
        state.cells.stress[i].reshape(cells, q, k, 3)[:] = at_points(block.stress, q)
        state.cells.eqps[i].reshape(cells, q, k)[:] = state.cells.find_kept(i, EQPS)
        for name, values in block.evolved.items():
            if len(into := state[EvolvedArrays].values[name][i]):
                into[:] = at_points(values, q).reshape(cells, q * k)
        if state.cells.temperature[i].size and block.temperature is not None:
            state.cells.temperature[i].reshape(cells, q, k)[:] = at_points(block.temperature, q)

    trial = state.duplicate()
    force = mechanics.evaluate(state, trial, np.zeros_like(state.nodes.displacement), with_stiffness=False)
    if isinstance(force, ShellFailed | LawFailed):
        raise TransferError(f"the deformed sheet cannot be taken over: {force}")
    mechanics.complete(trial)
    state.cells.volume = trial.cells.volume
    procedure.initial_volume = procedure.volume()
    loads.released = np.where(procedure.interactions.supports.fixed(0), 0.0, force)
    state.nodes.external_force, state.nodes.reaction = loads.released.copy(), force - loads.released
    state[Progress].peak_force = float(np.abs(force / mechanics.length).max())
    state[Work].external_work = mechanics.elastic_energy(state)


def carry_to_explicit(
    procedure: ImplicitProcedure, *, options: ShellOptions | None = None, precision: Precision = "double"
) -> ExplicitShells:
    """Return explicit shells at rest in the present state of an implicit procedure.

    They start from the deformed sheet: its thickness, and the directions that the law's x has turned to. options:
    all but n_points and rule, which are those of the section. What the stage held must be held anew.
    Raises TransferError for a model of other than 3- and 4-node shells, or a rule that explicit shells lack.
    """
    section = _shells_of(procedure)[1]
    if len({block.zone for block in procedure.model.mesh.blocks}) > 1:
        raise TransferError("a welded blank is not carried to explicit shells: give it as a stamping")
    if section.rule == "simpson":
        raise TransferError('explicit shells have no Simpson rule: give the section rule = "lobatto" or "gauss"')
    sheet, material = sheet_of_implicit(procedure), procedure.model.materials[procedure.model.mesh.blocks[0].material]
    options = replace(options or ShellOptions(), n_points=section.points, rule=section.rule)
    start = ShellStart.of(sheet)
    shells = ExplicitShells(
        start.position,
        np.concatenate([with_four_nodes(block.connectivity) for block in sheet.blocks]),
        start.thickness,
        open_sheet_law(material),
        material.density,
        axis=start.axis,
        options=options,
        precision=precision,
    )
    fill_layers(shells, sheet)
    return shells


@dataclass(frozen=True)
class ShellStart:
    """What explicit shells of a deformed sheet are made of."""

    position: FloatArray
    """(n_nodes, 3) [mm]."""
    thickness: FloatArray
    """(n_cells,) [mm]."""
    axis: FloatArray
    """x of the law (n_cells, 3)."""

    @classmethod
    def of(cls, sheet: SheetState) -> ShellStart:
        """Return the start of a sheet's shells, means of their points."""
        thickness = np.concatenate([block.thickness.mean(axis=1) for block in sheet.blocks])
        return cls(sheet.position, thickness, np.concatenate([block.axis.mean(axis=1) for block in sheet.blocks]))


def fill_layers(shells: ExplicitShells, sheet: SheetState) -> None:
    """Give the layers of explicit shells, which start from a sheet, its stress, history and temperature."""
    q = shells.stress_at_points.shape[1]
    shells.set_layers(
        np.concatenate([at_points(block.stress, q) for block in sheet.blocks]),
        np.concatenate([at_points(block.history, q) for block in sheet.blocks]),
    )
    degrees = [at_points(block.temperature, q) for block in sheet.blocks if block.temperature is not None]
    if degrees:
        shells.prescribed_temperature = np.concatenate(degrees)


def law_axes(shells: ExplicitShells) -> FloatArray:
    """Return x of the law in space (n, 3): it turns with the mean deformation gradient since the start."""
    start, now = (np.einsum("ja,cai->cji", CENTRE, x[shells.connectivity]) for x in (shells.start, shells.position))
    normal = _unit(np.cross(start[:, 0], start[:, 1]))
    first = _unit(shells.axis - (shells.axis * normal).sum(axis=1, keepdims=True) * normal)
    frame = np.stack([first, np.cross(normal, first)], axis=1)
    reference = np.linalg.inv(np.einsum("cki,cji->ckj", frame, start))
    gradient = np.einsum("cji,cjk->cki", now, reference)  # what the frame's axes have become
    normal = _unit(np.cross(now[:, 0], now[:, 1]))
    return _unit(gradient[:, 0] + np.cross(gradient[:, 1], normal))


def _shells_of(procedure: ImplicitProcedure) -> tuple[ShellMechanics, Section]:
    """Return mechanics and section of a model of 3- and 4-node shells."""
    mechanics, blocks = procedure.mechanics, procedure.model.mesh.blocks
    kinds: dict[int, list[str]] = {}
    for block in blocks:
        kinds.setdefault(block.zone, []).append(find_cell(2, block.connectivity).name)
    fits = all(of_zone in (["quad4"], ["tri3"], ["quad4", "tri3"]) for of_zone in kinds.values())
    one_sheet = len({(block.zone, block.material, block.section) for block in blocks}) == len(kinds)
    if not isinstance(mechanics, ShellMechanics) or not fits or not one_sheet:
        raise TransferError(
            "the model must have one block of 4-node or of 3-node shells, of shell4_mitc_plus and shell3_mitc_plus for "
            "instance, or one of each, in this order, of one sheet, or of each zone of a welded blank"
        )
    section = blocks[0].section
    assert section is not None  # ShellMechanics asks for it
    return mechanics, section


def _check_fit(sheet: SheetState, procedure: ImplicitProcedure) -> None:
    """Refuse another mesh or law, and a procedure that has already begun."""
    state, mesh = procedure.state, procedure.model.mesh
    same = len(sheet.position) == len(mesh.points) and len(sheet.blocks) == len(mesh.blocks)
    if not same or not all(
        np.array_equal(own.connectivity, block.connectivity)
        for own, block in zip(sheet.blocks, mesh.blocks, strict=True)
    ):
        raise TransferError(_name_meshes(procedure, len(sheet.position), sum(len(b.thickness) for b in sheet.blocks)))
    if state.cells.history[0].shape[-1] != sheet.blocks[0].history.shape[-1]:
        raise TransferError(
            "the model's material keeps another history than that of the explicit shells: give the same law"
        )
    if state[Progress].increments:
        raise TransferError("the implicit procedure has begun already: make a new one for the state to start it")


def _name_meshes(procedure: ImplicitProcedure, n_nodes: int, n_cells: int) -> str:
    mesh = procedure.model.mesh
    return (
        f"the model's mesh ({len(mesh.points)} nodes, {sum(len(b.connectivity) for b in mesh.blocks)} cells) is not "
        f"that of the explicit shells ({n_nodes} nodes, {n_cells} cells): give the same nodes and cells in the same "
        "order"
    )


def _normals(procedure: ImplicitProcedure, points: FloatArray) -> FloatArray:
    """Return the directors (n_directors, 3) of the deformed sheet."""
    directors = _shells_of(procedure)[0].directors
    total = np.zeros_like(directors.vectors)
    for block, of_cell in zip(procedure.model.mesh.blocks, directors.of_cell, strict=True):
        np.add.at(total, of_cell, cell_normals(points, block.connectivity, _core.shell_shape(block.element)[3]))
    total = _unit(total)
    lay_directors(procedure.model, directors, total)
    return total


def _layer_bases(block: CellBlock, points: FloatArray, director: FloatArray, thickness: FloatArray) -> FloatArray:
    """Return the covariant base vectors of every layer (n_cells, q, k, 2, 3).

    points (n_points, 3), director at each cell's nodes (n_cells, nodes, 3), thickness (n_cells, q).
    """
    assert block.section is not None
    slopes = _core.shell_shape(block.element)[1]
    a = np.einsum("qaj,cai->cqji", slopes, points[block.connectivity])
    b = np.einsum("qaj,cai->cqji", slopes, director)
    z = 0.5 * thickness[:, :, None] * thickness_rule(block.section)[0]
    return np.asarray(a[:, :, None] + z[..., None, None] * b[:, :, None])


def at_points(values: FloatArray, q: int) -> FloatArray:
    """Return values (n_cells, any, ...) at q points in the plane: as they are, or their means."""
    if values.shape[1] == q:
        return values
    mean = values.mean(axis=1, keepdims=True)
    return np.broadcast_to(mean, (len(values), q, *values.shape[2:]))


def _unit(vectors: FloatArray) -> FloatArray:
    """Return vectors (..., 3) of length one."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
