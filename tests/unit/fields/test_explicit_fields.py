# SPDX-License-Identifier: Apache-2.0
"""What is looked at in every row of a run is what the saved fields have."""

import numpy as np
import pytest

from presswork.case import StampingCase, build_model
from presswork.process.explicit.stamping import ExplicitStamping
from tests.unit.case.round_cup import CUP, changed

NAMES = ("major_strain_middle", "minor_strain_middle", "thickness_strain")


@pytest.mark.parametrize("points", [4, 5])
def test_strains_in_the_middle_are_those_of_the_saved_fields(points: int) -> None:
    """A blank bent and stretched by 1e-9 and by a half, with 4 and 5 points through the thickness."""
    model = build_model(StampingCase.model_validate(changed(CUP, ("blank.element_size", 8), ("blank.points", points))))
    run = ExplicitStamping(model, threads=1)
    x = np.array(model.mesh.points)
    for size in (1e-9, 0.02):
        u = size * np.column_stack([0.3 * x[:, 1] * x[:, 0], x[:, 1] ** 2, x[:, 0] * x[:, 1]])
        now = x + u
        thickness = run.shells.thickness * (1.0 - 3.0 * size * np.linspace(0.0, 1.0, len(run.shells.thickness)))
        shells = run.shells
        fields = run._fields.of_shells.cell_fields(
            now, thickness, shells.flow_stress_at_points, shells.pressure_at_points,
            shells.history_at_points[..., 0],
        )  # fmt: skip
        found = run._fields.of_shells.middle_strains(now, thickness)
        assert set(found) == set(NAMES)
        for name in NAMES:
            assert np.abs(fields[name]).max() > 0.0
            np.testing.assert_allclose(found[name], fields[name], rtol=1e-9, atol=4e-15, err_msg=name)
