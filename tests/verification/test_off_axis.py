# SPDX-License-Identifier: Apache-2.0
"""Off-axis tension of meshed sheets: width and thickness strain give back the r-value, the force the yield stress."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.case.material.yld2000_fit import r_value, tension
from tests.problems.off_axis import GIVEN, MODULUS, POISSON, YIELD, YOUNG, run_turned, sheet
from tests.problems.shells import RX, RY, RZ, X, Y, Z, fixing, patch, shell_model

LENGTH, WIDTH, P = 4.0, 2.0, 1e-3


@pytest.mark.parametrize("degrees", [0, 15, 30, 45, 60, 75, 90])
@pytest.mark.parametrize("name", GIVEN)
def test_width_over_thickness_strain_is_the_r_value_every_15_degrees(name, degrees) -> None:
    """Dead tractions on both ends, sides free, one side kept straight: homogeneous, the shear that the sheet wants
    included. Plastic strain of 0.001, so that the sheet hardly turns under the tension.
    """
    angle = np.radians(degrees)
    function = GIVEN[name].build()
    equivalent = float(function.evaluate(tension(np.array([angle])))[0][0])  # of a unit tension
    stress = (YIELD + MODULUS * P) / equivalent
    mesh = patch(lambda u, v: np.column_stack([u, v, 0 * u]), np.linspace(0, LENGTH, 4), np.linspace(0, WIDTH, 3),
                 distortion=0.2)  # fmt: skip
    everywhere = np.arange(len(mesh.points), dtype=np.int32)
    mesh = replace(mesh, node_sets={**mesh.node_sets, "everywhere": everywhere})
    held = [("everywhere", fixing(Z, RX, RY, RZ)), ("bottom_left", fixing(X, Y)), ("bottom_right", fixing(Y))]
    pulls = [("left", (-stress, 0.0, 0.0)), ("right", (stress, 0.0, 0.0))]
    model = shell_model(mesh, sheet(name), held, edges=pulls, initial_increment=0.2, max_increment=0.2,
                        force_tolerance=1e-9)  # fmt: skip
    procedure = run_turned(model, angle)
    u = procedure.state.nodes.displacement
    at = {name: int(mesh.node_sets[name][0]) for name in ("bottom_left", "bottom_right", "top_left")}
    along = np.log1p((u[at["bottom_right"], X] - u[at["bottom_left"], X]) / LENGTH)
    across = np.log1p((u[at["top_left"], Y] - u[at["bottom_left"], Y]) / WIDTH)
    thinning = procedure.mechanics.cell_fields(procedure.state)["thickness_strain"]
    np.testing.assert_allclose(thinning, thinning.mean(), rtol=1e-6)
    swollen = 1 + (1 - 2 * POISSON) * stress / YOUNG  # the section shrinks as the length grows, but for this
    elastic = stress * np.exp(along) / swollen / YOUNG
    width, thickness = across + POISSON * elastic, thinning.mean() + POISSON * elastic
    plastic = (elastic * YOUNG * equivalent - YIELD) / MODULUS
    # the sheet turns by up to a tenth of a degree under the tension, which moves its yield stress by 0.1 MPa
    assert along - elastic == pytest.approx(plastic * equivalent, rel=0.03)
    assert width / thickness == pytest.approx(float(r_value(function, np.array([angle]))[0]), rel=5e-3)
