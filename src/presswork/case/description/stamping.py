# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about a stamping."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping

import numpy as np

from presswork.case.description.drawing_ratio import describe_drawing_ratio
from presswork.case.description.heat import describe_heat_of_forming
from presswork.case.description.loads import describe_courses, describe_loads_of_sheet
from presswork.case.description.material import describe_forming_limit, describe_material
from presswork.case.description.press import describe_drive
from presswork.case.description.supports import name_stages
from presswork.case.description.zones import describe_zones
from presswork.case.stamping.closing import CLOSED, find_closing_stroke
from presswork.geometry.tool_radius import find_least_radius
from presswork.mesh.make.flange import find_held_area
from presswork.model import (
    Closing,
    Dwell,
    ExplicitSheet,
    FloatArray,
    Model,
    Operation,
    PartPlace,
    Springback,
    Stage,
    SweptProfile,
    Tool,
    Triangulation,
)

EDGE = 5.0
"""Elements along an edge of a tool from which on its radius counts."""
SHARPEST = 0.1
"""Radius over the length of an element below which an edge counts as sharp."""
TOUCHING = 0.01
"""Part of the thickness by which tools that have closed may be off the sheet."""
ROOM = 1.05
"""Thicknesses from which on a holder that stands leaves a sheet room to thicken."""
ELEMENTS_ROUND_AN_EDGE = 3
"""Fewest elements in a quarter turn that bend a sheet round it without large errors."""
MANY_CYCLES = 5e6
"""A hundred times those of a usual draw."""
_SOUGHT = "held by a force that a run first finds from its geometry, by pulling a strip through it"
NARROW = 0.5
"""Width of a cell over its shortest side below which the cell is nearly flat, as one with a corner of 180 degrees."""
WAVE = 0.85
"""Stable step over shortest side/wave speed, about."""


def describe_stamping(problem: Model) -> Iterator[str]:
    """Describe blank, materials, tools, stages and the time that computing takes, a line per fact."""
    mesh = problem.mesh
    section, material = problem.sheet
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    planes = [f"{axis} = 0" for axis, is_cut in zip("xy", problem.symmetry, strict=True) if is_cut]
    part = f"cut by the symmetry planes {' and '.join(planes)}; forces are those of the whole" if planes else "whole"
    explicit = problem.explicit
    yield f"analysis: stamping, {'implicit' if explicit is None else 'explicit'} procedure"
    yield f"blank: x {low[0]:g} to {high[0]:g} mm, y {low[1]:g} to {high[1]:g} mm, {part}"
    yield f"sheet: {section.thickness:g} mm of {material.name}, {section.points} {section.rule.capitalize()} points"
    yield from describe_zones(problem)
    angle = np.degrees(np.arctan2(problem.rolling_direction[1], problem.rolling_direction[0]))
    yield f"rolling direction: {angle:g} degrees from x"
    shortest = float(_measure_sides(problem).min())
    cells = ", ".join(f"{len(b.connectivity)} {b.element}" for b in mesh.blocks)
    yield f"mesh: {cells}, {len(mesh.points)} nodes, shortest side {shortest:.3g} mm"
    finest = _finest(problem)
    if refinement := problem.refinement:
        degrees = np.degrees(refinement.angle)
        yield f"refined as it is formed: at more than {degrees:g} degrees, down to a side of {shortest * finest:.3g} mm"
    yield f"node sets: {', '.join(f'{name} ({len(nodes)})' for name, nodes in sorted(mesh.node_sets.items()))}"
    yield from _describe_materials(problem)
    yield from describe_loads_of_sheet(problem)
    if problem.heat is not None:
        yield from describe_heat_of_forming(problem, problem.heat)
        yield f"heat of the sheet: {problem.heat.levels} temperatures through the thickness of every node"
    yield f"ironing: {_describe_ironing(problem)}"
    numbers = range(len(problem.operations))
    for number in numbers:
        if problem.following:
            yield f'operation {number + 1} "{problem.operations[number]}"'
        own = problem.of_operation(number)
        yield from _describe_operation(own, problem.following[number - 1] if number else None)
    if explicit is None:
        settings = problem.solver
        yield (
            f"increments: {settings.min_increment:g} to {settings.max_increment:g} of a stage, cut back and grown by "
            f"the iterations they take; {6 * len(mesh.points)} freedoms"
        )
        return
    narrowest, (x, y) = _find_narrowest(problem)
    if narrowest < NARROW * shortest:
        yield (
            f"hint: the narrowest element, at ({x:.4g}, {y:.4g}) mm, is {narrowest:.2g} mm across where its sides are "
            f"longer than {shortest:.2g} mm: it sets the time step; move its nodes, or leave it out"
        )
        shortest = narrowest
    speed = np.sqrt(material.young / material.density / (1 - material.poisson**2))
    assert isinstance(explicit, ExplicitSheet)
    step = explicit.target_step or explicit.safety * WAVE * shortest * finest / speed
    stages = [stage for number in numbers for stage in problem.of_operation(number).stages]
    cycles = sum(stage.duration for stage in stages if stage.dwell is None) / step
    how = "by mass scaling" if explicit.target_step else "without mass scaling"
    split = f", with up to {1 / finest**2:g} times as many shells where all is split" if problem.refinement else ""
    yield f"time steps: about {cycles:.2g} cycles of {step:.2g} s {how}{split}"
    if cycles > MANY_CYCLES:
        yield 'hint: that many cycles mean slow tools or small elements; velocities are mm/s, and "2 m/s" is usual'


def _describe_materials(problem: Model) -> Iterator[str]:
    """Describe materials and their forming limits."""
    yield from (f"material {m.name}: density {m.density:.3g} t/mm3, {describe_material(m)}" for m in problem.materials)
    for each in problem.sheet_materials:
        of = f" of {each.name}" if problem.zones else ""
        yield f"forming limit{of}: {describe_forming_limit(each)}"
    yield from describe_drawing_ratio(problem)


def _describe_measures(asked: Springback) -> Iterator[str]:
    """Describe what is measured of the released part."""
    for section in asked.sections:
        x, y = section.start
        reach = "as far as there is sheet" if math.isinf(section.length) else f"over {section.length:.4g} mm"
        degrees = math.degrees(section.angle)
        yield f"section {section.name}: through ({x:g}, {y:g}) mm at {degrees:.4g} degrees from x, {reach}"
    if asked.gauge is not None:
        names = ", ".join(name for name, _ in asked.gauge.points) or "no points"
        yield f"gauge: {len(asked.gauge.clamps)} clamps, {names}"
    if asked.tolerance is not None:
        yield f"tolerance: {asked.tolerance[0]:g} to {asked.tolerance[1]:g} mm off the shape in the tools"


def _describe_operation(problem: Model, following: Operation | None) -> Iterator[str]:
    """Describe tools, beads, supports, stages and what follows them; following: of a later operation, how it begins."""
    if following is not None and following.place != PartPlace():
        place = following.place
        over = f"turned over about {place.over}, " if place.over else ""
        x, y, z = place.move
        degrees = np.degrees(place.turn)
        yield f"the part is laid in {over}turned by {degrees:g} degrees, moved by ({x:g}, {y:g}, {z:g}) mm"
    for tool in problem.tools:
        yield f"tool {tool.name}: {_describe_tool(tool, following)}"
    for bead in problem.beads:
        length = problem.whole * float(bead.length.sum())
        closing = f", {bead.closing_force:.4g} N/mm to close it" if bead.closing_force else ""
        stages = ", ".join(s.name for s in problem.stages if s.bead_share[bead.name][:, 1].any()) or "no stage"
        force = f"{bead.force:.4g} N/mm{closing}" if not bead.is_sought else _SOUGHT
        yield f"{bead.name}: {length:.4g} mm, {force}, in {stages}"
    if following is None:
        yield from _describe_closing(problem)
    holders = {tool.name for tool in problem.tools if tool.kind == "holder"}
    moved = [(n, motion) for stage in problem.stages for n, motion in stage.tool_motion.items()]
    if any(motion.push is None or name not in holders for name, motion in moved):  # what holds alone bends nothing
        yield from _hint_at_coarse_mesh(problem)
        yield from _hint_at_standing_holder(problem)
    for support in problem.supports:
        names = (name for name, fixed in zip(("x", "y", "z", "rx", "ry", "rz"), support.fix, strict=True) if fixed)
        yield f"support: {support.node_set} held in {', '.join(names)}{name_stages(support, problem)}"
    for number, stage in enumerate(problem.stages, 1):
        if stage.dwell is not None:
            yield f'stage {number} "{stage.name}": {_describe_dwell(stage.dwell)} for {stage.duration:.4g} s'
            continue
        how = f", {stage.ramp:.3g} s to start and to stop" if stage.drive is None else ""
        press = f", {stage.process_time:.4g} s in the press" if stage.process_time is not None else ""
        yield f'stage {number} "{stage.name}", {stage.duration:.4g} s{how}{press}:'
        closes = {c.tool: c for c in (following.closings if following else ()) if c.stage == number - 1}
        yield from (f"  {line}" for line in _describe_stage(problem, stage, closes))
    for line in problem.trim:
        low, high = line.polygon.min(axis=0), line.polygon.max(axis=0)
        reach = f"x {low[0]:.4g} to {high[0]:.4g} mm, y {low[1]:.4g} to {high[1]:.4g} mm"
        yield f"then trim {line.name}: what lies {line.keep} of a line over {reach} stays"
    if problem.springback is not None:
        yield f"then springback: tools and boundaries away, implicit, in {problem.springback.increments} increments"
        yield from _describe_measures(problem.springback)


def _describe_dwell(dwell: Dwell) -> str:
    """Describe where the sheet rests."""
    if not dwell.in_tools:
        return "heat alone, in air,"
    pressure = (
        "as the stage before has left them" if dwell.pressure is None else f"that press with {dwell.pressure:g} MPa"
    )
    return f"heat alone, between tools {pressure},"


def _describe_closing(problem: Model) -> Iterator[str]:
    """Describe after which stroke tools close on the sheet, and what is left at the end."""
    thickness, explicit = problem.thickest, problem.explicit
    irons = isinstance(explicit, ExplicitSheet) and explicit.ironing
    for punch, die in itertools.product(problem.tools, problem.tools):
        if (punch.kind, die.kind) != ("punch", "die"):
            continue
        closing = find_closing_stroke(punch, die, thickness, irons=irons)
        if closing is not None:
            x, y, z = closing.place + np.asarray(die.position)
            end = _describe_end(problem, punch, die, closing.travel)
            yield (
                f"{punch.name} and {die.name} close on the sheet when they have come {closing.travel:.4g} mm nearer, "
                f"at ({x:.4g}, {y:.4g}, {z:.4g}) mm of where {die.name} starts{end}"
            )


def _describe_end(problem: Model, punch: Tool, die: Tool, closing: float) -> str:
    """Describe the largest distance that punch and die keep; closing: the travel at which they close [mm]."""
    motions = [[stage.tool_motion.get(tool.name) for stage in problem.stages] for tool in (punch, die)]
    if any(motion is not None and motion.push is not None for each in motions for motion in each):
        return ""
    moves = [np.cumsum([(0.0, 0.0, 0.0) if m is None else m.move for m in each], axis=0) for each in motions]
    nearer = float(((moves[0] - moves[1]) @ np.asarray(punch.working_direction)).max(initial=0.0))
    left = closing - nearer - (1.0 - CLOSED) * problem.thickest
    if left <= TOUCHING * problem.thickest:
        return ""
    return (
        f"; the strokes bring them {nearer:.4g} mm nearer, which leaves the sheet {left:.3g} mm more than it is thick"
    )


def _finest(problem: Model) -> float:
    """Return the side of the smallest shells that there may be, over that at the start."""
    return 0.5**problem.refinement.levels if problem.refinement else 1.0


def _hint_at_standing_holder(problem: Model) -> Iterator[str]:
    """Describe a drawn holder that stands as far from the die as the sheet is thick, which thickens as it is drawn."""
    moved = {name for stage in problem.stages for name in stage.tool_motion}
    for holder, die in itertools.product(problem.tools, problem.tools):
        if (holder.kind, die.kind) != ("holder", "die") or moved & {holder.name, die.name}:
            continue
        gap, thickest = holder.position[2] - die.position[2], problem.thickest
        if isinstance(holder.shape, SweptProfile) and isinstance(die.shape, SweptProfile) and gap < ROOM * thickest:
            yield (
                f"hint: {holder.name} stands still, {gap:.4g} mm from {die.name}: a sheet that thickens as it is drawn "
                f"in is squeezed there; give tools.{holder.name}.gap = {1.1 * thickest:.3g} to {1.2 * thickest:.3g}, "
                "or push it by a force in the stages"
            )


def _hint_at_coarse_mesh(problem: Model) -> Iterator[str]:
    """Describe where a sheet is bent round a radius by too few elements."""
    for tool in problem.tools:
        if tool.kind != "holder":
            size = _finest(problem) * float(np.median(_measure_sides(problem, _straight_axis(tool))))
            radius = _least_radius(problem, tool, size)
            count = 0.5 * np.pi * radius / size
            if count < ELEMENTS_ROUND_AN_EDGE:
                wanted = 0.5 * np.pi * radius / ELEMENTS_ROUND_AN_EDGE
                advice = f"elements of {wanted:.2g} mm would be {ELEMENTS_ROUND_AN_EDGE}"
                if radius < SHARPEST * size:
                    advice = "the tool has sharp edges there: round them, or leave away what does not touch the sheet"
                least = "" if isinstance(tool.shape, SweptProfile) else f", whose least radius is about {radius:.2g} mm"
                sinks = size**2 / (8.0 * radius) if radius >= SHARPEST * size else 0.0
                stops = ""
                if sinks > problem.limits.penetration * problem.thickest:
                    stops = (
                        f"; chords of {size:.2g} mm sink {sinks:.2g} mm into it: limits.penetration may stop the run"
                    )
                yield f"hint: {count:.2g} elements round the edge of {tool.name}{least}; {advice}{stops}"


def _least_radius(problem: Model, tool: Tool, size: float) -> float:
    """Return the edge radius of a drawn tool, or the least one of a tool from a file beside the blank [mm]."""
    if isinstance(tool.shape, SweptProfile):
        return _edge_radius(tool.shape)
    blank = problem.mesh.points[:, :2]
    reach = np.abs(blank).max(axis=0) if any(problem.symmetry) else np.zeros(2)
    low, high = np.minimum(blank.min(axis=0), -reach), np.maximum(blank.max(axis=0), reach)
    assert isinstance(tool.shape, Triangulation)
    corners = tool.shape.points[tool.shape.triangles] + np.asarray(tool.position)
    beside = ((corners[..., :2] >= low) & (corners[..., :2] <= high)).all(axis=(1, 2))
    return find_least_radius(tool.shape.points, tool.shape.triangles[beside], EDGE * size)


def _edge_radius(shape: SweptProfile) -> float:
    """Return the least radius of the profile's arcs [mm]; 0 without one."""
    return min(_list_radii(shape), default=0.0)


def _list_radii(shape: SweptProfile) -> list[float]:
    """Return the radii of the profile's arcs, each once [mm]."""
    arcs = shape.segments[shape.segments[:, 6] != 0]
    return sorted({float(f"{radius:.6g}") for radius in np.hypot(*(arcs[:, :2] - arcs[:, 4:6]).T)})


def _straight_axis(tool: Tool) -> int | None:
    """Return the axis, 0 or 1, along which a strip's tool is straight and bends no sheet; None of other tools."""
    if isinstance(tool.shape, SweptProfile) and np.inf in tool.shape.half_widths:
        return tool.shape.half_widths.index(np.inf)
    return None


def _measure_sides(problem: Model, left_out: int | None = None) -> FloatArray:
    """Return the lengths of the cells' sides (n,) [mm], without those that run nearer to the axis `left_out`."""
    corners = [problem.mesh.points[block.connectivity] for block in problem.mesh.blocks]
    sides = np.concatenate([(c - np.roll(c, 1, axis=1)).reshape(-1, 3) for c in corners])
    if left_out is not None:
        sides = sides[np.abs(sides[:, left_out]) <= np.abs(sides[:, 1 - left_out])]
    return np.asarray(np.linalg.norm(sides, axis=1))


def _find_narrowest(problem: Model) -> tuple[float, FloatArray]:
    """Return how wide the narrowest cell is [mm], a square as its side, and the middle of it (2,) [mm].

    The width is the area over the longest of sides and diagonals, times the square root of 2.
    """
    widths, middles = [], []
    for block in problem.mesh.blocks:
        corners = problem.mesh.points[block.connectivity]
        spans = corners[:, :, None] - corners[:, None, :]
        longest = np.linalg.norm(spans, axis=3).max(axis=(1, 2))
        fan = np.cross(corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1]).sum(axis=1)
        widths.append(np.sqrt(2.0) * 0.5 * np.linalg.norm(fan, axis=1) / longest)
        middles.append(corners.mean(axis=1)[:, :2])
    width, middle = np.concatenate(widths), np.concatenate(middles)
    at = int(np.argmin(width))
    return float(width[at]), middle[at]


def _describe_ironing(problem: Model) -> str:
    """Describe what becomes of a sheet that is thicker than the room between two tools."""
    explicit = problem.explicit
    if isinstance(explicit, ExplicitSheet) and explicit.ironing:
        return "two tools that leave the sheet less room than it is thick squeeze it thinner"
    why = "switched off" if explicit is not None else "the implicit procedure does not offer it"
    return f"none, {why}: tools sink into a sheet that is thicker than the room between them, at forces no press has"


def _describe_tool(tool: Tool, following: Operation | None) -> str:
    x, y, z = tool.position
    place = f"at ({x:g}, {y:g}, {z:g}) mm"
    if following is not None and tool.name in following.laid:
        place = f"at ({x:g}, {y:g}) mm where it touches the part"
    elif following is not None and tool.name in following.spaced:
        other, above = following.spaced[tool.name]
        place = f"at ({x:g}, {y:g}) mm, {above:g} mm over {other}"
    if isinstance(tool.shape, SweptProfile):
        shape = _describe_shape(tool.shape)
    else:
        assert isinstance(tool.shape, Triangulation)
        shape = f"{len(tool.shape.triangles)} triangles"
    return f"{tool.kind}, {shape}, {place}, friction {tool.friction.mu:g}"


def _describe_shape(shape: SweptProfile) -> str:
    """Describe how wide a drawn tool is in the plan, and what radii its profile has."""
    x, y = (2.0 * width for width in shape.half_widths)
    ends = shape.segments[:, [0, 2]]
    if math.isinf(x + y):
        plan = f"straight along {'x' if math.isinf(x) else 'y'}, {min(x, y):g} mm wide"
    elif x == y == 2.0 * shape.corner_radius:
        outer = x + 2.0 * float(ends.max())
        is_ring = float(ends.min()) >= 0.0 and shape.segments[0, 1] * shape.segments[-1, 3] > 0.0
        plan = f"round, {x:g} mm across" if not is_ring else f"ring, {x:g} mm across inside and {outer:g} mm outside"
    else:
        plan = f"{x:g} x {y:g} mm, corners {shape.corner_radius:g} mm"
    radii = _list_radii(shape)
    edges = " and ".join(f"{radius:g}" for radius in radii)
    return f"{plan}, edge radi{'us' if len(radii) < 2 else 'i'} {edges or '0'} mm"


def _describe_stage(problem: Model, stage: Stage, closing: Mapping[str, Closing]) -> Iterator[str]:
    """Describe what moves and pushes in a stage; closing: by name, the travel of tools that go on until they leave a
    given room."""
    holders = {tool.name: tool for tool in problem.tools if tool.kind == "holder"}
    directions = {tool.name: tool.working_direction for tool in problem.tools}
    if stage.drive is not None:
        yield describe_drive(stage.drive)
    for name, motion in stage.tool_motion.items():
        if name in closing:
            yield f"{name} goes on until it leaves {closing[name].gap:g} mm to {' and '.join(closing[name].dies)}"
        elif motion.push is None:
            stroke = float(np.dot(motion.move, directions[name] or (0.0, 0.0, 0.0)))
            speed = f", at {abs(stroke) / (stage.duration - stage.ramp):.4g} mm/s" if stage.drive is None else ""
            yield f"{name} moves by {stroke:g} mm{speed}"
        else:
            forces = motion.push.force[:, 1]
            span = f"{forces[0]:g} N" if len(forces) == 1 else f"{forces.min():g} to {forces.max():g} N over the stroke"
            pressure = ""
            if name in holders:
                area = find_held_area(problem.mesh, holders[name]) * problem.whole
                pressure = f", at most {forces.max() / area:.3g} MPa on the flange as it starts" if area > 0 else ""
            yield f"{name} pushes with {span}{pressure}"
    pressures = list(describe_courses(problem, stage))
    yield from pressures
    if not stage.tool_motion and not stage.prescribed and not pressures:
        yield "nothing moves: the tools stand where they touch the part"
    for p in stage.prescribed:
        yield f"{p.node_set} moves by {p.value:g} mm along {'xyz'[p.component]}"
