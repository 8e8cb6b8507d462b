# SPDX-License-Identifier: Apache-2.0
"""What `--vary` means, and what it refuses."""

import numpy as np
import pytest

from presswork import CaseError
from presswork.examples import copy_example
from presswork.study import parse_variation, run_sweep
from presswork.study.vary import format_override, make_members, multiply_out


@pytest.mark.parametrize(
    ("text", "key", "values"),
    [
        ("tools.punch.m=0:0.5:6", "tools.punch.m", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]),
        ("workpiece.mesh.cells.0=5:20:4", "workpiece.mesh.cells.0", [5, 10, 15, 20]),
        ("a=1:2:3", "a", [1.0, 1.5, 2.0]),
        ("a = 1e-4 : 1e-3 : 2", "a", [1e-4, 1e-3]),
        ("a=1,2.5,3", "a", [1, 2.5, 3]),
        ("a=[4,4],[8,8]", "a", [[4, 4], [8, 8]]),
        ("workpiece.element=tri3,quad4_fbar", "workpiece.element", ["tri3", "quad4_fbar"]),
        ('a="x,y",z', "a", ['"x', 'y"', "z"]),
        ("a=1 mm,2 mm", "a", ["1 mm", "2 mm"]),
        ("a=true,false", "a", [True, False]),
        ("a=7", "a", [7]),
    ],
)
def test_vary_reads_ranges_and_lists(text, key, values):
    found_key, found = parse_variation(text)
    assert found_key == key
    assert found == values
    assert [type(value) for value in found] == [type(value) for value in values]


@pytest.mark.parametrize("text", ["m", "=1,2", "m=", "m=0:1:1", "m=1:1:3", "m=0:1:x", "m=0:1:0", "m=0:1:99999999"])
def test_vary_refuses_what_varies_nothing(text):
    with pytest.raises(CaseError):
        parse_variation(text)


def test_product_has_every_combination_with_the_last_key_fastest():
    assert multiply_out({"a": [1, 2], "b": ["x", "y"]}) == [
        {"a": 1, "b": "x"},
        {"a": 1, "b": "y"},
        {"a": 2, "b": "x"},
        {"a": 2, "b": "y"},
    ]


@pytest.mark.parametrize("vary", [{}, {"a": []}, {"a": [1, 1]}, {"a": range(101), "b": range(100)}])
def test_product_refuses_nothing_repeats_and_floods(vary):
    with pytest.raises(CaseError):
        multiply_out(vary)


def test_override_says_any_value_of_a_case_in_toml():
    table = {"profile": [[0, 6], [60, 6]], "contact": "shear", "m": np.float64(0.1)}
    assert format_override("t", table) == 't={"profile" = [[0, 6], [60, 6]], "contact" = "shear", "m" = 0.1}'
    with pytest.raises(CaseError):
        format_override("t", float("nan"))


def test_members_with_bad_input_are_kept_beside_the_good_ones(tmp_path):
    case = copy_example("ring_compression", tmp_path)
    good, bad = make_members(case, [({}, ["tools.punch.m=0.1"]), ({}, ["tools.punch.m=2"])], [])
    assert good.case is not None
    assert bad.case is None
    assert "expected a value <= 1" in bad.fault


def test_sweep_is_refused_when_no_member_can_be_computed(tmp_path):
    case = copy_example("ring_compression", tmp_path)
    with pytest.raises(CaseError, match="punsh"):
        run_sweep(case, {"tools.punsh.m": [0.1, 0.2]}, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_sweep_refuses_a_key_that_is_set_and_varied(tmp_path):
    case = copy_example("ring_compression", tmp_path)
    with pytest.raises(CaseError, match="both set and varied"):
        run_sweep(case, {"tools.punch.m": [0.1, 0.2]}, tmp_path / "out", settings=["tools.punch.m=0.3"])
