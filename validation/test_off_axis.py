# SPDX-License-Identifier: Apache-2.0
"""Tensile specimens of AA2090-T3 with heads, cut every 15 degrees and pulled between clamps: r-values of the gauge."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.case.material.yld2000_fit import r_value
from presswork.model import Mesh
from tests.problems.off_axis import GIVEN, POISSON, YOUNG, run_turned, sheet
from tests.problems.shells import RX, RY, RZ, X, Y, Z, fixing, patch, shell_model

pytestmark = pytest.mark.validation

GAUGE, HALF_WIDTH, HEAD, RADIUS, GRIP = 100.0, 10.0, 15.0, 20.0, 20.0
"""Half of the parallel length is 50; 20 mm wide; heads 30 mm wide, fillets of 20 mm [mm]."""
STRAIN = 0.04
FILLET = float(np.sqrt(RADIUS**2 - (RADIUS - (HEAD - HALF_WIDTH)) ** 2))
REACH = GAUGE / 2 + FILLET + GRIP


def half_width(x: np.ndarray) -> np.ndarray:
    """Half the width of the specimen at x from its middle."""
    beyond = np.clip(np.abs(x) - GAUGE / 2, 0.0, FILLET)
    return np.where(np.abs(x) > GAUGE / 2, HALF_WIDTH + RADIUS - np.sqrt(RADIUS**2 - beyond**2), HALF_WIDTH)


def specimen() -> Mesh:
    """Mesh it with 8 cells across; node sets "everywhere" and the clamped ends "left", "right"."""
    lines = np.linspace(-REACH, REACH, 73)
    mesh = patch(lambda u, v: np.column_stack([u, v * half_width(u), 0 * u]), lines, np.linspace(-1, 1, 9))
    everywhere = np.arange(len(mesh.points), dtype=np.int32)
    return replace(mesh, node_sets={**mesh.node_sets, "everywhere": everywhere})


def measure(degrees: float, name: str = "yld2000") -> tuple[float, float]:
    """Return width over thickness strain, plastic, of the middle 50 mm, and that of the thickness field alone."""
    held = [("everywhere", fixing(Z, RX, RY, RZ)), ("left", fixing(X, Y)), ("right", fixing(Y))]
    stroke = (GAUGE + FILLET) * STRAIN
    model = shell_model(specimen(), sheet(name, 2000.0), held, prescribed=[("right", X, stroke)],
                        initial_increment=0.02, max_increment=0.1)  # fmt: skip
    procedure = run_turned(model, np.radians(degrees))
    mesh, u = model.mesh, procedure.state.nodes.displacement
    fields = procedure.mechanics.cell_fields(procedure.state)
    middle = np.abs(mesh.points[mesh.blocks[0].connectivity, 0].mean(axis=1)) < 25.0
    edge = [mesh.node_sets[side] for side in ("bottom", "top")]
    inside = np.abs(mesh.points[edge[0], 0]) < 25.0
    now = mesh.points[:, 1] + u[:, 1]
    across = np.log((now[edge[1]] - now[edge[0]])[inside] / (2 * HALF_WIDTH)).mean()
    elastic = POISSON * fields["lamina_stress_middle"][middle, :2].sum(axis=1).mean() / YOUNG
    width, thickness = across + elastic, fields["thickness_strain"][middle].mean() + elastic
    return float(width / thickness), float(fields["equivalent_plastic_strain"][middle].mean())


@pytest.mark.parametrize("degrees", [0, 15, 30, 45, 60, 75, 90])
def test_gauge_of_a_specimen_with_heads_has_the_r_value(degrees) -> None:
    ratio, strain = measure(degrees)
    expected = float(r_value(GIVEN["yld2000"].build(), np.radians([degrees]))[0])
    print(f"{degrees} degrees: r = {ratio:.4f}, formula {expected:.4f}, plastic strain {strain:.4f}")
    assert strain > 0.02
    assert ratio == pytest.approx(expected, rel=0.02)
