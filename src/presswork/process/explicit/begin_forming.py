# SPDX-License-Identifier: Apache-2.0
"""The explicit procedure of solids, with the changes of its mesh that a model asks for."""

from __future__ import annotations

from presswork.model import ExplicitSolid, Model
from presswork.process.explicit.forming import ExplicitForming
from presswork.ranks.world import World


def begin_explicit_forming(model: Model, *, threads: int = 0, world: World | None = None) -> ExplicitForming:
    """Return the run of a model before its first row. world: ranks that share it. Raises StartError, ExplicitError."""
    assert isinstance(model.explicit, ExplicitSolid)
    may_remesh = model.remeshing is not None and not model.remeshing.obstacle
    if model.dimension == 3:
        return _begin_in_space(model, may_remesh, threads, world)
    from presswork.process.explicit.solids_in_plane import SolidsInPlane

    run = ExplicitForming(model, SolidsInPlane(model.explicit, world), threads=threads)
    if may_remesh and len(model.bodies) < 2 and (not model.contacts or model.separation):
        from presswork.process.explicit.moving_section import MovingSection
        from presswork.process.explicit.new_meshes import IntervalMeshes

        assert model.remeshing is not None
        section = MovingSection(run, model.remeshing, world)
        meshes = IntervalMeshes(run, section)
        if model.separation is not None:
            from presswork.process.explicit.separation import CrackGrowth, DamageOfRow

            row = DamageOfRow(run)
            run.add_mesh_change(CrackGrowth(run, model.separation, meshes, section, row))
        run.add_mesh_change(meshes)
        if model.separation is not None:
            run.add_mesh_change(row)
    return run


def _begin_in_space(model: Model, may_remesh: bool, threads: int, world: World | None) -> ExplicitForming:
    from presswork.process.explicit.solids_in_space import SolidsInSpace

    assert isinstance(model.explicit, ExplicitSolid)
    domain = SolidsInSpace(model, model.explicit, world)
    run = ExplicitForming(model, domain, threads=threads)
    if may_remesh:
        from presswork.process.explicit.moving_tetrahedra import MovingTetrahedra
        from presswork.process.explicit.new_meshes import IntervalMeshes

        assert model.remeshing is not None
        run.add_mesh_change(IntervalMeshes(run, MovingTetrahedra(run, domain, model.remeshing, world)))
    return run
