# SPDX-License-Identifier: Apache-2.0
"""The contract of a change of the mesh, between increments of an implicit run or intervals of an explicit one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from presswork.observe.contract import Observer


class MeshChange(Observer):
    """Puts a run that it has looked at on another mesh. It is an observer of that run, too, and reports what it did."""

    def look(self, failure: str = "") -> bool:
        """Change the mesh where the present one should not go on; return whether there is another one.

        failure: why the run cannot go on with it; empty where nothing has failed.
        """
        raise NotImplementedError

    def end_step(self) -> None:
        """Note what has moved in an interval of an explicit run, once it is over."""

    def begin_log(self) -> str:
        """Return its part of the line that begins the log."""
        return ""

    def find_hints(self) -> list[str]:
        """Return what may have made the run fail."""
        return []

    def prepare_epoch(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        """Make ready for an epoch of a checkpoint, which `arrays` has given in part, before its mesh is taken up."""
