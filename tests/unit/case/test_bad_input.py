# SPDX-License-Identifier: Apache-2.0
"""Bad input: each fault of a case is named by file, key, value, what was expected, and the remedy."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from presswork.case import Case, CaseError, build_model
from presswork.case.errors import Problem

Fail = Callable[..., str]

RECTANGLE = 'kind = "rectangle"\nsize = [10, 15]\ncells = [2, 3]\npattern = "crossed"'
HARDENING = 'law = "linear"\nyield_stress = 700\nmodulus = "0.3 kN/mm^2"'

FAULTS = {
    "negative_friction": (
        ('contact = "sticking"', 'contact = "coulomb"\nmu = -0.1'),
        ["tools.punch.mu = -0.1", "expected a value >= 0", "coefficient of friction"],
    ),
    "friction_factor_above_1": (
        ('contact = "sticking"', 'contact = "shear"\nm = 1.2'),
        ["tools.punch.m = 1.2", "<= 1", "friction factor"],
    ),
    "missing_friction_factor": (
        ('contact = "sticking"', 'contact = "shear"'),
        ["tools.punch.m: missing key", 'contact = "shear" needs m'],
    ),
    "friction_without_a_law": (
        ('contact = "sticking"', 'contact = "sticking"\nm = 0.1'),
        ["tools.punch.m", "no meaning", "remove it"],
    ),
    "unknown_key": (
        ('material = "steel"', 'material = "steel"\nmatrial = "iron"'),
        ["workpiece.matrial", '"iron"', "unknown key", "did you mean `material`?"],
    ),
    "key_of_another_table": (
        ('material = "steel"', 'material = "steel"\nmax_increment = 0.1'),
        ["workpiece.max_increment = 0.1", "unknown key", "it is a key of solver"],
    ),
    "key_without_a_name": (('material = "steel"', 'material = "steel"\n"" = 1'), ['workpiece."" = 1', "unknown key"]),
    "key_of_the_case_itself": (
        ('material = "steel"', 'material = "steel"\nprocedure = "explicit"'),
        ["workpiece.procedure", "it is a key of the case itself"],
    ),
    "material_of_the_library": (
        ('material = "steel"', 'material = "C45"'),
        ['workpiece.material = "C45"', "`c45` or `c45_hot`", "[materials] has steel", "presswork materials"],
    ),
    "whole_number_of_many_bits": (
        ("cells = [2, 3]", f"cells = [2, 0x{'f' * 100_000}]"),
        ["workpiece.mesh.cells.1: a whole number of 400000 bits", "write a smaller one"],
    ),
    "number_for_a_table": (
        ("[tools.punch]", "[presses]\npress = 3\n[tools.punch]"),
        ["presses.press = 3", "expected a table", "; "],
    ),
    "file_of_no_name": (
        ("profile = [[0, 15], [30, 15]]", 'profile_file = "a\\u0000.csv"'),
        ["tools.punch.profile_file", "no file can have this name", "check it"],
    ),
    "file_of_a_long_name": (
        ("profile = [[0, 15], [30, 15]]", f'profile_file = "{"a" * 300}.csv"'),
        ["tools.punch.profile_file", "no file can have this name", "check it"],
    ),
    "value_of_a_short_form": (
        ("size = [10, 15]\ncells = [2, 3]", 'zones_x = [[10, 2, 1]]\nzones_y = [[5, 1, 1], [10, 2, "x"]]'),
        ['workpiece.mesh.zones_y.1.2 = "x"', "expected a number", "write for instance 1"],
    ),
    "number_of_a_point": (
        ("profile = [[0, 15], [30, 15]]", 'profile = [[0, 15], [30, "x"]]'),
        ['tools.punch.profile.1.1 = "x"', "expected a length", "1 mm"],
    ),
    "many_tables": (
        ("[[stages]]", "".join(f"[tools.t{i}]\n" for i in range(30_000)) + "[[stages]]"),
        ["more than 5,000 tables", "in a file of their own"],
    ),
    "missing_key": (('material = "steel"', ""), ["workpiece.material: missing key", "name of one of the [materials]"]),
    "missing_material_key": (("poisson = 0.3", ""), ["materials.steel.poisson: missing key", "Poisson's ratio"]),
    "unknown_kind": (
        ('kind = "rectangle"', 'kind = "rectangel"'),
        ["workpiece.mesh.kind", '"rectangel"', "rectangle"],
    ),
    "too_many_cells": (("cells = [2, 3]", "cells = [2, 100000000]"), ["mesh.cells.1 = 100000000", "<= 100000"]),
    "unknown_choice": (
        ('"axisymmetric"', '"axisymetric"'),
        ['analysis = "axisymetric"', "did you mean `axisymmetric`?", "plane_strain"],
    ),
    "unknown_law": (
        ('law = "linear"', 'law = "linar"'),
        ['hardening.law = "linar"', "did you mean `linear`?", "swift"],
    ),
    "wrong_type": (("cells = [2, 3]", 'cells = [2, "many"]'), ["mesh.cells.1", '"many"', "expected a whole number"]),
    "table_expected": (
        ("[tools.punch]\nprofile = [[0, 15], [30, 15]]\ncontact", "[tools]\npunch = 3\n[tools.die]\ncontact"),
        ["tools.punch = 3", "expected a table"],
    ),
    "wrong_unit": (
        ("stroke = 9.0", 'stroke = "5 kg"'),
        ["stages.0.tools.punch.stroke", '"5 kg"', "expected a length", "`kg` has the dimension mass", '"1 mm"'],
    ),
    "unknown_unit": (
        ('"200 kN/mm^2"', '"200 kNN/mm^2"'),
        ["materials.steel.young", "unknown unit `kNN/mm^2`", '"200 kN/mm^2"'],
    ),
    "no_unit": (("stroke = 9.0", 'stroke = "9.0"'), ['stroke = "9.0"', "it has no unit", "a plain number in mm"]),
    "not_finite": (("poisson = 0.3", "poisson = nan"), ["materials.steel.poisson", "finite"]),
    "negative_young": (('"200 kN/mm^2"', "-200000"), ["materials.steel.young = -200000", "> 0", "Young's modulus"]),
    "negative_modulus": (
        ('modulus = "0.3 kN/mm^2"', "modulus = -300"),
        ["hardening.modulus = -300", "expected a value >= 0", "MPa"],
    ),
    "incompressible": (("poisson = 0.3", "poisson = 0.5"), ["materials.steel.poisson = 0.5", "expected a value < 0.5"]),
    "strain_in_per_cent": (
        (HARDENING, 'law = "table"\npoints = [[0, 700], [10, 800], [20, 900]]'),
        ["hardening.points", "reaches 20", "per cent", "divide the strains by 100"],
    ),
    "table_not_increasing": (
        (HARDENING, 'law = "table"\npoints = [[0, 700], [0.2, 800], [0.1, 900]]'),
        ["hardening.points", "[0.1, 900]", "does not increase in row 2 (0.1 after 0.2)", "sort the rows"],
    ),
    "table_not_from_zero": (
        (HARDENING, 'law = "table"\npoints = [[0.1, 700], [0.2, 800]]'),
        ["hardening.points", "not 0", "start with [0, yield stress]"],
    ),
    "table_softening": (
        (HARDENING, 'law = "table"\npoints = [[0, 700], [0.2, 600]]'),
        ["hardening.points", "stress decreases in row 1", "leave out"],
    ),
    "saturation_below_yield": (
        (HARDENING, 'law = "voce"\nyield_stress = 700\nsaturation_stress = 600\nrate = 3'),
        ["hardening.saturation_stress = 600", "below the yield stress", "at least 700 MPa"],
    ),
    "unknown_material": (
        ('material = "steel"', 'material = "stel"'),
        ['workpiece.material = "stel"', "no such material", "did you mean `steel`?"],
    ),
    "unknown_tool": (
        ("[stages.tools.punch]", "[stages.tools.punsh]"),
        ["stages.0.tools.punsh", "no such tool", "did you mean `punch`?"],
    ),
    "unknown_set": (
        ('set = "left"', 'set = "lefft"'),
        ['boundary.axis.set = "lefft"', "no such node set", "did you mean `left`?", "bottom"],
    ),
    "unknown_edge_set": (
        ("[stages.tools.punch]", '[[stages.pressure]]\nset = "all"\nvalue = 3\n[stages.tools.punch]'),
        ['stages.0.pressure.0.set = "all"', "no such edge set", "edge sets: bottom, boundary, left, right, top"],
    ),
    "no_profile": (
        ("profile = [[0, 15], [30, 15]]", ""),
        ["tools.punch.profile: missing key", "points [x, y], joined by lines"],
    ),
    "profile_of_one_point": (
        ("[[0, 15], [30, 15]]", "[[0, 15]]"),
        ["tools.punch.profile = [[0, 15]]", "at least 2 points", "[[0, 15], [30, 15]]"],
    ),
    "bad_profile_point": (
        ("[[0, 15], [30, 15]]", "[[0, 15], [30, 15, 2]]"),
        ["tools.punch.profile.1 = [30, 15, 2]", "expected [x, y]"],
    ),
    "radius_too_large": (
        ("[[0, 15], [30, 15]]", "[[0, 15], {to = [30, 15], radius = 40}, [30, 40]]"),
        ["tools.punch.profile.1", "too large", "at most 25 mm fits"],
    ),
    "pattern_does_not_fit": (
        ('pattern = "crossed"', 'pattern = "quad"'),
        ['workpiece.mesh.pattern = "quad"', "quadrilaterals", "element = tri3", "crossed, left, right"],
    ),
    "no_size": (("size = [10, 15]", ""), ["workpiece.mesh.size: missing key", "zones_x and zones_y"]),
    "zones_beside_size": (
        ("size = [10, 15]", "size = [10, 15]\nzones_y = [[15, 3, 1]]"),
        ["workpiece.mesh.size", "do not describe one mesh", "zones_x and zones_y"],
    ),
    "stage_moves_nothing": (
        ("stroke = 9.0", "stroke = 0.0"),
        ["stages.0", '"upset" moves nothing at all', "tools: punch"],
    ),
    "stroke_without_direction": (
        ("direction = [0, -1]", ""),
        ["stages.0.tools.punch.direction: missing key", "move = [x, y]"],
    ),
    "depth_of_axisymmetric": (
        ('analysis = "axisymmetric"', 'analysis = "axisymmetric"\ndepth = 3'),
        ["depth = 3", "no depth", "leave it out"],
    ),
    "negative_radius": (
        ("size = [10, 15]", "origin = [-1, 0]\nsize = [10, 15]"),
        ["workpiece.mesh", "x = -1 mm", "x >= 0"],
    ),
    "axis_free": (('fix = ["x"]', 'fix = ["y"]'), ["boundary", "axis of rotation", 'fix = ["x"]']),
    "no_symmetry_plane": (
        ('set = "bottom"', 'set = "right"\nsymmetry = true'),
        ["boundary.middle_plane.symmetry = true", "not a symmetry plane", "leave symmetry out"],
    ),
    "tool_inside_workpiece": (
        ("[[0, 15], [30, 15]]", "[[0, 14], [30, 14]]"),
        ["tools.punch.profile", "starts inside the workpiece", "1 mm at (", "move the tool by (0, 1) mm"],
    ),
    "profile_crosses_itself": (
        ("[[0, 15], [30, 15]]", "[[0, 15], [30, 15], [30, 25], [10, 12]]"),
        [
            "tools.punch.profile",
            "crosses or touches itself at (14.6154, 15)",
            "the piece that ends at point 1 and the piece that ends at point 3 meet there",
        ],
    ),
    "smooth_profile_swings_out": (
        ("profile = [[0, 15], [30, 15]]", 'curve = "spline"\nprofile = [[0, 15], [30, 15], [31, 15.1], [32, 15.3]]'),
        ["tools.punch.profile.1 = [30.0, 15.0]", "swings out by", "three or more make a straight piece", "polyline"],
    ),
    "tool_moves_away": (
        ("direction = [0, -1]", "direction = [0, 1]"),
        ["stages.0.tools.punch", "never reaches the workpiece", "turn it round"],
    ),
    "tool_stops_short": (
        ("[[0, 15], [30, 15]]", "[[0, 40], [30, 40]]"),
        [
            "stages.0.tools.punch",
            "never reaches the workpiece: it comes no nearer to a node than",
            "lengthen the stroke",
        ],
    ),
    "tool_beside_the_workpiece": (
        ("[[0, 15], [30, 15]]", "[[20, 30], [30, 30]]"),
        ["stages.0.tools.punch", "never reaches the workpiece"],
    ),
    "unknown_tool_moved": (
        ("[stages.tools.punch]", "[stages.tools.puncg]"),
        ["stages.0.tools.puncg", "no such tool", "did you mean `punch`?"],
    ),
    "friction_of_a_piece_without_a_law": (
        ("[[0, 15], [30, 15]]", "[[0, 15], {to = [30, 15], mu = 0.1}]"),
        ["tools.punch.profile.1.mu", "no meaning"],
    ),
    "friction_of_a_piece_above_1": (
        ("[[0, 15], [30, 15]]", "[[0, 15], {to = [30, 15], m = 1.5}]"),
        ["tools.punch.profile.1.m = 1.5", "<= 1"],
    ),
    "friction_where_no_piece_ends": (
        (
            'profile = [[0, 15], [30, 15]]\ncontact = "sticking"',
            'profile = [{to = [0, 15], mu = 0.1}, [30, 15]]\ncontact = "coulomb"\nmu = 0.2',
        ),
        ["tools.punch.profile.0", "no piece ends at the first point"],
    ),
    "side_unclear": (
        ("[[0, 15], [30, 15]]", "[[0, 7.5], [30, 7.5]]"),
        ['tools.punch.free_side = "auto"', "which side", '"left" or "right"'],
    ),
    "bad_mesh_unit": (
        (RECTANGLE, 'kind = "file"\npath = "a.msh"\nunit = "kg"'),
        ['workpiece.mesh.unit = "kg"', "expected a unit of length", "mm, m, inch"],
    ),
    "no_mesh_file": (
        (RECTANGLE, 'kind = "file"\npath = "a.msh"'),
        ['workpiece.mesh.path = "a.msh"', "no such file", "mesh files there"],
    ),
    "contradicting_increments": (
        ("[[stages]]", "[solver]\nmin_increment = 0.5\n[[stages]]"),
        ["solver.min_increment = 0.5", "larger than max_increment", "make it smaller"],
    ),
    "output_time_beyond_end": (
        ("[[stages]]", "[output]\nat = [0.5, 1.5]\n[[stages]]"),
        ["output.at.1 = 1.5", "expected a value <= 1"],
    ),
    "value_that_may_be_a_table": (
        ("[[stages]]", '[[stages]]\nvelocity = "fast"'),
        ['stages.0.velocity = "fast"', "expected a velocity"],
    ),
    "cell_of_a_table_that_may_be_a_value": (
        ("[[stages]]", '[[stages]]\nvelocity = [[0, 1], [5, "fast"]]'),
        ['stages.0.velocity.1.1 = "fast"', "expected a velocity"],
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_named_with_key_value_and_remedy(fault: str, fail_case: Fail) -> None:
    change, fragments = FAULTS[fault]
    message = fail_case(change)
    assert [fragment for fragment in fragments if fragment not in message] == [], message


def test_form_of_a_value_that_was_not_meant_has_no_problem(fail_case: Fail) -> None:
    for value in ('"fast"', '[[0, 1], [5, "fast"]]', "{a = 1}"):
        message = fail_case(("[[stages]]", f"[[stages]]\nvelocity = {value}"))
        assert "problems" not in message
        assert "function" not in message


def test_all_faults_of_a_file_are_listed_at_once(fail_case: Fail) -> None:
    message = fail_case(("poisson = 0.3", "poisson = 0.7"), ("cells = [2, 3]", "cels = [2, 3]"))
    assert "2 problems" in message
    assert "materials.steel.poisson" in message
    assert "did you mean `cells`?" in message


def test_faults_across_tables_are_listed_at_once(fail_case: Fail) -> None:
    message = fail_case(('material = "steel"', 'material = "x"'), ("[stages.tools.punch]", "[stages.tools.die]"))
    assert "workpiece.material" in message
    assert "stages.0.tools.die" in message


def test_toml_syntax_error_names_the_line(fail_case: Fail) -> None:
    message = fail_case(('material = "steel"', 'material = "steel'))
    assert "not valid TOML" in message
    assert "line 6" in message


def test_missing_case_file_suggests_the_nearest(write_case: Callable[..., Path], tmp_path: Path) -> None:
    write_case()
    with pytest.raises(CaseError, match=r"cse\.toml: no such case file; did you mean `.*case\.toml`\?"):
        Case.from_toml(tmp_path / "cse.toml")


def test_a_path_in_a_message_is_whole_however_long_and_a_list_is_cut() -> None:
    """The end of a path says most."""
    path = "/".join(["a_folder_with_a_long_name"] * 5) + "/blank.dxf"
    assert str(Problem("blank.path", "no such file", value=path)) == f'blank.path = "{path}": no such file'
    assert str(Problem("profile", "too many", value=list(range(100)))).endswith(" ...: too many")


def test_binary_case_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xff\xfe\x00title")
    with pytest.raises(CaseError, match="UTF-8"):
        Case.from_toml(path)


def test_folder_in_place_of_a_case_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="a folder, not a file"):
        Case.from_toml(tmp_path)


def test_fbar_with_the_small_strain_is_refused() -> None:
    """Its trace is not the change of volume: the limit load of Prandtl's punch fell to 0.86 of what it must be."""
    case = {
        "title": "bad",
        "analysis": "plane_strain",
        "workpiece": {
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "size": [1, 1], "cells": [1, 1]},
        },
        "materials": {"steel": {"young": 2e5, "poisson": 0, "hardening": {"law": "linear", "yield_stress": 200}}},
        "boundary": {"bottom": {"set": "bottom", "fix": ["x", "y"]}},
        "stages": [{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": 1}]}],
        "solver": {"strain_measure": "small"},
    }
    with pytest.raises(CaseError, match=r'strain_measure = "small".*F-bar.*take "log"'):
        build_model(Case(**case))
