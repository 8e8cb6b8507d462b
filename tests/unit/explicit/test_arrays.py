# SPDX-License-Identifier: Apache-2.0
"""The State of explicit runs: arrays of a loop by owner and name, and back."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.explicit.arrays import LayerArrays, MotionArrays, SolidArrays, to_loop, to_state

LOOP = {
    "loop": {"work": np.arange(4.0)},
    "nodes": {"position": np.ones((5, 3)), "velocity": np.ones((5, 6)), "internal_force": np.zeros((5, 6))},
    "block_0": {"mass": np.ones(2), "shell": np.ones((2, 9)), "layers": np.ones((2, 1, 5, 4))},
    "block_1": {"mass_factor": np.ones(1), "points": np.full((1, 8, 7), 2.0), "work": np.ones((1, 1))},
    "block_2": {
        "mass_factor": np.ones(3), "points": np.full((3, 1, 7), 3.0), "work": np.ones((3, 2)),
        "hourglass": np.ones((3, 12)), "damage_damage_freudenthal": np.ones((3, 1)),
    },
    "wall_10": {"offset": np.full(2, 10.0), "impulse": np.ones(2), "force": np.ones((5, 2))},
    "wall_9": {"offset": np.full(2, 9.0), "impulse": np.ones(2), "force": np.ones((5, 2))},
    "run": {"clock": np.ones(4), "energy": np.ones(2), "scales": np.ones(3), "temperature": np.zeros(0)},
}  # fmt: skip


def test_arrays_of_a_loop_have_owners_names_and_numbers() -> None:
    state = to_state(LOOP)
    assert state[MotionArrays].position is LOOP["nodes"]["position"]
    assert len(state[LayerArrays].layers) == 1
    solids = state[SolidArrays]
    assert [of.shape for of in solids.points] == [(1, 8, 7), (3, 1, 7)]
    assert [of.size for of in solids.hourglass] == [0, 36]
    assert [len(of) for of in solids.damage["damage_freudenthal"]] == [0, 3]
    arrays = state.to_arrays()
    assert [arrays[f"profiles.offset.{i}"][0] for i in (0, 1)] == [9.0, 10.0]


def test_a_loop_gets_back_what_it_gave() -> None:
    """Walls are numbered anew from 0, in their order; what has no numbers is left out."""
    given = {name: of for name, of in LOOP.items() if not name.startswith("wall")}
    found = to_loop(to_state(given).to_arrays() | {"heat.temperature": np.ones(3)})
    assert set(found) == set(given)
    for owner, arrays in given.items():
        assert set(found[owner]) == {name for name, values in arrays.items() if values.size}
        for name, values in found[owner].items():
            assert np.array_equal(values, arrays[name])


def test_an_array_that_nobody_declares_is_an_error() -> None:
    with pytest.raises(KeyError, match="no owner declares nodes: colour, position"):
        to_state({"nodes": {"position": np.ones((5, 2)), "colour": np.ones(5)}})
