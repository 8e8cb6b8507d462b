# SPDX-License-Identifier: Apache-2.0
"""Begin a run that several ranks share; refuse what they do not."""

from __future__ import annotations

from presswork.model import Model, Stage
from presswork.outcome import StartError
from presswork.process.folding import FoldingRecording
from presswork.process.implicit_recording import ImplicitRecording
from presswork.ranks.world import World

REMEDY = "compute it without mpiexec, by one process with --threads"


def begin_on_ranks(model: Model, threads: int, world: World) -> ImplicitRecording:
    """Return the model's procedure before its first increment, its cells divided over ranks. Raises StartError."""
    what = _find_undivided(model)
    if what:
        raise StartError(f"{what}: ranks of MPI share the implicit forming of solids on one mesh; {REMEDY}")
    cells = sum(len(block.connectivity) for block in model.mesh.blocks)
    if world.size > cells:
        raise StartError(
            f"mpiexec has started {world.size} ranks, but the mesh has only {cells} cells: start at most that many; "
            "some thousands of cells for each rank pay"
        )
    folds = model.analysis == "solid" and model.solver.displacements == "large"
    kind = FoldingRecording if folds else ImplicitRecording
    return kind(model, threads=threads or 1, world=world)


def _find_undivided(model: Model) -> str:
    """Name what of a model is not divided over ranks; nothing where all is."""
    if model.explicit is not None:
        return "the case asks for explicit dynamics"
    if model.analysis in ("shell", "stamping"):
        return "the case forms a sheet of shells"
    asked = {
        "heat alone": model.heat is not None and model.heat.alone,
        "new meshes (remesh)": model.remeshing is not None,
        "a series of parts (series)": model.series is not None,
        "derivatives (gradients)": model.gradients is not None,
        "a UMAT": any(material.umat is not None for material in model.materials),
        "a tool in the plane that a force pushes": bool(model.plane_tools) and any(_pushes(s) for s in model.stages),
        "arc length": model.solver.control == "arc_length",
    }
    names = [name for name, is_asked in asked.items() if is_asked]
    return f"the case asks for {' and '.join(names)}" if names else ""


def _pushes(stage: Stage) -> bool:
    return any(motion.push is not None for motion in stage.tool_motion.values())
