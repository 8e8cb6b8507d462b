# SPDX-License-Identifier: Apache-2.0
"""Whether a die holds: its stress at chosen instants of a run, the prestress of its rings, and safety."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from presswork.dies.hand_over import ToolLoad, find_tool_load, hand_over
from presswork.dies.meshes import mesh_body
from presswork.dies.profile_nodes import clip_at_axis
from presswork.dies.structure import Answer, DieStructure
from presswork.mesh import MeshError
from presswork.model import DieBody, DieSteel, FloatArray
from presswork.results import Result, ResultError

OFF = 0.5
"""Distance of a loaded place from the profile of the body's mesh, over the size of cells, up to which it belongs."""
LIFTS = 0.05
"""Part of a joint that may open without a warning."""
MISSED = 0.05
"""Part by which a force of the history may exceed the largest at a saved step without a warning."""


@dataclass(frozen=True)
class Peak:
    """The largest value in a part of a die, and where it is."""

    value: float
    place: FloatArray
    """(2,) [mm] where the tool starts."""


@dataclass(frozen=True)
class PartStress:
    """Stress in one part of a die at one instant."""

    name: str
    """core, ring 1, ring 2, ..."""
    steel: DieSteel
    von_mises: Peak
    """[MPa]"""
    tension: Peak
    """Largest principal stress [MPa]."""

    @property
    def safety_yield(self) -> float | None:
        """Return yield stress over von Mises's stress; None where it is not known."""
        limit = self.steel.yield_stress
        return None if limit is None else limit / max(self.von_mises.value, 1e-300)

    @property
    def safety_tension(self) -> float | None:
        """Return the tensile strength over the largest principal stress; infinite where nothing is drawn."""
        limit = self.steel.tensile_strength
        if limit is None:
            return None
        return limit / self.tension.value if self.tension.value > 0.0 else float("inf")


@dataclass(frozen=True)
class DieInstant:
    """A die at one saved step."""

    step: int
    time: float
    """[s]"""
    part: float
    """Part of the run's time that has passed."""
    load: ToolLoad
    answer: Answer

    @property
    def force(self) -> FloatArray:
        """Return the force on the tool (2,) [N]; of a ring its radial part is summed round."""
        return np.asarray(self.load.force.sum(axis=0))


@dataclass(frozen=True)
class DieStudy:
    """A die over a run."""

    tool: str
    title: str
    structure: DieStructure
    joined: Answer
    """With the interference of its rings alone."""
    instants: tuple[DieInstant, ...]
    warnings: tuple[str, ...]

    @cached_property
    def worst(self) -> DieInstant:
        """Return the instant of the largest von Mises stress."""
        return max(self.instants, key=lambda instant: von_mises(instant.answer.stress).max())

    def judge(self, answer: Answer) -> list[PartStress]:
        """Return the stress of each part."""
        equivalent, tension = von_mises(answer.stress), largest_principal(answer.stress)
        found = []
        for number, part in enumerate(self.structure.body.parts):
            own = self.structure.part_of(number)
            peaks = []
            for values in (equivalent[own], tension[own]):
                at = int(np.argmax(values))
                peaks.append(Peak(float(values[at]), self.structure.points[own][at]))
            found.append(PartStress(name_part(number), part.steel, *peaks))
        return found

    def find_joint(self, answer: Answer, ring: int) -> tuple[float, float]:
        """Return the mean pressure between a ring, 1, 2, ..., and the part inside [MPa], and the open part of it."""
        structure = self.structure
        own = np.isin(structure.pairs[:, 1], np.arange(*structure.part_of(ring).indices(len(structure.points))))
        x, y = structure.points[structure.pairs[own, 0]].T
        push = answer.push[own]
        return float(push.sum() / (2.0 * np.pi * x[0] * np.ptp(y))), float((push == 0.0).mean())

    def find_deflection(self, instant: DieInstant) -> Peak:
        """Return how far the load moves the profile [mm], at most, from where the joined die has it."""
        profile = self.structure.profile
        moved = np.linalg.norm((instant.answer.displacement - self.joined.displacement)[profile], axis=1)
        at = int(np.argmax(moved))
        return Peak(float(moved[at]), self.structure.points[profile[at]])


def name_part(number: int) -> str:
    """Return the name of a part by its place from the profile outwards.

    >>> name_part(0), name_part(1)
    ('core', 'ring 1')
    """
    return f"ring {number}" if number else "core"


def von_mises(stress: FloatArray) -> FloatArray:
    """Return von Mises's stress (n,) of stresses xx, yy, zz, xy (n, 4) [MPa]."""
    x, y, z, shear = stress.T
    return np.asarray(np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3.0 * shear**2))


def largest_principal(stress: FloatArray) -> FloatArray:
    """Return the largest principal stress (n,) of stresses xx, yy, zz, xy (n, 4) [MPa]."""
    x, y, z, shear = stress.T
    return np.asarray(np.maximum(0.5 * (x + y) + np.hypot(0.5 * (x - y), shear), z))


def study_die(result: Result, tool: str, body: DieBody, *, at: Sequence[float] = ()) -> DieStudy:
    """Find the stress of a tool's body at saved steps of a run in the plane.

    at: parts of the run's time, 0 to 1, for each of which the nearest saved step is taken; without any: all steps.
    Raises ResultError for an unknown tool, a tool that touches nothing, an outline that does not match its profile, and
    a body that nothing holds.
    """
    if tool not in result.tools:
        there_are = ", ".join(result.tools) or "none"
        raise ResultError(f"{result.folder} has no tool {tool!r} in the plane; it has: {there_are}")
    loads = [find_tool_load(result, tool, step) for step in range(len(result.times))]
    pushed = np.array([np.linalg.norm(load.force.sum(axis=0)) for load in loads])
    if not pushed.any():
        remedy = "name a tool that presses, or save more steps (output.steps)"
        raise ResultError(f"{tool} touches nothing at the {len(loads)} saved steps of {result.folder}: {remedy}")
    analysis, depth = result.info["analysis"], float(result.info["depth"])
    try:
        profile = result.tools[tool]
        meshes = mesh_body(clip_at_axis(profile) if analysis == "axisymmetric" else profile, body)
    except MeshError as error:
        raise ResultError(f"tools.{tool}.body: {error.fault}; {error.remedy}") from error
    structure = DieStructure(meshes, body, analysis, depth)
    joined = structure.answer(np.zeros(structure.points.shape))
    end = float(result.times[-1])
    instants = []
    for step in _choose_steps(result, at):
        forces, away = hand_over(loads[step], structure.points, structure.profile, is_ring=analysis == "axisymmetric")
        if away > OFF * body.size:
            remedy = "the outline must hold the whole profile that works"
            raise ResultError(f"{tool} is touched {away:.4g} mm off the profile of its body: {remedy}")
        time = float(result.times[step])
        instants.append(DieInstant(step, time, time / end if end else 1.0, loads[step], structure.answer(forces)))
    study = DieStudy(tool, str(result.info["title"]), structure, joined, tuple(instants), ())
    warnings = [
        *_check_interference(study),
        *_check_joints(study),
        *([] if at else _check_force(result, tool, pushed)),
    ]
    return DieStudy(study.tool, study.title, structure, joined, study.instants, tuple(warnings))


def _choose_steps(result: Result, at: Sequence[float]) -> list[int]:
    """Return the saved steps that are looked at."""
    for part in at:
        if not 0.0 <= part <= 1.0:
            raise ResultError(f"--at {part:g}: give a part of the run from 0 to 1")
    if not at:
        return list(range(len(result.times)))
    return sorted({int(np.argmin(np.abs(result.times - part * result.times[-1]))) for part in at})


def _check_interference(study: DieStudy) -> list[str]:
    """Return the warnings of parts that yield when they are joined, before any load."""
    found = []
    interference = [part.interference for part in study.structure.body.parts]
    for part in study.judge(study.joined):
        safety = part.safety_yield
        if safety is not None and safety < 1.0:
            one = sum(each > 0.0 for each in interference) == 1
            remedy = f"at most {safety * max(interference):.4g} mm of interference" if one else "less interference"
            stress, limit = part.von_mises.value, part.steel.yield_stress
            found.append(
                f"{study.tool}, {part.name}: the interference alone gives {stress:.4g} MPa, beyond its yield stress of "
                f"{limit:.4g} MPa, so the fit is looser than computed; {remedy}"
            )
    return found


def _check_joints(study: DieStudy) -> list[str]:
    """Return the warnings of rings that lift off the part inside under load."""
    found = []
    for ring in range(1, len(study.structure.body.parts)):
        opened = max(study.find_joint(now.answer, ring)[1] for now in study.instants)
        if opened > LIFTS:
            text = f"lifts off {100 * opened:.0f} % of the part inside under load; give it more interference"
            found.append(f"{study.tool}: {name_part(ring)} {text}")
    return found


def _check_force(result: Result, tool: str, pushed: FloatArray) -> list[str]:
    """Return the warning of a force between saved steps that is larger than at all of them."""
    history = result.history
    names = [f"{tool}.force_{axis}" for axis in "xy"]
    if any(name not in history for name in names):
        return []
    largest = float(np.nanmax(np.hypot(*(history[name].astype(float) for name in names))))
    if largest <= (1.0 + MISSED) * pushed.max():
        return []
    more = 100.0 * (largest / pushed.max() - 1.0)
    return [f"{tool}: the force between saved steps is {more:.0f} % larger than at them; save more (output.steps)"]
