# SPDX-License-Identifier: Apache-2.0
"""Shells of an explicit stamping that are split where they are bent, or will be, each into four."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from presswork.mesh.split import SplitMesh
from presswork.model import BoolArray, IntArray
from presswork.observe.contract import Observed, Row
from presswork.process.mesh_change.contract import MeshChange
from presswork.process.mesh_change.refinement import choose_shells, find_planes, place_nodes
from presswork.process.mesh_change.transfer import ShellStart
from presswork.process.model_run import NamedArrays

if TYPE_CHECKING:
    from presswork.process.explicit.stamping import ExplicitStamping

START = "start."
"""Prefix in a checkpoint of what the shells of a later operation start from."""


class RefinedSheet(MeshChange):
    """The sheet of a run as it has been split; without [refinement] it stays as it is."""

    def __init__(self, run: ExplicitStamping, start: ShellStart | None, level: int) -> None:
        """start: what the shells of a later operation start from. level: how often they have been split by then."""
        self._run, self._first_level = run, level
        self.start = start
        self._sheet = self._begin()

    def _begin(self) -> SplitMesh:
        """Return the present mesh before this operation has split any shell."""
        model = self._run.model
        sheet = SplitMesh.begin(model.cells, len(model.mesh.points))
        return replace(sheet, level=sheet.level + self._first_level)

    @property
    def level(self) -> int:
        """How often the shells that were split most have been split."""
        return int(self._sheet.level.max())

    def find_hanging(self) -> IntArray:
        """Return the nodes that hang on edges of larger shells, as SplitMesh has them."""
        return self._sheet.hanging()

    def columns(self, run: Observed) -> list[str]:
        """Return the number of shells, where it may change."""
        return ["shells"] if self._run.model.refinement else []

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the number of shells."""
        return {"shells": len(self._run.model.cells)} if self._run.model.refinement else {}

    def look(self, failure: str = "") -> bool:
        """Split the shells that are bent, or will be; again, as far as there are levels."""
        run, settings, is_new = self._run, self._run.model.refinement, False
        if settings is None:
            return False
        for _ in range(settings.levels):
            shells, tools, planes = run.shells, run.tools.placed(), find_planes(run.mesh)
            chosen = choose_shells(self._sheet, shells.position, shells.thickness, tools, settings, planes)
            if not chosen.any():
                break
            self._split(chosen)
            is_new = True
        return is_new

    def _split(self, chosen: BoolArray) -> None:
        """Split the chosen shells (n,), and others as far as neighbours would be more than a level apart."""
        run, old, step = self._run, self._run.shells, self._sheet.split(chosen)
        planes, tools = find_planes(run.mesh), run.tools.placed()
        position = place_nodes(self._sheet, step, old.position, old.thickness, planes, tools)
        self._sheet = step.mesh
        if (start := self.start) is not None:
            place, parent = step.interpolate(start.position), step.parent
            self.start = ShellStart(place, start.thickness[parent], start.axis[parent])
        run.begin_epoch(step.apply(run.mesh))
        run.make_shells_again()
        run.begin_stage()
        run.shells.inherit(old, position, step.node_parents(), step.parent)
        run.layers.split(step.parent, old)

    def split_evenly(self) -> None:
        """Split all shells as often as those split most, so that no node hangs."""
        while len(self._sheet.hanging()):
            level = self._sheet.level
            self._split(level < level.max())

    def epoch_arrays(self) -> NamedArrays:
        """Return how the mesh of the epoch came about; nothing of the first one."""
        sheet, start = self._sheet, self.start
        if not self._run.epoch:
            return {}
        begun = {} if start is None else {f"{START}{name}": values for name, values in vars(start).items()}
        return {"level": sheet.level, "side": sheet.side, "middle": sheet.middle, **begun}

    def begin_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Take up the mesh of an epoch, of which epoch_arrays gave the rest."""
        sheet = self._begin()
        if self._run.epoch:
            sheet = replace(sheet, level=epoch["level"], side=epoch["side"], middle=epoch["middle"])
        if self._run.epoch and self.start is not None:
            begun = {name: values for name, values in epoch.items() if name.startswith(START)}
            self.start = ShellStart(**{name.removeprefix(START): values for name, values in begun.items()})
        self._sheet = sheet
