# SPDX-License-Identifier: Apache-2.0
"""The Model in words, for `presswork check`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields

import numpy as np

from presswork import model
from presswork.case.description.explicit import describe_explicit, describe_ramp
from presswork.case.description.heat import describe_heat, describe_heat_of_forming
from presswork.case.description.loads import describe_gravity, describe_loads
from presswork.case.description.material import describe_material
from presswork.case.description.press import describe_drive
from presswork.case.description.shell import describe_sheet
from presswork.case.description.supports import describe_support
from presswork.geometry.crossing import bound_segments
from presswork.geometry.pose import start_profile, turn_about
from presswork.memory import available_memory, estimate_memory
from presswork.model import FloatArray, OneStepModel


def describe(problem: model.Model | OneStepModel) -> str:
    """Describe a Model in words, a line per fact, with an estimate of what computing it takes."""
    if isinstance(problem, OneStepModel):
        from presswork.case.description.onestep import describe_onestep

        return "\n".join([problem.title, *describe_onestep(problem)])
    if problem.analysis == "stamping":
        from presswork.case.description.stamping import describe_stamping

        return "\n".join([problem.title, *describe_stamping(problem), _describe_memory(problem)])
    lines = [problem.title, *_describe_body(problem)]
    if problem.heat is not None and problem.heat.alone:
        lines += [
            *describe_heat(problem, problem.heat),
            f"output: {_describe_output(problem)}",
            _describe_memory(problem),
        ]
        return "\n".join(lines)
    cold = problem.heat is None  # else the bodies' temperatures are described
    lines += [f"material {material.name}: {describe_material(material, starts=cold)}" for material in problem.materials]
    lines += [f"tool {tool.name}: {_describe_tool(tool)}" for tool in problem.plane_tools]
    lines += [f"tool {tool.name}: {_describe_space_tool(tool)}" for tool in problem.space_tools]
    lines += [f"contact {contact.name}: {_describe_contact(problem, contact)}" for contact in problem.contacts]
    lines += [describe_support(support, problem) for support in problem.supports]
    lines += describe_gravity(problem)
    for number, stage in enumerate(problem.stages, 1):
        lines += [
            f'stage {number} "{stage.name}", {stage.duration:g} s:',
            *(f"  {line}" for line in _describe_stage(stage, problem)),
            *(f"  {line}" for line in describe_loads(problem, number - 1)),
            *(f"  {line}" for line in (describe_ramp(stage) if problem.explicit is not None else ())),
        ]
    meshes = [_describe_remeshing(problem.remeshing)] if problem.remeshing is not None else []
    if problem.heat is not None:
        lines += describe_heat_of_forming(problem, problem.heat)
    lines += meshes
    if isinstance(problem.explicit, model.ExplicitSolid):
        return "\n".join([*lines, *describe_explicit(problem, problem.explicit), _describe_memory(problem)])
    lines += [f"solver: {_describe_settings(problem.solver, model.SolverSettings())}"]
    lines += [f"output: {_describe_output(problem)}"]
    lines += list(_warn_of_steps(problem))
    lines += [_describe_memory(problem)]
    return "\n".join(lines)


def _describe_body(problem: model.Model) -> Iterator[str]:
    mesh = problem.mesh
    if problem.analysis == "shell":
        yield from describe_sheet(problem)
        return
    if problem.analysis == "solid":
        yield from _describe_space_solid(problem)
        return
    depth = f", depth {problem.depth:g} mm" if problem.analysis == "plane_strain" else " (x is the radius, y the axis)"
    kind = (
        problem.analysis.replace("_", " ")
        if problem.heat is None or not problem.heat.alone
        else f"heat, {problem.analysis.split('_')[0]}"
    )
    yield f"analysis: {kind}{depth}"
    whole = model.Body("workpiece", range(len(mesh.points)), range(len(mesh.blocks)))
    for body in problem.bodies or (whole,):
        points = mesh.points[body.points.start : body.points.stop]
        low, high = points.min(axis=0), points.max(axis=0)
        yield f"{body.name}: x {low[0]:g} to {high[0]:g} mm, y {low[1]:g} to {high[1]:g} mm"
        for block in mesh.blocks[body.blocks.start : body.blocks.stop]:
            yield _describe_block(problem, block)
    n_points = len(mesh.points)
    freedoms = problem.freedoms * n_points
    yield f"nodes: {n_points}, freedoms: {freedoms} before supports, boundary edges: {len(mesh.boundary_edges)}"
    yield f"node sets: {', '.join(f'{name} ({len(nodes)})' for name, nodes in sorted(mesh.node_sets.items()))}"
    yield f"edge sets: {', '.join(f'{name} ({len(edges)})' for name, edges in sorted(mesh.edge_sets.items()))}"


def _describe_block(problem: model.Model, block: model.CellBlock) -> str:
    what, material = model.ELEMENTS[block.element].description, problem.materials[block.material].name
    return f"elements: {len(block.connectivity)} {block.element} ({what}) of {material}"


def _describe_space_solid(problem: model.Model) -> Iterator[str]:
    mesh = problem.mesh
    yield "analysis: solid in space"
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    extent = ", ".join(f"{axis} {a:g} to {b:g} mm" for axis, a, b in zip("xyz", low, high, strict=True))
    yield f"workpiece: {extent}"
    for block in mesh.blocks:
        yield _describe_block(problem, block)
    n_points = len(mesh.points)
    freedoms = problem.freedoms * n_points
    yield f"nodes: {n_points}, freedoms: {freedoms} before supports, boundary faces: {len(mesh.boundary_faces)}"
    yield f"node sets: {', '.join(f'{name} ({len(nodes)})' for name, nodes in sorted(mesh.node_sets.items()))}"
    yield f"face sets: {', '.join(f'{name} ({len(faces)})' for name, faces in sorted(mesh.face_sets.items()))}"


def _describe_remeshing(remeshing: model.Remeshing) -> str:
    if remeshing.obstacle:
        return f"new meshes: none ({remeshing.obstacle})"
    if remeshing.keeps_first:
        return "new meshes: where an increment fails on the first one, or a tool cuts deep into it"
    due = f", and after every {remeshing.every:g} of a stage" if remeshing.every else ""
    return (
        f"new meshes: cells of {remeshing.smallest_size:.3g} to {remeshing.size:.3g} mm, at most "
        f"{remeshing.max_cells:,}; made where a cell's quality falls below {remeshing.quality:g}{due}"
    )


def _describe_space_tool(tool: model.Tool) -> str:
    shape = tool.surface
    if isinstance(shape, model.Plane):
        what = "plane with the normal ({:g}, {:g}, {:g})".format(*shape.normal)
    elif isinstance(shape, model.SweptProfile):
        is_round = shape.half_widths == (shape.corner_radius, shape.corner_radius)
        what = f"{'round' if is_round else 'rectangular'}, a profile of {len(shape.segments)} pieces carried round z"
    else:
        what = f"{len(shape.triangles)} triangles, {'closed' if shape.is_closed else 'open'}"
    place = "at ({:g}, {:g}, {:g}) mm".format(*tool.position)
    mirrors = [axis for axis, mirrored in zip("xyz", tool.mirrored_across, strict=False) if mirrored]
    twice = f", whole tool mirrored across the symmetry planes normal to {' and '.join(mirrors)}" if mirrors else ""
    twice += f", whole tool of {tool.sectors:g} such sectors" if tool.sectors > 1 else ""
    return f"{what}, {place}, {tool.friction.law}{_describe_friction(tool)}{twice}"


def _describe_tool(tool: model.Tool) -> str:
    segments = start_profile(tool)
    n_arcs = int(np.count_nonzero(segments[:, 6]))
    counts = [(len(segments) - n_arcs, "line"), (n_arcs, "arc")]
    shape = " and ".join(f"{count} {word}{'s' if count > 1 else ''}" for count, word in counts if count)
    mirrors = [axis for axis, mirrored in zip("xy", tool.mirrored_across, strict=True) if mirrored]
    twice = f", whole tool mirrored across the symmetry plane normal to {' and '.join(mirrors)}" if mirrors else ""
    start, end = segments[0, :2], segments[-1, 2:4]
    spring = ""
    if tool.spring:
        x, y = tool.spring.direction
        spring = f", gives along ({x:g}, {y:g}) with {tool.spring.preload:g} N + {tool.spring.stiffness:g} N/mm"
    low, high = bound_segments(segments)
    extent = f"x {low[0]:g} to {high[0]:g} mm, y {low[1]:g} to {high[1]:g} mm"
    ends = f"from ({start[0]:g}, {start[1]:g}) to ({end[0]:g}, {end[1]:g})"
    return f"{shape} {ends}, {extent}, {tool.friction.law}{_describe_friction(tool)}{twice}{spring}"


def _describe_friction(tool: model.Tool) -> str:
    """Name the friction of a tool, every value of one that varies."""
    keys = model.FRICTION_KEYS.get(tool.friction.law, ())
    values = [(symbol, np.unique(getattr(tool.friction, symbol))) for symbol in keys]
    found = "".join(f", {symbol} = {' and '.join(f'{value:g}' for value in found)}" for symbol, found in values)
    return found + describe_factors(tool.friction.factors)


def describe_factors(factors: model.FrictionFactors | None) -> str:
    """Name what the friction of a tool depends on, with the range of its factor."""
    if factors is None:
        return ""
    tables = {name: getattr(factors, name) for name in ("pressure", "speed", "temperature", "path")}
    words = [f"{name} ({t[:, 1].min():g} to {t[:, 1].max():g})" for name, t in tables.items() if t is not None]
    if factors.exponent != 1.0:
        words.append(f"(p / {factors.reference:g} MPa)^{factors.exponent - 1.0:.4g}")
    return f", times factors of {', '.join(words)}"


def _describe_contact(problem: model.Model, contact: model.BodyContact) -> str:
    first, second = (problem.bodies[i].name for i in contact.between)
    friction = [f"{name} = {value:g}" for name, value in (("m", contact.m), ("mu", contact.mu)) if value]
    law = ", ".join([contact.contact, *friction])
    if first == second:
        return f"{first} with itself, {law}"
    return f"{first} with {second}, {law}; pressure on the nodes of {problem.bodies[contact.slave].name}"


def _describe_stage(stage: model.Stage, problem: model.Model) -> Iterator[str]:
    dimension = problem.dimension
    if stage.drive is not None:
        yield describe_drive(stage.drive)
    for name, motion in stage.tool_motion.items():
        if motion.start in ("touch", "touch_again"):
            yield f"tool {name} starts where it touches the workpiece"
        elif isinstance(motion.start, tuple):
            yield f"tool {name} starts at {_list(motion.start, dimension)} mm"
        if motion.push is not None:
            along = _list(motion.push.direction, dimension)
            yield f"tool {name} pushes along {along}, with {motion.push.force[-1, 1]:g} N at the end"
        if any(motion.move):
            yield f"tool {name} moves by {_list(motion.move, dimension)} mm"
        if motion.turn:
            seen = _describe_axis(next(tool for tool in problem.tools if tool.name == name)) if dimension == 3 else ""
            yield f"tool {name} turns by {np.degrees(motion.turn):g} degrees counter-clockwise{seen}"
    for entry in stage.prescribed:
        if entry.component < 3:
            yield f"{entry.node_set} moves by {entry.value:g} mm along {'xyz'[entry.component]}"
        else:
            yield f"{entry.node_set} turns by {np.degrees(entry.value):g} degrees about {'xyz'[entry.component - 3]}"


def _describe_axis(tool: model.Tool) -> str:
    """Return whence a turn of a tool in space is seen."""
    axis = turn_about(np.array(tool.rotation)) @ tool.axis
    return f", as seen from the tip of its axis along {_list(axis.round(6) + 0.0, 3)}"


def _list(vector: Sequence[float] | FloatArray, dimension: int) -> str:
    """Return the components of a vector in words."""
    return "(" + ", ".join(f"{part:g}" for part in vector[:dimension]) + ")"


def _describe_settings(settings: object, default: object) -> str:
    """Name the settings that differ from their defaults."""
    differing = [
        f"{entry.name} = {getattr(settings, entry.name)}"
        for entry in fields(settings)  # type: ignore[arg-type]
        if getattr(settings, entry.name) != getattr(default, entry.name)
    ]
    return ", ".join(differing) or "defaults"


def _describe_output(problem: model.Model) -> str:
    return _describe_settings(problem.output, model.OutputSettings())


def _warn_of_steps(problem: model.Model) -> Iterator[str]:
    """Warn that fewer steps may be saved than the case requests."""
    output, largest = problem.output, problem.solver.max_increment
    if not output.every and output.is_closer_than(largest):
        yield (
            f"note: output.steps = {output.steps} a stage lie closer together than solver.max_increment = {largest:g}: "
            "each is saved at the end of the increment that passes it, several as one; for all of them set "
            f"solver.max_increment = {1 / output.steps:g}"
        )


def _describe_memory(problem: model.Model) -> str:
    """Describe how much memory the problem takes, and how much is free here."""
    needed, there = estimate_memory(problem), available_memory()
    return f"memory: about {needed / 1e6:,.0f} MB (an estimate) of {there / 1e6:,.0f} MB that are free on this machine"
