# SPDX-License-Identifier: Apache-2.0
"""Laps on meshes that change."""

import pytest

from tests.regression.test_laps import check_rib

pytestmark = pytest.mark.validation


def test_a_rib_that_folds_onto_its_web_is_forged_and_marked_on_new_meshes(tmp_path):
    check_rib({}, tmp_path / "run")
