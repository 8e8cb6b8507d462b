# SPDX-License-Identifier: Apache-2.0
"""What is packed comes back, to the precision that is promised."""

import numpy as np
import pytest

from presswork.report.pack import LEVELS, Blocks
from tests.unit.report.unpack import unpack


@pytest.mark.parametrize("shape", [(1,), (1000,), (500, 2), (500, 3)])
def test_values_come_back_within_half_a_level_of_their_range(shape: tuple[int, ...]) -> None:
    values = np.random.default_rng(1).normal(size=shape) * 700.0
    blocks = Blocks()
    packed = blocks.add_values(values)
    found = unpack(packed, blocks.texts).reshape(shape)
    limit = 0.5001 * np.ptp(values, axis=0) / LEVELS
    assert (np.abs(found - values) <= limit + 1e-12).all()
    assert packed["lo"] == pytest.approx(np.atleast_1d(values.min(axis=0)).tolist())


def test_smallest_and_largest_value_come_back_exactly() -> None:
    values = np.array([3.1, -12345.678, 9.87e5, 0.0])
    blocks = Blocks()
    found = unpack(blocks.add_values(values), blocks.texts)[:, 0]
    assert (found[1], found[2]) == (values[1], pytest.approx(values[2], rel=1e-15))


def test_values_that_are_not_finite_are_marked() -> None:
    values = np.array([1.0, np.nan, 2.0, np.inf])
    blocks = Blocks()
    found = unpack(blocks.add_values(values), blocks.texts)[:, 0]
    np.testing.assert_array_equal(np.isfinite(found), [True, False, True, False])
    nothing = blocks.add_values(np.full(3, np.nan))
    assert nothing["lo"] == nothing["hi"] == [0.0]
    assert np.isnan(unpack(nothing, blocks.texts)).all()


def test_a_constant_field_stays_constant() -> None:
    blocks = Blocks()
    np.testing.assert_array_equal(unpack(blocks.add_values(np.full(7, 273.15)), blocks.texts)[:, 0], 273.15)


def test_numbers_of_zones_come_back_exactly() -> None:
    zones = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 3.0])
    blocks = Blocks()
    np.testing.assert_array_equal(unpack(blocks.add_values(zones), blocks.texts)[:, 0], zones)


def test_indices_come_back_exactly() -> None:
    indices = np.random.default_rng(2).integers(0, 2**31 - 1, size=(300, 3))
    blocks = Blocks()
    np.testing.assert_array_equal(unpack(blocks.add_indices(indices), blocks.texts), indices.ravel())


def test_numbers_come_back_in_single_precision() -> None:
    numbers = np.linspace(-1e6, 1e6, 999)
    blocks = Blocks()
    np.testing.assert_array_equal(unpack(blocks.add_numbers(numbers), blocks.texts), numbers.astype(np.float32))


def test_a_smooth_field_takes_less_than_its_sixteen_bits() -> None:
    x, y = np.meshgrid(np.linspace(0, 1, 300), np.linspace(0, 1, 300))
    blocks = Blocks()
    blocks.add_values(np.sin(3 * x + y).ravel())
    assert blocks.count_bytes() < 0.75 * 2 * x.size
