# SPDX-License-Identifier: Apache-2.0
"""Return mapping of friction: what the law allows is never exceeded, and the direction stays."""

import numpy as np
import pytest

from presswork.interaction.coulomb import return_to_limit

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("components", [2, 3])
def test_friction_is_shortened_to_its_limit_and_keeps_its_direction(components: int) -> None:
    trial, limit = RNG.standard_normal((200, components)), RNG.uniform(0.2, 3.0, 200)
    found = return_to_limit(trial, limit)
    size = np.linalg.norm(trial, axis=1)
    assert found.slides.any()
    assert not found.slides.all()
    np.testing.assert_array_equal(found.slides, size > limit)
    np.testing.assert_allclose(np.linalg.norm(found.force, axis=1), np.minimum(size, limit), rtol=1e-14)
    np.testing.assert_allclose(found.force * size[:, None], trial * np.minimum(size, limit)[:, None], rtol=1e-13)
    np.testing.assert_array_equal(found.force[~found.slides], trial[~found.slides])


def test_friction_along_a_line_is_that_of_one_component() -> None:
    trial, limit = RNG.standard_normal(200), RNG.uniform(0.2, 3.0, 200)
    along, in_space = return_to_limit(trial, limit), return_to_limit(trial[:, None], limit)
    np.testing.assert_array_equal(along.force, np.clip(trial, -limit, limit))
    np.testing.assert_allclose(along.force, in_space.force[:, 0], rtol=1e-15)
    np.testing.assert_array_equal(along.along[along.slides], np.sign(trial[along.slides]))


def test_no_friction_without_a_push_and_none_lost_at_no_limit() -> None:
    trial = np.array([-2.0, 0.0, 3.0])
    np.testing.assert_array_equal(return_to_limit(trial, np.zeros(3)).force, 0.0 * trial)
    np.testing.assert_array_equal(return_to_limit(trial, np.full(3, np.inf)).force, trial)
