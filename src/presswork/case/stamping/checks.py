# SPDX-License-Identifier: Apache-2.0
"""Checks of a stamping before anything is computed: names, and whether blank, tools and motions fit together."""

from __future__ import annotations

import itertools
import logging

import numpy as np

from presswork.case.errors import Problem
from presswork.case.material.law_needs import check_grain, check_needs
from presswork.case.material.library import find_material_problem
from presswork.case.material.umat import UmatMaterial
from presswork.case.stamping.blank import BlankFile, CircularBlank, OutlinedBlank, RectangularBlank, TubeBlank
from presswork.case.stamping.closing import IRONED
from presswork.case.stamping.plan_line import TrimFile
from presswork.case.stamping.schema import StampingCase
from presswork.case.stamping.shapes import clearance
from presswork.case.stamping.stage_checks import check_stages
from presswork.case.stamping.tools import DrawnTool, SectionTool, ToolFile
from presswork.case.stamping.tools import Tool as CaseTool
from presswork.case.tools.friction import list_friction_problems
from presswork.case.units import LENGTH, unit_factor
from presswork.geometry.tool_surface import make_surface
from presswork.law.elastic_plastic import first_flow_stress
from presswork.model import FloatArray, Mesh, Stage, Tool, Triangulation

logger = logging.getLogger(__name__)

MOST_CELLS = 5_000_000
KINDS = ("punch", "die", "holder")
THINNEST = 0.002
"""[mm] Foil of aluminium is rolled down to 0.004 mm."""
CLEAR = 0.01
"""Part of the thickness by which a tool may start in the blank."""
FASTEST = 0.1
"""Part of the wave speed at which tools may move."""
WORKED = 0.2
"""Plastic strain of a formed sheet, by which the work that forms it is judged."""
SWIFT, INERT = 0.05, 0.5
"""Energy of a sheet that moves with the tools over that work, from which on inertia shows, and rules."""


def check_names(case: StampingCase) -> list[Problem]:
    """Return the problems of names, units and stages that show without geometry."""
    problems = []
    if unknown := find_material_problem("blank", case.blank.material, case.materials):
        problems.append(unknown)
    for name, material in case.materials.items():
        if isinstance(material, UmatMaterial):
            problems += _check_umat(f"materials.{name}", material, case)
        elif material.grain is not None:
            knows = case.heat is not None or material.heating is not None
            problems += check_grain(f"materials.{name}", material.grain, knows_temperature=knows, stages=case.stages)
    if case.blank.mean_thickness < THINNEST:
        fault, remedy = "thinner than any rolled metal", 'plain numbers are mm: 0.8, or "0.8 mm"'
        problems.append(Problem("blank.thickness", fault, remedy, case.blank.mean_thickness))
    if isinstance(case.blank, RectangularBlank | CircularBlank | TubeBlank):
        problems += _check_element_size(case.blank)
    units = {f"tools.{name}.unit": tool.unit for name, tool in case.tools.items() if isinstance(tool, ToolFile)}
    if isinstance(case.blank, BlankFile | OutlinedBlank) and case.blank.unit is not None:
        units["blank.unit"] = case.blank.unit
    units |= {f"trim.{n}.unit": t.unit for n, t in case.trim.items() if isinstance(t, TrimFile) and t.unit is not None}
    for key, unit in units.items():
        try:
            unit_factor(unit, LENGTH)
        except ValueError as error:
            problems.append(Problem(key, f"expected a unit of length, but {error}", "e.g. mm, m, inch", unit))
    problems += list_friction_problems(case.tools, heated=case.heat is not None)
    if case.procedure == "explicit":
        fault, remedy = (
            "friction that depends on the state is for implicit runs",
            'remove it, or set procedure = "implicit"',
        )
        rough = [name for name, tool in case.tools.items() if tool.friction is not None]
        problems += [Problem(f"tools.{name}.friction", fault, remedy) for name in rough]
    if case.blank.refine is not None and case.procedure == "implicit":
        fault, remedy = "only the explicit procedure splits shells", "leave it out, or give a smaller element_size"
        problems.append(Problem("blank.refine", fault, remedy))
    elif case.blank.refine is not None and case.explicit.element != "shell4_1pt":
        fault, remedy = "these shells cannot be split", 'take "shell4_1pt", or leave blank.refine out'
        problems.append(Problem("explicit.element", fault, remedy, case.explicit.element))
    problems += _check_self_contact(case)
    problems += _check_device(case)
    problems += _check_step_bound(case)
    problems += check_stages(case)
    used = [case.blank.material, *(zone.material for zone in case.blank.zones if zone.material in case.materials)]
    return [*problems, *check_needs(case.materials, used, case.stages, heated=case.heat is not None)]


def _check_self_contact(case: StampingCase) -> list[Problem]:
    """Return the problems of a sheet that is to touch itself."""
    if case.self_contact is None:
        return []
    if case.gradients is not None:
        fault = "runs with contact of the sheet with itself have no derivatives"
        return [Problem("gradients", fault, "leave gradients out, or self_contact")]
    if case.blank.refine is not None:
        fault = "shells that touch each other cannot be split"
        return [Problem("self_contact", fault, "leave blank.refine out, and give a smaller element_size")]
    return []


def _check_element_size(blank: RectangularBlank | CircularBlank | TubeBlank) -> list[Problem]:
    """Return the problems of too many elements, and of too large ones."""
    problems, most, largest = [], max(blank.half_size()), float(np.max(blank.element_size))
    n_cells = 4 * float(np.prod(np.divide(blank.half_size(), blank.element_size))) / 2 ** len(set(blank.symmetry))
    if n_cells > MOST_CELLS:
        problems.append(explain_too_many(n_cells, float(np.min(blank.element_size))))
    if largest > most:
        fault = f"larger than half of the blank, {most:g} mm"
        problems.append(Problem("blank.element_size", fault, "make it smaller", largest))
    return problems


def explain_too_many(n_cells: float, element_size: float) -> Problem:
    """Return the problem of a blank of too many elements."""
    fault = f"about {n_cells:.2g} elements, more than memory will hold"
    return Problem("blank.element_size", fault, "make it larger", element_size)


def check_tools(case: StampingCase) -> list[Problem]:
    """Return the problems of tools beside each other and beside the blank."""
    problems = []
    thickness = case.blank.thickest
    for name, tool in case.tools.items():
        key = f"tools.{name}"
        for axis, plane in enumerate("xy"):
            off = tool.position[axis] if tool.position is not None else 0.0
            if plane in case.blank.symmetry and off != 0.0 and not _stands_free(tool):
                fault = f"the tool's middle does not lie in the symmetry plane {plane} = 0"
                remedy = f"set its {plane} to 0, or leave {plane} out of blank.symmetry"
                problems.append(Problem(f"{key}.position", fault, remedy, list(tool.position or ())))
        problems += _check_direction(case, key, tool)
        if name in KINDS and tool.kind != name:
            fault, remedy = f"the tool is called {name}, but is a {tool.kind}", "mend its kind, or give it another name"
            problems.append(Problem(f"{key}.kind", fault, remedy, tool.kind))
        if tool.gap is not None and tool.gap < thickness:
            fault = f"the gap is smaller than the blank's thickness of {thickness:g} mm"
            problems.append(Problem(f"{key}.gap", fault, "make it at least that, or push the holder", tool.gap))
        if tool.gap is not None and not any(other.kind == "die" for other in case.tools.values()):
            problems.append(Problem(f"{key}.gap", "there is no die to keep a gap to", "add one", tool.gap))
        first = case.stages[0].tools.get(name)
        if tool.gap is not None and first is not None and first.force is not None:
            fault = "the holder is to stand at this distance from the die, and to be pushed by a force from the start"
            problems.append(Problem(f"{key}.gap", fault, "give the gap or the force", tool.gap))
    drawn = {name: tool for name, tool in case.tools.items() if isinstance(tool, DrawnTool)}
    for punch_name, punch in drawn.items():
        for die_name, die in drawn.items():
            if punch.kind != "punch" or die.kind == "punch":
                continue
            gap = clearance(punch, die)
            least = (IRONED if case.irons else 1.0) * thickness if die.kind == "die" else 0.0
            if gap < least * (1 - 1e-9) or gap < 0:
                problems.append(_explain_clearance(case, punch_name, die_name, die.kind, gap))
    moved = {name for stage in case.stages for name, action in stage.tools.items() if action.force is None}
    for index, stage in enumerate(case.stages):
        for name, action in stage.tools.items():
            if action.force is not None and name in moved and case.procedure == "implicit":
                fault = "the implicit procedure cannot move a tool in one stage and push it in another"
                remedy = 'give it strokes or forces alone, or take procedure = "explicit"'
                problems.append(Problem(f"stages.{index}.tools.{name}.force", fault, remedy))
            opposite = "die" if case.tools[name].kind != "die" else "holder"
            if action.force is not None and not any(t.kind == opposite for t in case.tools.values()):
                fault = f"the {case.tools[name].kind} is pushed, but no {opposite} lies on the other side of the blank"
                problems.append(Problem(f"stages.{index}.tools.{name}.force", fault, f"add a {opposite}"))
    return problems


def _stands_free(tool: CaseTool) -> bool:
    """Return whether a tool stands where it is drawn alone, with no image on the other side of the middle."""
    return isinstance(tool, ToolFile) or (isinstance(tool, SectionTool) and tool.stands_free)


def _check_direction(case: StampingCase, key: str, tool: CaseTool) -> list[Problem]:
    """Return the problem of a drawn tool that goes aslant, and its mirror image, which is the same tool, with it."""
    if tool.direction is None or _stands_free(tool):
        return []
    aside = [plane for plane, part in zip("xy", tool.direction, strict=False) if part != 0.0]
    is_straight = getattr(tool, "plan", tool.shape) == "strip"
    if not aside or (aside == ["x"] and is_straight and "x" in case.blank.symmetry):
        return []
    if is_straight and aside == ["x"]:
        fault, remedy = (
            "the tool stands on both sides of x = 0, and one of them would go the wrong way",
            ('compute half of the part (blank.symmetry = ["x"]), or give a tool from a file (shape = "file")'),
        )
    else:
        fault, remedy = (
            f"a tool round the middle cannot go along {' and '.join(aside)}",
            ('give a tool from a file (shape = "file"), or a direction along z'),
        )
    return [Problem(f"{key}.direction", fault, remedy, list(tool.direction))]


def _explain_clearance(case: StampingCase, punch: str, die: str, kind: str, gap: float) -> Problem:
    thickness = case.blank.thickest
    if gap < 0:
        text = f"the clearance is negative: {punch} is {-gap:.4g} mm larger than the opening of {die}"
        swapped = "; or are their kinds swapped?"
    else:
        swapped = ""
        text = f"the clearance of {gap:.4g} mm between {punch} and {die} is less than the blank's {thickness:g} mm"
        if case.irons:
            text = text.replace("less than", f"less than {IRONED:g} of")
        elif case.procedure == "implicit":
            swapped = ', or take procedure = "explicit", which irons sheets'
    return Problem(f"tools.{punch}", text, f"make the punch smaller or the opening of the {kind} larger{swapped}")


def check_travel(case: StampingCase) -> list[Problem]:
    """Return a problem for each tool laid on the blank whose strokes only take it away from there."""
    problems = []
    for name, tool in case.tools.items():
        if tool.position is not None:
            continue
        strokes = [stage.tools[name].travel if name in stage.tools else 0.0 for stage in case.stages]
        first = next((index for index, stroke in enumerate(strokes) if stroke), None)
        if first is None or max(itertools.accumulate(strokes)) > 0:
            continue
        if tool.kind != "punch" and first > 0:  # it has held the blank while others worked, and lets it go
            continue
        away, toward = ("down", "up") if tool.kind == "die" else ("up", "down")
        fault = f"the {tool.kind} only moves {away}, away from the blank"
        remedy = f"strokes of a {tool.kind} count {toward}: write stroke = {-strokes[first]:g}"
        problems.append(Problem(f"stages.{first}.tools.{name}.stroke", fault, remedy, strokes[first]))
    return problems


def _check_device(case: StampingCase) -> list[Problem]:
    """Return the problem of a card that the implicit procedure would leave idle; other keys of [explicit] may stay."""
    device = case.explicit.device
    if case.procedure == "explicit" or device == "cpu":
        return []
    remedy = 'remove it, or set procedure = "explicit"'
    return [Problem("explicit.device", "computes cycles of the explicit procedure alone", remedy, device)]


def _check_step_bound(case: StampingCase) -> list[Problem]:
    """Return the problem of a mesh's step where another one is asked for, or where it is not found."""
    explicit = case.explicit
    if explicit.step_bound == "shells" or case.procedure != "explicit":
        return []
    if explicit.target_step is not None:
        fault = "target_step adds mass by the shells' own steps"
        return [Problem("explicit.step_bound", fault, "give one of the two", explicit.step_bound)]
    if explicit.device != "cpu":
        fault = f'the step of the mesh is found on the CPU, and device = "{explicit.device}"'
        return [Problem("explicit.step_bound", fault, 'take "shells"', explicit.step_bound)]
    return []


def _check_umat(key: str, material: UmatMaterial, case: StampingCase) -> list[Problem]:
    """Return the problems of data that a stamping needs from a law in a shared library."""
    problems = []
    if material.density is None:
        problems.append(Problem(f"{key}.density", "missing key", 'add it: steel has "7850 kg/m^3"'))
    if material.yield_stress is None:
        remedy = "add it: the routine does not give it, and holder forces and energies are judged by it"
        problems.append(Problem(f"{key}.yield_stress", "missing key", remedy))
    if case.procedure == "explicit" and case.explicit.precision == "single":
        fault = "a UMAT computes in double precision"
        problems.append(Problem("explicit.precision", fault, 'take "double"', "single"))
    return problems


def check_target_step(case: StampingCase, stages: tuple[Stage, ...]) -> list[Problem]:
    """Return a problem where the time step asked for is longer than the smooth start of a stage."""
    target = case.explicit.target_step
    if target is None or not stages:
        return []
    shortest = min(stages, key=lambda stage: stage.ramp)
    if target <= shortest.ramp:
        return []
    fault = f'longer than the smooth start of the stage "{shortest.name}", {shortest.ramp:.3g} s'
    return [Problem("explicit.target_step", fault, "take a few times the step without it, about 1 us", target)]


def check_speeds(case: StampingCase, stages: tuple[Stage, ...]) -> list[Problem]:
    """Return the problems of explicit stages in which something moves too fast for the sheet to follow."""
    if case.procedure != "explicit":
        return []
    material = case.materials[case.blank.material]
    if isinstance(material, UmatMaterial):
        return []  # its elasticity is known once the library is open
    density = material.find_density()
    sound, strength = (
        float(np.sqrt(material.young / density)),
        first_flow_stress(material.to_model(case.blank.material)),
    )
    problems = []
    for index, (stage_case, stage) in enumerate(zip(case.stages, stages, strict=True)):
        if any(action.close is not None and action.stroke is None for action in stage_case.tools.values()):
            continue  # how far it goes shows once the tools are placed
        distances = [max(abs(part) for part in motion.move) for motion in stage.tool_motion.values()]
        farthest = max([*distances, *(abs(each.value) for each in stage.prescribed)], default=0.0)
        speed = farthest / (stage.duration - stage.ramp)
        share = 0.5 * density * speed**2 / (strength * WORKED)
        if speed <= FASTEST * sound and share <= INERT:
            if share > SWIFT:
                text = "stages.%d: %.4g mm at %.3g mm/s: the sheet's energy of motion would be %.2g of the work that "
                text += "forms it, so inertia forms it, not the tools; 2 m/s is usual"
                logger.warning(text, index, farthest, speed, share)
            continue
        key = "duration" if stage_case.duration is not None else "velocity"
        fault = f"{farthest:.4g} mm at {speed:.3g} mm/s: waves in the sheet, of {sound:.2g} mm/s, cannot spread it"
        if speed <= FASTEST * sound:
            fault = (
                f"{farthest:.4g} mm at {speed:.3g} mm/s: the sheet's energy of motion would be {share:.2g} of the work "
                "that forms it: it would be thrown, not formed"
            )
        remedy = 'plain numbers are mm/s and s; "2 m/s" is usual, and slow enough for inertia to be small'
        problems.append(Problem(f"stages.{index}.{key}", fault, remedy, getattr(stage_case, key)))
    return problems


def check_fit(case: StampingCase, mesh: Mesh, tools: tuple[Tool, ...]) -> list[Problem]:
    """Return the problems of the meshed blank and the placed tools."""
    problems = []
    corner = mesh.points[:, :2]
    placed = {tool.name: tool for tool in tools}
    for name, tool in case.tools.items():
        if isinstance(tool, ToolFile):
            problems += _check_extent(tool, placed[name], corner)
            continue
        width = getattr(tool, "face_width", None)
        if width is None:
            continue
        assert isinstance(tool, DrawnTool)
        half = np.array(tool.half_size()) + width
        beyond = np.abs(corner) - half
        if isinstance(case.blank, CircularBlank | OutlinedBlank) and tool.shape == "round":
            beyond = np.linalg.norm(corner, axis=1, keepdims=True) - half[:1]
        if beyond.max() > 1e-9:
            text = f"the blank is larger than the {tool.kind}: it reaches {beyond.max():.4g} mm beyond its face"
            problems.append(
                Problem(f"tools.{name}.face_width", text, "make the face wider or the blank smaller", width)
            )
    return problems + [problem for tool in tools if (problem := _check_clear(case, mesh, tool)) is not None]


def _check_extent(tool: ToolFile, placed: Tool, corner: FloatArray) -> list[Problem]:
    """Return a problem where the blank reaches beyond a die or holder from a file, seen from above."""
    assert isinstance(placed.shape, Triangulation)
    if tool.kind == "punch":
        return []
    points = placed.shape.points[:, :2] + np.array(placed.position[:2])
    beyond = float(np.maximum(points.min(axis=0) - corner, corner - points.max(axis=0)).max())
    if beyond <= 1e-6 * float(np.ptp(points, axis=0).max()):
        return []
    text = f"the blank is larger than the {tool.kind}: it reaches {beyond:.4g} mm beyond it"
    return [Problem(f"tools.{placed.name}.path", text, "make the blank smaller, or check unit and position", tool.path)]


def _check_clear(case: StampingCase, mesh: Mesh, tool: Tool) -> Problem | None:
    """Return a problem where the tool starts in the blank."""
    half = 0.5 * case.blank.thickest
    gap = make_surface(tool.surface).nearest(mesh.points - np.asarray(tool.position))[0] - half
    worst = int(np.argmin(gap))
    if gap[worst] >= -CLEAR * case.blank.thickest:
        return None
    x, y, z = mesh.points[worst]
    text = (
        f"the tool starts in the blank: {int((gap < 0).sum())} nodes lie in it, half the thickness counted, the "
        f"deepest {-gap[worst]:.4g} mm at ({x:.4g}, {y:.4g}, {z:.4g})"
    )
    position = case.tools[tool.name].position
    key = f"tools.{tool.name}.position" if position is not None else f"tools.{tool.name}"
    return Problem(key, text, "move it off, or leave position out: then it just touches the blank", _written(position))


def _written(position: tuple[float, float, float] | None) -> list[float] | None:
    """Return a position as a case file has it."""
    return None if position is None else list(position)
