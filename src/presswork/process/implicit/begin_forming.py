# SPDX-License-Identifier: Apache-2.0
"""The implicit procedure of bodies that tools or loads form, with the changes of its mesh that a model asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from presswork.model import Model, Remeshing
from presswork.process.implicit.forming import ImplicitForming
from presswork.ranks.world import World

if TYPE_CHECKING:
    from presswork.process.implicit.new_meshes import MeshedBodies


def begin_forming(model: Model, *, threads: int = 0, world: World | None = None) -> ImplicitForming:
    """Return the run of a model before its first increment. world: ranks that share the cells. Raises StartError."""
    run = ImplicitForming(model, threads=threads, world=world)
    may_remesh = model.remeshing is not None
    if may_remesh or (model.analysis == "solid" and model.solver.displacements == "large"):
        from presswork.process.implicit.folding import Folding

        run.add_mesh_change(Folding(run))
    if model.remeshing is not None:
        from presswork.process.implicit.new_meshes import NewMeshes

        run.add_mesh_change(NewMeshes(run, _find_bodies(run, model.remeshing)))
    return run


def _find_bodies(run: ImplicitForming, settings: Remeshing) -> MeshedBodies:
    """Return the bodies of a run as new meshes are made of them."""
    if run.model.analysis == "solid":
        from presswork.process.implicit.bodies_in_space import BodiesInSpace

        return BodiesInSpace(run, settings)
    from presswork.process.implicit.bodies_in_plane import BodiesInPlane

    return BodiesInPlane(run, settings)
