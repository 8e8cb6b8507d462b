# SPDX-License-Identifier: Apache-2.0
"""Wrong input of an explicit run: each error names the culprit, its value and the remedy."""

import numpy as np
import pytest

from presswork.explicit.shells import ExplicitError, ExplicitShells, ShellOptions
from tests.unit.explicit.two_shells import CELLS, LAW, POINTS, STEEL


def build(**changes: object) -> ExplicitShells:
    given = {"points": POINTS, "connectivity": CELLS, "thickness": 0.8, "density": STEEL} | changes
    keyword = {name: given.pop(name) for name in ("axis", "options", "precision") if name in given}
    return ExplicitShells(
        given["points"], given["connectivity"], given["thickness"], LAW, given["density"], **keyword  # type: ignore[arg-type]
    )  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"thickness": [0.8, 0.0]}, "thickness of shell 1 is 0 mm"),
        ({"thickness": -1.0}, "thickness of shell 0 is -1 mm"),
        ({"density": 0.0}, "density = 0: it must be above zero; steel"),
        ({"density": 7850.0}, "beyond any metal: steel has 7.85e-9"),
        ({"points": POINTS[:, :2]}, "points has shape"),
        ({"points": np.where(POINTS == 2, np.nan, POINTS)}, "node 2 has a coordinate that is not a number"),
        ({"connectivity": [[0, 1, 4, 3], [1, 2, 6, 4]]}, "shell 1 names node 6: nodes are numbered from 0 to 5"),
        ({"connectivity": [[0, 1]]}, r"connectivity has shape .* it must be \(n, 4\) or \(n, 3\)"),
        ({"connectivity": [[0, 1, 4, 3], [1, 2, 4, 5]]}, r"shell 1 \(nodes \[1, 2, 4, 5\]\) is folded"),
        ({"connectivity": [[0, 1, 4, 3], [1, 2, 2, 4]]}, "shell 1 .* is folded or without area"),
        ({"connectivity": [[0, 1, 4], [0, 1, 2]]}, r"shell 1 \(nodes \[0, 1, 2, 2\]\) is folded or without area"),
        ({"precision": "half"}, "precision = 'half': give 'double' or 'single'"),
        ({"axis": (0.0, 0.0, 1.0)}, r"axis = \[0.0, 0.0, 1.0\] is not a direction in shell 0"),
        ({"axis": [[1, 0, 0], [0, 0, 0]]}, r"axis = .* shell 1 \(nodes \[1, 2, 5, 4\]\), but normal to it or zero"),
    ],
)
def test_bad_shells(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        build(**changes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"n_points": 0}, "n_points = 0: a gauss rule has 1 to 51"),
        ({"n_points": 1, "rule": "lobatto"}, "n_points = 1: a lobatto rule has 2 to 51"),
        ({"coefficients": (0.03, 0.03, 3.0)}, "between 0 and 0.2"),
        ({"element": "shell9_mitc"}, "give shell4_mitc_plus or shell4_1pt"),
        ({"element": "shell4_mitc_plus", "hourglass": "viscous"}, "has no hourglass modes: leave out warping"),
        ({"warping": False}, 'warping = False: hourglass = "physical" includes the warping terms; .* give hourglass'),
    ],
)
def test_bad_options(options: dict[str, object], message: str) -> None:
    with pytest.raises(ExplicitError, match=message):
        ShellOptions(**options)  # type: ignore[arg-type]


def test_bad_orders() -> None:
    shells = build()
    with pytest.raises(ExplicitError, match="give letters of 'uvwpqr'"):
        shells.fix([0], "x")
    with pytest.raises(ExplicitError, match=r"velocity has shape \(6, 3\): it must be \(n_nodes, 6\)"):
        shells.velocity = np.zeros((6, 3))
    with pytest.raises(ExplicitError, match="force of node 4 is not a finite number"):
        shells.force = np.where(np.arange(36).reshape(6, 6) == 25, np.inf, 0.0)
    with pytest.raises(ExplicitError, match="target_step = -1"):
        shells.scale_mass(-1.0)


def test_a_step_beyond_the_stable_one_is_reported() -> None:
    shells = build()
    shells.velocity = np.random.default_rng(1).standard_normal((6, 6))
    shells.dt *= 3.0
    with pytest.raises(ExplicitError, match=r"has no finite position by cycle 2000 .*is too long"):
        shells.advance(2000)
