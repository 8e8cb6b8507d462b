# SPDX-License-Identifier: Apache-2.0
"""What the implicit and the explicit engine share: observers, mesh changes, and what is not there to be observed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.model import FloatArray, Model
from presswork.observe.contract import Metal, ToolGaps
from presswork.observe.of_model import list_observers
from presswork.process.mesh_change.contract import MeshChange

if TYPE_CHECKING:
    from presswork.observe.contract import Observers


class ObservedRun:
    """A run with observers; it is itself what they see. A kind of body overrides what it has."""

    model: Model
    observers: Observers
    mesh_changes: list[MeshChange]
    """Changes of the mesh, called one after the other between increments or before intervals; they are among the
    observers, too."""
    notes: list[str]
    """Notes for the log of the next increment or interval."""

    def begin_observing(self) -> None:
        """Begin with new observers, without mesh changes."""
        self.mesh_changes, self.notes = [], []
        self.list_observers()

    def list_observers(self) -> None:
        """Begin with new observers."""
        self.observers = list_observers(self.model)
        for change in self.mesh_changes:
            self.observers.add(change)

    def add_mesh_change(self, change: MeshChange) -> None:
        """Let the mesh of the run change."""
        self.mesh_changes.append(change)
        self.observers.add(change)

    def take_notes(self) -> list[str]:
        """Return the notes for the log, once."""
        notes, self.notes = self.notes, []
        return notes

    def body_heat(self) -> tuple[HeatOfForming, HeatArrays] | None:
        """Return nothing, unless solids have heat."""
        return None

    def sheet_heat(self) -> tuple[HeatOfSheet, SheetHeatArrays] | None:
        """Return nothing, unless a sheet has heat."""
        return None

    def overlap(self) -> float:
        """Return nothing, unless a sheet overlaps itself [mm]."""
        return 0.0

    def sheet_pressures(self) -> Mapping[str, float]:
        """Return nothing, unless fluids press a sheet."""
        return {}

    def held_rates(self) -> Mapping[str, float]:
        """Return nothing, unless pressures hold the strain rate of a sheet."""
        return {}

    def metal(self) -> list[Metal]:
        """Return nothing, unless solids are formed."""
        return []

    def held_part(self) -> float | None:
        """Return nothing, unless it is known what holds solids."""
        return None

    def tool_gaps(self) -> ToolGaps | None:
        """Return nothing, unless tools form solids."""
        return None

    def sheet_fields(self, *, with_surface: bool) -> Mapping[str, FloatArray]:
        """Return nothing, unless a sheet is formed."""
        return {}

    def tool_depths(self) -> Mapping[str, float]:
        """Return nothing, unless tools form a sheet."""
        return {}
