# SPDX-License-Identifier: Apache-2.0
"""The state of a sheet from explicit dynamics to the implicit procedure, and back.

Positions, thickness, and stress and history of the law of every layer are carried over; their components stay as they
are, in the frame of the law, and the frame goes with them. A one-point shell gives what it has to all points of the
implicit shell; the other way it takes the mean of the points.

Explicit shells keep no directors, so the implicit ones begin with the sheet's normals, without transverse shear.
Hourglass forces stay behind, being no stress. So the state carried over is nearly, not wholly, in balance: what it
lacks is held by forces that fade over the first stage, as the reactions of one stage do in the next.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork import _core
from presswork.mesh.directors import cell_normals
from presswork.model import CellBlock, FloatArray, Section
from presswork.procedure.explicit import ExplicitShells, Precision, ShellOptions
from presswork.procedure.implicit import ImplicitProcedure
from presswork.procedure.shell_mechanics import ShellFailed, ShellMechanics, lay_directors
from presswork.procedure.thickness_rule import thickness_rule
from presswork.sheet_law import make_sheet_law

CENTRE = np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0]]) / 4.0
"""Slopes of the shape functions at the centre (2, 4)."""


class TransferError(ValueError):
    """A state that does not fit the model that it is to go on in."""


def carry_to_implicit(shells: ExplicitShells, procedure: ImplicitProcedure) -> None:
    """Let an implicit procedure, fresh from its model, begin with the present state of explicit shells.

    Its mesh is the undeformed one that strains are counted from, with the nodes and cells of the explicit shells in the
    same order; its section has their rule through the thickness. Velocities are left behind, and what is out of
    balance is held by forces that fade over the first stage. The energy stored counts as work done.
    Raises TransferError for another mesh, section or law, or cells that have folded.
    """
    mechanics, section, block = _shells_of(procedure)
    state, mesh = procedure.state, procedure.model.mesh
    _check_fit(shells, procedure, section, block)
    points = shells.position
    state.displacement[:, :3] = points - mesh.points
    own = state.shells
    own.director[:] = _normals(procedure, points)
    own.thickness[0][:] = shells.thickness[:, None]
    g = _layer_bases(procedure, points)
    normal = _unit(np.cross(g[..., 0, :], g[..., 1, :]))
    axis = law_axes(shells)[:, None, None]
    first = _unit(axis - (axis * normal).sum(axis=-1, keepdims=True) * normal)
    along = _unit(g[..., 0, :])
    own.direction[0][:] = np.stack(
        [(along * first).sum(axis=-1), (along * np.cross(normal, first)).sum(axis=-1)], axis=-1
    )
    cells, q, k = own.history[0].shape[:3]
    own.history[0][:] = shells.history[:, None]
    state.stress[0].reshape(cells, q, k, 3)[:] = shells.stress[:, None]
    state.eqps[0].reshape(cells, q, k)[:] = shells.equivalent_plastic_strain[:, None]

    trial = state.duplicate()
    force = mechanics.evaluate(state, trial, np.zeros_like(state.displacement), with_stiffness=False)
    if isinstance(force, ShellFailed):
        raise TransferError(f"the deformed sheet cannot be taken over: {force}")
    state.volume = trial.volume
    procedure.initial_volume = procedure.volume()
    own.fading = np.where(mechanics.supports.fixed(0), 0.0, force)
    state.external_force, state.reaction = own.fading.copy(), force - own.fading
    state.peak_force[:] = np.abs(force / mechanics.length).max()
    state.work[0] = mechanics.elastic_energy(state)


def carry_to_explicit(
    procedure: ImplicitProcedure, *, options: ShellOptions | None = None, precision: Precision = "double"
) -> ExplicitShells:
    """Return explicit shells at rest in the present state of an implicit procedure.

    They start from the deformed sheet: its thickness, and the directions that the law's x has turned to. options:
    all but n_points and rule, which are those of the section. What the stage held must be held anew.
    Raises TransferError for a model of more than one block of 4-node shells, or a rule that explicit shells lack.
    """
    _, section, block = _shells_of(procedure)
    if section.rule == "simpson":
        raise TransferError('explicit shells have no Simpson rule: give the section rule = "lobatto" or "gauss"')
    state, material = procedure.state, procedure.model.materials[block.material]
    points = procedure.model.mesh.points + state.displacement[:, :3]
    own = state.shells
    g = _layer_bases(procedure, points)
    along = _unit(g[..., 0, :])
    across = np.cross(_unit(np.cross(g[..., 0, :], g[..., 1, :])), along)
    direction = own.direction[0]
    axis = (direction[..., :1] * along - direction[..., 1:] * across).mean(axis=(1, 2))
    options = replace(options or ShellOptions(), n_points=section.points, rule=section.rule)
    shells = ExplicitShells(
        points,
        block.connectivity,
        own.thickness[0].mean(axis=1),
        make_sheet_law(material),
        material.density,
        axis=axis,
        options=options,
        precision=precision,
    )
    stress = state.stress[0].reshape(*own.history[0].shape[:3], 3)
    shells.set_layers(stress.mean(axis=1), own.history[0].mean(axis=1))
    return shells


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


def _shells_of(procedure: ImplicitProcedure) -> tuple[ShellMechanics, Section, CellBlock]:
    """Return mechanics, section and block of a model of 4-node shells."""
    mechanics, blocks = procedure.mechanics, procedure.model.mesh.blocks
    if not isinstance(mechanics, ShellMechanics) or len(blocks) != 1 or blocks[0].connectivity.shape[1] != 4:
        raise TransferError("the model must have one block of 4-node shells, of shell4_mitc_plus for instance")
    section = blocks[0].section
    assert section is not None  # ShellMechanics asks for it
    return mechanics, section, blocks[0]


def _check_fit(shells: ExplicitShells, procedure: ImplicitProcedure, section: Section, block: CellBlock) -> None:
    """Refuse another mesh, section or law."""
    options, state = shells.options, procedure.state
    n = len(procedure.model.mesh.points)
    if len(shells.start) != n or not np.array_equal(shells.connectivity, block.connectivity):
        raise TransferError(
            f"the model's mesh ({n} nodes, {len(block.connectivity)} cells) is not that of the explicit shells "
            f"({len(shells.start)} nodes, {len(shells.connectivity)} cells): give the same nodes and cells in the same "
            "order"
        )
    if (section.points, section.rule) != (options.n_points, options.rule):
        raise TransferError(
            f"the model's section has {section.points} points of the {section.rule} rule, the explicit shells "
            f"{options.n_points} of the {options.rule} rule: stresses of layers have no place in others"
        )
    if state.shells.history[0].shape[-1] != shells.history.shape[-1]:
        raise TransferError(
            "the model's material keeps another history than that of the explicit shells: give the same law"
        )
    if state.progress[:4].any():
        raise TransferError("the implicit procedure has begun already: make a new one for the state to start it")


def _normals(procedure: ImplicitProcedure, points: FloatArray) -> FloatArray:
    """Return the directors (n_directors, 3) of the deformed sheet."""
    mechanics, _, block = _shells_of(procedure)
    directors = mechanics.directors
    weighted = cell_normals(points, block.connectivity, _core.shell_shape(block.element)[3])
    total = np.zeros_like(directors.vectors)
    np.add.at(total, directors.of_cell[0], weighted)
    total = _unit(total)
    lay_directors(procedure.model, directors, total)
    return total


def _layer_bases(procedure: ImplicitProcedure, points: FloatArray) -> FloatArray:
    """Return the covariant base vectors of every layer (n_cells, q, k, 2, 3)."""
    mechanics, section, block = _shells_of(procedure)
    slopes, own = _core.shell_shape(block.element)[1], procedure.state.shells
    a = np.einsum("qaj,cai->cqji", slopes, points[block.connectivity])
    b = np.einsum("qaj,cai->cqji", slopes, own.director[mechanics.directors.of_cell[0]])
    z = 0.5 * own.thickness[0][:, :, None] * thickness_rule(section)[0]
    return np.asarray(a[:, :, None] + z[..., None, None] * b[:, :, None])


def _unit(vectors: FloatArray) -> FloatArray:
    """Return vectors (..., 3) of length one."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))
