# SPDX-License-Identifier: Apache-2.0
"""How deep nodes and edges are inside tools, as summary.json says."""

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example


def press_wedge(folder: Path, cells: int) -> dict[str, float]:
    """Press a blunt wedge (30 degrees a side, its tip a quarter of a cell beside a node) 1 mm into a block."""
    tip = 10 * (0.5 + 0.25 / cells)
    slope = np.tan(np.radians(30.0))
    case = Case(
        title="wedge",
        analysis="plane_strain",
        workpiece={"material": "steel", "element": "quad4_fbar", "mesh": {"size": [10, 10], "cells": [cells, cells]}},
        materials={"steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 300}}},
        tools={
            "wedge": {
                "profile": [[tip - 9, 10 + 9 * slope], [tip, 10], [tip + 9, 10 + 9 * slope]],
                "contact": "frictionless",
            }
        },
        boundary={"bottom": {"set": "bottom", "fix": ["x", "y"]}},
        stages=[{"name": "press", "tools": {"wedge": {"move": [0, -1]}}}],
    )
    outcome = run(case, folder, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result.summary["contact"]


def test_edges_of_a_coarse_mesh_cut_the_corner_of_a_tool_and_nodes_do_not(tmp_path: Path) -> None:
    depth = []
    for cells in (4, 8):
        contact = press_wedge(tmp_path / str(cells), cells)
        assert contact["largest_node_penetration_mm"] <= contact["tolerance_mm"]
        depth.append(contact["largest_edge_penetration_mm"])
    assert depth[0] > 0.1
    assert depth[1] < depth[0]


@pytest.mark.parametrize(
    "example", ["upsetting_4cst", "upsetting_q4", "upsetting_q8_2x2", "upsetting_t6_7pt", "heading"]
)
def test_no_node_is_inside_a_tool_in_the_examples(tmp_path: Path, example: str) -> None:
    case = Case.from_toml(copy_example(example, tmp_path))
    result = run(case, tmp_path / "out").result
    contact = result.summary["contact"]
    assert contact["largest_node_penetration_mm"] <= contact["tolerance_mm"]
    if example in ("upsetting_4cst", "upsetting_q4"):  # straight edges on a flat tool
        assert contact["largest_edge_penetration_mm"] <= contact["tolerance_mm"]
    gap, status = result.field("gap"), result.field("contact_status")
    boundary = np.unique(result.mesh.boundary_edges)
    assert np.isnan(np.delete(gap, boundary)).all(), "only the boundary has a gap"
    np.testing.assert_allclose(gap[status > 0], 0.0, atol=contact["tolerance_mm"])
    assert np.nanmin(gap[status == 0]) >= -contact["tolerance_mm"]


def test_the_largest_penetration_survives_a_resume(tmp_path: Path) -> None:
    class Interrupt:
        left = 30

        def __call__(self, _: object) -> None:
            self.left -= 1
            if self.left == 0:
                raise KeyboardInterrupt

    case = Case.from_toml(copy_example("upsetting_q8_2x2", tmp_path), overrides=["workpiece.mesh.cells=[5,5]"])
    reference = run(case, tmp_path / "reference").result.summary["contact"]
    assert run(case, tmp_path / "out", on_increment=Interrupt()).status == "interrupted"
    assert run(case, tmp_path / "out", resume=True).result.summary["contact"] == reference
    assert reference["largest_edge_penetration_mm"] > 0
