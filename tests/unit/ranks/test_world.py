# SPDX-License-Identifier: Apache-2.0
"""What ranks do together: rank 0 makes something for all."""

import pickle

import pytest

from presswork.mesh.checks import MeshError
from tests.problems.rank_threads import on_ranks


def test_all_ranks_get_what_rank_0_alone_makes():
    made = []

    def make():
        made.append(0)
        return {"cells": 7}

    assert on_ranks(3, lambda world: world.share(make, MeshError)) == [{"cells": 7}] * 3
    assert made == [0]


def test_all_ranks_raise_the_error_of_rank_0():
    def make():
        raise MeshError("the boundary folds", "another shape")

    def tell(world):
        with pytest.raises(MeshError, match="the boundary folds; another shape") as found:
            world.share(make, MeshError)
        return found.value.remedy

    assert on_ranks(2, tell) == ["another shape"] * 2


def test_an_error_of_a_mesh_passes_from_process_to_process():
    error = pickle.loads(pickle.dumps(MeshError("the boundary folds", "another shape")))
    assert (error.fault, error.remedy) == ("the boundary folds", "another shape")
