# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` reports about a shell."""

from __future__ import annotations

from collections.abc import Iterator

from presswork import model


def describe_sheet(problem: model.Model) -> Iterator[str]:
    """Describe mesh and sections, a line per fact."""
    mesh = problem.mesh
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    yield "analysis: shell, large rotation and strain"
    spans = (f"{axis} {a:g} to {b:g} mm" for axis, a, b in zip("xyz", low, high, strict=True))
    yield f"workpiece: {', '.join(spans)}"
    for block in mesh.blocks:
        what, material = model.ELEMENTS[block.element].description, problem.materials[block.material].name
        yield f"elements: {len(block.connectivity)} {block.element} ({what}) of {material}"
        if problem.zones:
            yield f"zone: {problem.zones[block.zone] or 'the sheet beside its zones'}"
        if block.section:
            section = block.section
            yield f"section: {section.thickness:g} mm thick, {section.points} {section.rule.capitalize()} points"
    n = len(mesh.points)
    yield f"nodes: {n}, freedoms: {6 * n} before supports, boundary edges: {len(mesh.boundary_edges)}"
    yield f"node sets: {', '.join(f'{name} ({len(nodes)})' for name, nodes in sorted(mesh.node_sets.items()))}"
    yield f"edge sets: {', '.join(f'{name} ({len(edges)})' for name, edges in sorted(mesh.edge_sets.items()))}"
