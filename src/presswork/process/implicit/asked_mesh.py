# SPDX-License-Identifier: Apache-2.0
"""A mesh change of your own: a function that is asked after every increment for the mesh with which a run goes on."""

from __future__ import annotations

from presswork.implicit.epochs import AskForMesh, Epoch, new_epoch
from presswork.process.implicit.increments import IncrementRun, find_position
from presswork.process.mesh_change.contract import MeshChange


class AskedMesh(MeshChange):
    """Goes on with the mesh that a function returns."""

    def __init__(self, run: IncrementRun, ask: AskForMesh) -> None:
        self._run, self._ask = run, ask

    def look(self, failure: str = "") -> bool:
        """Ask for another mesh, and go on with it. Raises GaveUpError."""
        run = self._run
        found = self._ask(Epoch(run.model.mesh, run.procedure.state, run.procedure, failure))
        if found is None:
            return False
        after = new_epoch(run.procedure, found.mesh, found.transfer)
        run.begin_on(after, found.origin, find_position(after))
        cells = sum(len(block.connectivity) for block in found.mesh.blocks)
        run.notes.append(f"new mesh of {cells} cells after increment {run.number} {found.reason}".rstrip())
        return True
