# SPDX-License-Identifier: Apache-2.0
"""How deep nodes and edges are inside tools, as summary.json says."""

from pathlib import Path

import numpy as np
import pytest

from presswork import Case, run
from presswork.examples import copy_example
from presswork.model import Mesh
from presswork.observe.penetration import measure_bodies
from presswork.recorder import Outcome


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
    "example",
    [
        "upsetting_4cst",
        "upsetting_q4",
        "upsetting_q8_2x2",
        "upsetting_t6_7pt",
        pytest.param("heading", marks=pytest.mark.validation),
    ],
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


def press_rib(folder: Path, analysis: str, element: str = "quad4_fbar", **limits: float) -> Outcome:
    """Press a hard rib 1 mm wide by 2 mm into a block with edges of 2.5 mm on which the pressure is interpolated."""
    hardening = {"law": "linear", "modulus": 10}
    case = Case(
        title="rib",
        analysis=analysis,
        workpiece={"material": "steel", "element": element, "mesh": {"size": [15, 12], "cells": [6, 5]}},
        materials={
            "steel": {"young": 200e3, "poisson": 0.3, "hardening": {**hardening, "yield_stress": 130}},
            "hard": {"young": 200e3, "poisson": 0.3, "hardening": {**hardening, "yield_stress": 3000}},
        },
        bodies={
            "rib": {
                "material": "hard",
                "element": element,
                "mesh": {"origin": [8.2, 12], "size": [1, 4], "cells": [1, 4]},
            }
        },
        contacts={"joint": {"between": ["rib", "workpiece"], "contact": "frictionless", "slave": "workpiece"}},
        boundary={"axis": {"set": "left", "fix": ["x"]}, "floor": {"set": "bottom", "fix": ["y"]}},
        stages=[
            {
                "name": "press",
                "displacement": [
                    {"set": "rib.top", "component": "y", "value": -2},
                    {"set": "rib.top", "component": "x", "value": 0},
                ],
            }
        ],
        limits=limits,
    )
    return run(case, folder, threads=1)


def test_the_depth_of_bodies_in_each_other_is_that_of_their_edges() -> None:
    """A rib 1 mm wide 0.3 mm deep in the middle of an edge of 2 mm: by the rib's own edge, which is shorter."""
    squares = {"block": [[0, 0], [2, 0], [2, 2], [0, 2]], "rib": [[0.5, 1.7], [1.5, 1.7], [1.5, 2.7], [0.5, 2.7]]}
    points = np.array([corner for square in squares.values() for corner in square], dtype=float)
    edges = {name: np.array([[0, 1], [1, 2], [2, 3], [3, 0]]) + 4 * i for i, name in enumerate(squares)}
    mesh = Mesh(points.copy(), (), {}, {}, np.concatenate(list(edges.values())))
    found = measure_bodies(mesh, points, edges)
    assert found is not None
    assert found.value == pytest.approx(0.3, abs=1e-9)
    assert "the body block has cut 0.3 mm into the body rib" in found.fact
    points[4:, 1] += 0.301
    assert measure_bodies(mesh, points, edges) is None


@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"])
def test_bodies_in_each_other_are_found_and_stop_a_run(tmp_path: Path, analysis: str) -> None:
    """The mean gaps of the contact's pressures are near zero, but the rib's corners are in the block's edges."""
    whole = press_rib(tmp_path / "whole", analysis)
    assert whole.status == "completed"
    result, largest = whole.result, whole.result.summary["limits"]["penetration"]["largest"]
    assert 0.1 < largest < 0.4
    stopped = press_rib(tmp_path / "stopped", analysis, penetration=0.5 * largest)
    assert stopped.status == "gave_up"
    assert "has cut" in stopped.reason
    assert "limits.penetration" in stopped.reason
    assert stopped.result.times[-1] < result.times[-1]
