# SPDX-License-Identifier: Apache-2.0
"""Impacts and other fast motions of a solid by explicit dynamics: stages in rows of cycles, between rigid walls.

It knows nothing of files: recorder.py records what it yields.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.energy import EnergyBalance
from presswork.explicit.input_checks import check_damping
from presswork.explicit.motion import EvenMotion, Motion
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.fields.solid_fields import effective_stress
from presswork.geometry.pose import start_profile
from presswork.model import Blow, Drive, ExplicitSolid, FloatArray, Model, Stage, ToolMotion
from presswork.process.explicit.contacts_of_rows import ContactsOfRows, find_touching
from presswork.process.explicit.heat_of_rows import HeatOfRows, heat_by_itself
from presswork.process.explicit.impact_recording import ImpactRecording
from presswork.process.explicit.loose_rows import LooseRows, find_held_by_wall
from presswork.process.explicit.row_history import RowHistory
from presswork.process.explicit.rows import RowProgress
from presswork.process.explicit.shear_friction import find_coefficient
from presswork.process.explicit.stage_motion import find_motion
from presswork.process.model_recording import NamedArrays
from presswork.ranks.world import World
from presswork.threads import available_threads

STEPS_OF_A_ROW = 10  # in each of which the ram of a blow keeps its speed


class ExplicitImpact(ImpactRecording):
    """A Model with `explicit` at work."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        """world: ranks that share the cycles."""
        assert isinstance(model.explicit, ExplicitSolid)
        super().__init__(model, threads, RowProgress(model.output.rows))
        self.settings, self._world = model.explicit, world
        self._materials = [SolidMaterial.from_model(heat_by_itself(model, material)) for material in model.materials]
        self.make_run({})
        self.solids.set_velocity(np.arange(len(model.mesh.points)), self.settings.velocity)
        for body, velocity in zip(model.bodies[1:], self.settings.velocity_of_others, strict=False):
            self.solids.set_velocity(np.asarray(body.points), velocity)
        self._force = np.zeros((len(self.walls), model.dimension))
        if self.settings.target_step is not None and self.solids.dt < self.settings.target_step:
            self._progress.added_mass = self.solids.scale_mass(self.settings.target_step).percent
        check_damping(self.settings.damping, self.solids.dt)
        self.heat = self._make_heat(threads or available_threads()) if model.heat else None
        self.points = RowHistory(model.materials, [b.material for b in model.mesh.blocks], is_solid=True)
        self.points.start(self._find_points())
        velocities = (self.settings.velocity, *self.settings.velocity_of_others)
        self.loose = None if np.any(np.ravel(velocities)) else LooseRows(model)
        self._begin_stage()

    def make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        model, density = self.model, float(np.ravel(epoch.get("density", 1.0))[0])
        touching = find_touching(model)
        self.solids = ExplicitSolids(
            model.mesh,
            [replace(material, density=density * material.density) for material in self._materials],
            axisymmetric=model.analysis == "axisymmetric",
            depth=model.depth,
            hourglass_fraction=self.settings.hourglass_stiffness,
            world=self._world,
            touching=touching,
        )
        self.walls = [
            self.solids.add_wall(t.name, start_profile(t), mu=find_coefficient(t.friction), is_at_start=not epoch)
            for t in model.tools
        ]
        self.contacts = ContactsOfRows(model, touching, self.solids)
        self._reaction = np.zeros((len(model.mesh.points), 2))
        self._find_neighbourhoods()

    def _find_neighbourhoods(self) -> None:
        """Find the neighbourhoods over which pores are averaged."""
        if any(material.gtn for material in self.model.materials):
            from presswork.evolution.porosity import NonlocalPorosity  # loads scipy, which dense metals do without

            self._pores = NonlocalPorosity(self.model, self.mesh.points)

    def _make_heat(self, threads: int) -> HeatOfRows:
        return HeatOfRows(self.model, self.solids, self.walls, self.contacts, threads)

    # --- the way through ---------------------------------------------------------------------------------------------

    def _compute_row(self, number: int, row: int) -> tuple[int, float, EnergyBalance]:
        stage, rows = self.model.stages[number], self.model.output.rows
        begin = self._begin_of(number)
        cycle, time = self.solids.cycle, self.solids.time
        impulse = [wall.impulse for wall in self.walls]
        if self.points.is_needed:
            self.points.begin_row(self._find_points())
        self.solids.reset_reaction()
        self.contacts.begin_row()
        if self.heat is not None:
            self.heat.begin_row()
        to = begin + stage.duration * (row + 1) / rows
        if stage.drive is not None and isinstance(stage.drive.motion, Blow):
            self._strike(number, stage.drive, to)
        else:
            self._run_to(to, find_motion(stage, begin))
        for i, wall in enumerate(self.walls):
            self._force[i] = (wall.impulse - impulse[i]) / (self.solids.time - time)
        self._reaction = self.solids.reaction_impulse / (self.solids.time - time)
        self.contacts.end_row(self.solids.time - time)
        if self._pores is not None:
            self.solids.average_pores(self._pores, self._measure_volumes())
        if self.heat is not None:
            self.heat.advance()
        if self.points.is_needed:
            hardens = self.points.end_row(self._find_points(), self.solids.time - time)
            if self.points.softens:
                self.solids.recover(np.concatenate(hardens)[:, 0])
        if self.loose is not None:
            walls = zip(self.walls, self.model.tools, strict=True)
            held = [find_held_by_wall(wall.nodal_force, find_coefficient(tool.friction)) for wall, tool in walls]
            self.loose.end_row(self.model, number, self.solids, self.solids.mass, held, self.contacts)
        energies = self.solids.energies()
        self._progress.added_mass = self.solids.added_mass().percent
        cycles = self.solids.cycle - cycle
        return cycles, stage.duration / rows / cycles, energies

    def _begin_of(self, number: int) -> float:
        """Return when a stage begins [s]."""
        return float(sum(stage.duration for stage in self.model.stages[:number]))

    def _run_to(self, to: float, motion: Motion | None) -> None:
        settings = self.settings
        if self.contacts.limits_shear:
            self.contacts.set_limits(np.maximum(self._flow_stress(), effective_stress(self.solids.stress)))
        self.solids.run_to(to, damping=settings.damping, target_step=settings.target_step, motion=motion)

    def _strike(self, number: int, drive: Drive, to: float) -> None:
        """Run to a time [s] with a ram whose speed follows in steps from the energy that is left."""
        for end in np.linspace(self.solids.time, to, STEPS_OF_A_ROW + 1)[1:]:
            dt, impulse = end - self.solids.time, [wall.impulse for wall in self.walls]
            left = max(drive.travel - self._progress.stage_way, 0.0)
            speed = min(self._find_ram_speed(drive, 0.0), left / dt)
            self._run_to(float(end), EvenMotion(speed * drive.duration / drive.travel))  # walls have the mean velocity
            forces = np.array([(wall.impulse - i) / dt for wall, i in zip(self.walls, impulse, strict=True)])
            self._add_ram_work(number, forces.reshape(-1, self.model.dimension), speed * dt)

    def _tool_forces(self) -> FloatArray:
        return self._force

    def _begin_stage(self) -> None:
        """Prescribe what supports and the present stage prescribe: the mean velocity of each motion over the stage."""
        number = self._progress.stage
        if self.heat is not None and self._progress.row == 0:
            self.heat.begin_stage()
        if number == len(self.model.stages):
            self._prescribe(self.solids)
            return
        stage = self.model.stages[number]
        self._prescribe(self.solids, stage.duration)
        for wall in self.walls:
            self._move(wall, stage.tool_motion.get(wall.name, ToolMotion()), stage)

    def _move(self, wall: Any, motion: ToolMotion, stage: Stage) -> None:
        """Let a tool move as a stage has it."""
        wall.velocity = tuple(way / stage.duration for way in motion.move[: self.model.dimension])

    def _keep_run(self) -> Callable[[], Mapping[str, NDArray[Any]]] | None:
        return self.solids.keep()  # type: ignore[no-any-return]

    def _state_arrays(self) -> NamedArrays:
        return {**self._arrays_beside_run(), **self.solids.dump()}

    def _arrays_beside_run(self) -> NamedArrays:
        heat = self.heat.arrays.to_arrays() if self.heat else {}
        loose = self.loose.to_arrays() if self.loose else {}
        return {**self._progress.to_arrays(), **self.points.to_arrays(), **heat, **loose}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        self._take_up(arrays)
        self.points.load_arrays(arrays)
        if self.loose is not None:
            self.loose.load_arrays(arrays)
        self.solids.restore(arrays)
        if self.heat is not None:
            self.heat.restore(arrays)
        self._begin_stage()
