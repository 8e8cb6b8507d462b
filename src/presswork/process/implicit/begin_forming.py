# SPDX-License-Identifier: Apache-2.0
"""The implicit procedure of bodies that tools or loads form, with the changes of its mesh that a model asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from presswork.model import Model, Remeshing
from presswork.process.implicit.forming import ImplicitForming
from presswork.ranks.world import World

if TYPE_CHECKING:
    from presswork.process.mesh_change.contract import MeshChange


def begin_forming(model: Model, *, threads: int = 0, world: World | None = None) -> ImplicitForming:
    """Return the run of a model before its first increment. world: ranks that share the cells. Raises StartError."""
    run = ImplicitForming(model, threads=threads, world=world)
    may_remesh = model.remeshing is not None
    if may_remesh or (model.analysis == "solid" and model.solver.displacements == "large"):
        from presswork.process.implicit.folding import Folding

        run.add_mesh_change(Folding(run))
    if model.remeshing is not None:
        run.add_mesh_change(_make_new_meshes(run, model.remeshing))
    return run


def _make_new_meshes(run: ImplicitForming, settings: Remeshing) -> MeshChange:
    """Return what makes new meshes of the bodies of a run."""
    from presswork.process.implicit.new_meshes import NewMeshes

    if run.model.analysis == "solid":
        from presswork.process.implicit.bodies_in_space import BodiesInSpace

        return NewMeshes(run, BodiesInSpace(run, settings))
    from presswork.process.implicit.bodies_in_plane import BodiesInPlane

    return NewMeshes(run, BodiesInPlane(run, settings))
