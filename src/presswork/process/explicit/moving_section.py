# SPDX-License-Identifier: Apache-2.0
"""A body in the plane in an explicit run: its section where it is, why it needs a new mesh, and that mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.geometry.pose import ToolPose, place_segments, start_profile
from presswork.model import BoolArray, ElementName, FloatArray, Remeshing
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.new_meshes import MadeMesh
from presswork.process.explicit.present_bodies import NEAR, PlasticVolumes, find_held
from presswork.process.mesh_change.mesh_reasons import find_reason, find_reason_to_leave_first
from presswork.process.mesh_change.new_epoch import make_on_lead
from presswork.ranks.world import World
from presswork.remesh.carrier import Part
from presswork.remesh.old_section import OldSection, with_cracks
from presswork.remesh.section import NewSection, remesh_section, remesh_with_cracks
from presswork.remesh.size_field import SizeSources, measure_power
from presswork.remesh.slit import Outline, blunt_spikes

CRACKED_WAIT = 2.0
"""Factor on the triggers of sections with cracks, whose cells are worse from the first on."""
ELEMENT: ElementName = "quad4_1pt"
"""Element of new meshes of triangles."""


class MovingSection:
    """The one body of a run in the plane or in axisymmetry."""

    def __init__(self, run: ExplicitForming, settings: Remeshing, world: World | None = None) -> None:
        """world: ranks that share the run; the first of them makes new meshes."""
        self._run, self._settings, self._world = run, settings, world
        self._volumes = PlasticVolumes(run, self.find_volumes)
        self._cut: Outline | None = None
        """The outline with the cracks that the next mesh is to have."""
        self._new_tips: list[FloatArray] = []
        self.cracked: BoolArray = np.zeros(0, dtype=bool)
        """Nodes on the faces of cracks (n_points,); none while there is no crack."""
        self.tips: list[int] = []
        """Nodes at the tips of cracks."""
        self._tried_at, self._tries = -1, 0
        """Row before which a mesh with cracks was last made, and how many came before it there."""
        self.crack_sizes: SizeSources | None = None
        """Sizes of cells wanted where cracks grow."""

    @property
    def smallest_size(self) -> float:
        """Least edge of cells [mm]."""
        return self._settings.smallest_size

    def cut(self, outline: Outline | None, tips: list[FloatArray]) -> None:
        """Let the next mesh have cracks with tips at places (2,) [mm]; None: it has no further ones."""
        self._cut, self._new_tips = outline, tips

    def find_obstacle(self) -> str:
        """Return that nothing prevents new meshes: the model's builder has looked."""
        return ""

    def find(self, increment: FloatArray) -> list[OldSection]:
        """Return the body where it is now; increment: what the last row has moved the nodes by (n_points, 2) [mm]."""
        run = self._run
        mesh, position = run.model.mesh, run.solids.position
        profiles = [
            place_segments(start_profile(tool), ToolPose(np.zeros(2), wall.displacement, 0.0))
            for tool, wall in zip(run.model.tools, run.walls, strict=True)
        ]
        gaps = [_core.touch_profile(profile, np.ascontiguousarray(position))[0] for profile in profiles]
        near = NEAR * self._settings.smallest_size
        on_tool = np.abs(np.array(gaps).reshape(len(profiles), len(position))) < near
        on_tool &= np.isin(np.arange(len(position)), mesh.boundary_edges)
        ring = run.model.analysis == "axisymmetric"
        lost, power = self._volumes.find_lost(), self._find_power(increment)
        held = find_held(run)
        own = range(len(position))
        return [
            OldSection(
                mesh, position, on_tool, held, profiles, ring, own, lost, power, ELEMENT,
                is_cracked=len(self.cracked) > 0, firm=self.tips, cracks=self.crack_sizes,
            )
        ]  # fmt: skip

    def _find_power(self, increment: FloatArray) -> FloatArray | None:
        """Return the stress power over volume in the last row, in each cell (n_cells,) [MPa]; None: nothing moved."""
        if not self._settings.error or not increment.any():
            return None
        run = self._run
        cells, ring = run.model.mesh.blocks[0].connectivity, run.model.analysis == "axisymmetric"
        return measure_power(run.solids.position[cells], increment[cells], run.solids.stress, ring=ring)

    def find_reason(self, number: int, old: OldSection, increment: FloatArray, *, is_first: bool) -> str | None:
        """Return why the body needs a new mesh; is_first: it has its first mesh."""
        if is_first:
            return find_reason_to_leave_first(old)
        return find_reason(old, increment, self._settings, wait=CRACKED_WAIT if old.is_cracked else 1.0)

    def make(self, bodies: set[int], increment: FloatArray, density: FloatArray) -> MadeMesh:
        """Return a new mesh. Raises MeshError where none can be made."""
        (old,) = self.find(increment)
        tips = [old.position[tip] for tip in self.tips] if self._cut is None else self._new_tips
        if self._cut is not None or old.is_cracked:
            cut = self._cut or Outline(old.position, tuple(old.chains), tuple(old.firm))
            old = with_cracks(old, blunt_spikes(cut, self._settings.smallest_size))
        remesh = remesh_section
        if old.is_cracked:
            self._tries = self._tries + 1 if self._tried_at == self._run.number else 0
            self._tried_at = self._run.number
            remesh = partial(remesh_with_cracks, tries=self._tries)
        new = make_on_lead(self._world, remesh, old, self._settings)
        points = range(len(self._run.model.mesh.points)), range(len(new.mesh.points))
        self._follow_cracks(new, tips)
        return MadeMesh(new.mesh, new.mesh.points, [Part(*points, 0, new.surface(0, 0), new.line.seams)])

    def _follow_cracks(self, new: NewSection, tips: list[FloatArray]) -> None:
        """Find the faces and tips (2,) [mm] of cracks on a new mesh."""
        if not len(self.cracked) and self._cut is None:
            return
        of_chain = new.chain >= new.n_old
        if len(self.cracked):
            old = ~of_chain
            of_chain[old] = self.cracked[new.chain[old]]
        before = new.line.place.astype(int)
        after = new.following[before]
        at_node = new.line.place == before
        marked = of_chain[before] & (at_node | of_chain[after])
        self.cracked = np.zeros(len(new.mesh.points), dtype=bool)
        self.cracked[: len(marked)] = marked
        line = new.line.points
        self.tips = [int(np.argmin(np.linalg.norm(line - tip, axis=1))) for tip in tips]
        self._cut, self._new_tips = None, []

    def find_volumes(self) -> list[FloatArray]:
        """Return the volume of each cell of each block (n_cells,) [mm3]; of 1 rad, or 1 mm of depth."""
        run = self._run
        x, y = np.moveaxis(run.solids.position[run.model.mesh.blocks[0].connectivity], -1, 0)
        area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
        return [np.asarray(area * (x.mean(axis=1) if run.model.analysis == "axisymmetric" else 1.0))]

    def measure(self) -> list[float]:
        """Return the volume of the body without its elastic part, in the unit of find_volumes."""
        return self._volumes.measure()

    def note_meshes(self, is_new: Sequence[bool]) -> None:
        """Note nothing: what is wrong with a mesh is seen on the next look."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the faces and tips of cracks."""
        return {"cracked": self.cracked, "crack_tips": np.array(self.tips, dtype=np.int64)} if len(self.cracked) else {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        self.cracked = np.array(arrays.get("cracked", np.zeros(0)), dtype=bool)
        self.tips = [int(tip) for tip in arrays.get("crack_tips", ())]
