# SPDX-License-Identifier: Apache-2.0
"""Forming and impacts of a solid in space by explicit dynamics, between rigid tools: what differs from the plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.body.laws_of_solids import make_law
from presswork.evolution.damage import make_damage
from presswork.explicit.motion import Motion
from presswork.explicit.space_solids import ExplicitSpaceSolids, SpaceWall
from presswork.fields.solid_fields import effective_stress
from presswork.geometry.tool_surface import make_surface
from presswork.law.elastic_plastic import heats
from presswork.mesh.box import node_volumes
from presswork.model import FloatArray, Mesh
from presswork.process.impact import ExplicitImpact
from presswork.process.limits import Measure, Watched, measure_hydrostatic_stress, measure_mean_pressure
from presswork.process.peaks import find_peaks
from presswork.process.penetration import Penetration
from presswork.process.recording import Snapshot
from presswork.process.shear_friction import ShearFriction, find_coefficient
from presswork.process.space_surfaces import cut_tools


class ExplicitSpaceImpact(ExplicitImpact):
    """A Model of a solid in space with `explicit` at work."""

    walls: list[SpaceWall]

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        model = self.model
        material = model.materials[model.mesh.blocks[0].material]
        law = make_law(material, model.solver, 6)
        self.solids = ExplicitSpaceSolids(
            model.mesh,
            law,  # type: ignore[arg-type]
            material.density,
            hourglass_fraction=self.settings.hourglass_stiffness,
            damage=make_damage(material.damage, None, is_solid=True),
            start=material.heating.start if material.heating else 20.0,
            heats=heats(material),
        )
        self.walls = [
            self.solids.add_wall(
                tool.name,
                make_surface(tool.surface, smooth=True),
                position=tool.position,
                mu=find_coefficient(tool.friction),
            )
            for tool in model.space_tools
        ]
        self._reaction = np.zeros(model.mesh.points.shape)
        self._shear = ShearFriction(model.space_tools, model.mesh)

    def _run_to(self, to: float, motion: Motion | None) -> None:
        self._shear.set(
            self.walls, self.solids.position, np.maximum(self._flow_stress(), effective_stress(self.solids.stress))
        )
        super()._run_to(to, motion)

    def _find_dies(self) -> tuple[Mesh, FloatArray, dict[str, FloatArray]]:
        return self.model.mesh, self.solids.position, {}

    def watch(self) -> Watched:
        """Return how far the present state is towards its limits."""
        model, solids = self.model, self.solids
        names = [tool.name for tool in model.space_tools]
        deepest = Penetration().note_in_space(model.mesh, solids.position, names, self._find_gaps)
        stress, flow = solids.stress, self._flow_stress()
        mean = stress[:, :3].mean(axis=1)
        centres = solids.position[model.mesh.blocks[0].connectivity].mean(axis=1)
        hydrostatic = measure_hydrostatic_stress(mean, flow, centres)
        peaks = find_peaks(model.mesh, solids.position, solids.damage, solids.critical_damage())
        return Watched(
            (hydrostatic, *self._measure_pressure(mean, flow), *([deepest] if deepest else [])), damage=peaks
        )

    def _measure_pressure(self, stress: FloatArray, flow_stress: FloatArray) -> list[Measure]:
        if not self.model.space_tools:
            return []
        volume = node_volumes(self.solids.position, self.model.mesh.blocks[0].connectivity).sum(axis=1)
        return [measure_mean_pressure("workpiece", stress, flow_stress, volume)]

    def _find_gaps(self, places: FloatArray) -> FloatArray:
        """Return the distance of places (n, 3) from each tool (n_tools, n) [mm]; infinity far off it."""
        gaps = []
        for tool, wall in zip(self.model.space_tools, self.walls, strict=True):
            seen = np.ascontiguousarray(places - np.array(tool.position) - wall.displacement)
            gaps.append(make_surface(tool.surface, smooth=True).nearest(seen, 0.0)[0])
        return np.array(gaps).reshape(-1, len(places))

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state."""
        return replace(super().snapshot(), surfaces=cut_tools(self.model))
