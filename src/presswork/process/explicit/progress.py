# SPDX-License-Identifier: Apache-2.0
"""How far an explicit run is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from presswork.state import ANEW, RUN, Arrays, OnNewMesh


@dataclass
class IntervalProgress(Arrays):
    """How far a run is."""

    owner = "progress"
    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        "rows": RUN,
        "stage": RUN,
        "row": RUN,
        "added_mass": RUN,
        "ram_work": RUN,
        "stage_work": RUN,
        "stage_way": RUN,
    }
    rows: int
    """Rows of each stage."""
    stage: int = 0
    row: int = 0
    """Row of the stage that comes next."""
    added_mass: float = 0.0
    """Added mass in per cent of the true mass."""
    ram_work: float = 0.0
    """Work of the ram since the start [N mm]."""
    stage_work: float = 0.0
    """Work of the ram in the present stage [N mm]."""
    stage_way: float = 0.0
    """Way of the ram in the present stage [mm]."""


@dataclass
class SheetProgress(IntervalProgress):
    """The same of a stamping."""

    on_new_mesh: ClassVar[Mapping[str, OnNewMesh]] = {
        **IntervalProgress.on_new_mesh,
        "cycles": RUN,
        "shell_cycles": RUN,
        "mesh_factor": ANEW,
    }
    cycles: int = 0
    """So far."""
    shell_cycles: int = 0
    """Sum over them of the number of shells."""
    mesh_factor: float = 0.0
    """Stable step of the mesh over that of its shells; 0 until found."""
