# SPDX-License-Identifier: Apache-2.0
"""Begin a run that several ranks share; refuse what they do not."""

from __future__ import annotations

from collections.abc import Mapping

from presswork.explicit.input_checks import ExplicitError
from presswork.model import Model, Stage
from presswork.outcome import StartError
from presswork.process.begin import choose
from presswork.process.run import Run
from presswork.ranks.world import RanksError, World, start_petsc

SHARED = "the forming of solids and of sheets, implicit and explicit"
REMEDY = "compute it without mpiexec, by one process with --threads"


def begin_on_ranks(model: Model, threads: int, world: World) -> Run:
    """Return the model's procedure at its start, its cells divided over ranks. Raises StartError."""
    what = _find_undivided(model) if model.explicit is None else _find_undivided_explicit(model)
    if what:
        raise StartError(f"{what}: ranks of MPI share {SHARED}; {REMEDY}")
    cells = sum(len(block.connectivity) for block in model.mesh.blocks)
    if world.size > cells:
        raise StartError(
            f"mpiexec has started {world.size} ranks, but the mesh has only {cells} cells: start at most that many; "
            "some thousands of cells for each rank pay"
        )
    try:
        if model.explicit is None:
            start_petsc(world)
        return choose(model, threads or 1, world)
    except (RanksError, ExplicitError) as error:
        raise StartError(str(error)) from error


def _find_undivided_explicit(model: Model) -> str:
    """Name what of an explicit model is not divided over ranks; nothing where all is."""
    assert model.explicit is not None
    asked = {
        f'device = "{model.explicit.device}"': model.explicit.device != "cpu",
        "an end by a value (limits.end)": bool(model.limits.end),
        'explicit.step_bound = "mesh"': getattr(model.explicit, "step_bound", "shells") == "mesh",
    }
    return _list(asked)


def _find_undivided(model: Model) -> str:
    """Name what of an implicit model is not divided over ranks; nothing where all is."""
    asked = {
        "heat alone": model.heat is not None and model.heat.alone,
        "a series of parts (series)": model.series is not None,
        "an end by a value (limits.end)": bool(model.limits.end),
        "derivatives (gradients)": model.gradients is not None,
        "a UMAT": any(material.umat is not None for material in model.materials),
        "a tool in the plane that a force pushes": bool(model.plane_tools) and any(_pushes(s) for s in model.stages),
        "arc length": model.solver.control == "arc_length",
    }
    return _list(asked)


def _list(asked: Mapping[str, bool]) -> str:
    names = [name for name, is_asked in asked.items() if is_asked]
    return f"the case asks for {' and '.join(names)}" if names else ""


def _pushes(stage: Stage) -> bool:
    return any(motion.push is not None for motion in stage.tool_motion.values())
