# SPDX-License-Identifier: Apache-2.0
"""What `presswork check` says of a shell."""

from __future__ import annotations

from collections.abc import Iterator

from presswork import model

_WORDS: dict[str, str] = {
    "shell3": "3-node degenerated shells, one point; they lock",
    "shell3_mitc": "3-node shells, tied transverse shear (MITC3)",
    "shell3_mitc_plus": "3-node shells, tied transverse shear and a bubble of the directors (MITC3+)",
    "shell6": "6-node degenerated shells, 6 points",
    "shell6_selective": "6-node degenerated shells, transverse shear from 3 points",
    "shell6_reduced": "6-node degenerated shells, 3 points",
    "shell6_mitc": "6-node shells, all strains tied (MITC6)",
    "shell4": "4-node degenerated shells, 2 x 2 points; they lock",
    "shell4_selective": "4-node degenerated shells, transverse shear from the centre",
    "shell4_reduced": "4-node degenerated shells, one point, no hourglass control",
    "shell4_mitc": "4-node shells, tied transverse shear (MITC4)",
    "shell4_mitc_plus": "4-node shells, tied transverse shear and in-plane strains (MITC4+)",
    "shell4_1pt": "4-node shells, one point, physical stabilisation",
    "shell8": "8-node degenerated shells, 3 x 3 points",
    "shell8_selective": "8-node degenerated shells, transverse shear from 2 x 2 points",
    "shell8_reduced": "8-node degenerated shells, 2 x 2 points",
    "shell9": "9-node degenerated shells, 3 x 3 points",
    "shell9_selective": "9-node degenerated shells, transverse shear from 2 x 2 points",
    "shell9_reduced": "9-node degenerated shells, 2 x 2 points",
    "shell9_mitc": "9-node shells, all strains tied (MITC9, on the sides)",
}


def describe_sheet(problem: model.Model) -> Iterator[str]:
    """Describe mesh and sections, a line per fact."""
    mesh = problem.mesh
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    yield "analysis: shell, large rotation and strain"
    spans = (f"{axis} {a:g} to {b:g} mm" for axis, a, b in zip("xyz", low, high, strict=True))
    yield f"workpiece: {', '.join(spans)}"
    for block in mesh.blocks:
        material = problem.materials[block.material].name
        yield f"elements: {len(block.connectivity)} {block.element} ({_WORDS[block.element]}) of {material}"
        if block.section:
            section = block.section
            yield f"section: {section.thickness:g} mm thick, {section.points} {section.rule.capitalize()} points"
    n = len(mesh.points)
    yield f"nodes: {n}, freedoms: {6 * n} before supports, boundary edges: {len(mesh.boundary_edges)}"
    yield f"node sets: {', '.join(f'{name} ({len(nodes)})' for name, nodes in sorted(mesh.node_sets.items()))}"
    yield f"edge sets: {', '.join(f'{name} ({len(edges)})' for name, edges in sorted(mesh.edge_sets.items()))}"


def describe_sheet_loads(stage: model.Stage) -> Iterator[str]:
    """Describe the loads that only shells have."""
    for pressure in stage.shell_pressures:
        yield f"pressure {pressure.value:g} MPa on {pressure.node_set}"
    for body in stage.body_forces:
        yield f"force ({', '.join(f'{f:g}' for f in body.force)}) N/mm3 on the whole sheet"
