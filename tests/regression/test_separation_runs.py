# SPDX-License-Identifier: Apache-2.0
"""A strip that is cropped: cracks from both edges meet, the strip parts, and the press is free again."""

import re

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.process.begin import begin
from presswork.process.explicit.forming import ExplicitForming
from presswork.process.explicit.separation import CrackGrowth
from presswork.recorder import run_model
from presswork.results import Result
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts

UTS = 690.0  # of Swift's law below [MPa]
STEEL = {
    "young": "206 GPa", "poisson": 0.3, "density": "7850 kg/m^3",
    "hardening": {"law": "swift", "K": 1275.9, "e0": 0.002, "n": 0.2655},
    "damage": {
        "criterion": "modified_mohr_coulomb", "A": 1275.9, "n": 0.2655, "c1": 0.12, "c2": 720, "c3": 1.095,
        "length": 0.16,
    },
}  # fmt: skip


def cropping(rows=80, stroke=0.85, **changes):
    """A strip of 2 mm cut with a clearance of 10 %; its left end is a plane of symmetry."""
    touch = {"contact": "coulomb", "mu": 0.1}
    blade = [[-1, 2], {"to": [3, 2], "radius": 0.15}, [3, 8]]
    bed = [[3.2, -8], {"to": [3.2, 0], "radius": 0.15}, [8, 0]]
    case = {
        "title": "cropping",
        "analysis": "plane_strain",
        "procedure": "explicit",
        "workpiece": {"material": "steel", "element": "quad4_1pt", "mesh": {"size": [6, 2], "cells": [24, 8]}},
        "materials": {"steel": STEEL},
        "tools": {
            "blade": {"profile": blade, **touch},
            "bed": {"profile": bed, **touch},
            "clamp": {"profile": [[8, 2], [3.4, 2], [3.4, 5]], **touch},
        },
        "boundary": {"middle": {"set": "left", "fix": ["x"]}},
        "stages": [
            {"name": "crop", "duration": "0.14 ms", "tools": {"blade": {"stroke": stroke, "direction": [0, -1]}}}
        ],
        "separation": {},
        "remesh": {"size": 0.4, "smallest_size": 0.06, "windows": [{"box": [2.8, -1, 3.4, 2], "size": 0.1}]},
        "explicit": {"target_step": 2.5e-8},
        "output": {"rows": rows, "steps": 2},
    }
    return Case(**{name: value for name, value in (case | changes).items() if value is not None})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cropping") / "run"
    assert run_model(build_model(cropping()), folder, threads=1).status == "completed"
    return folder


@pytest.fixture(scope="module")
def cropped(folder):
    return Result(folder)


def test_the_strip_parts_and_the_blade_is_free(cropped):
    history, found = cropped.history, cropped.summary["separation"]
    force, stroke = history["blade.force"], history["blade.stroke"]
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(stroke))])
    assert found["pieces"] == history["pieces"][-1] == 2
    assert found["cracks"] == history["cracks"][-1] == 2
    assert 0.3 < found["first_crack"]["stroke_mm"] < found["parted"]["stroke_mm"] < 0.85
    assert force.max() == pytest.approx(2 * 0.8 * UTS * 2.0, rel=0.1)  # the rule of thumb, per mm of both halves
    assert force[-1] < 0.05 * force.max()
    assert found["largest_force_N"] == pytest.approx(force.max(), rel=0.01)
    parted = found["parted"]["stroke_mm"]
    assert 1e3 * found["work_J"] == pytest.approx(np.interp(parted, stroke, summed), rel=0.05)
    assert np.isfinite(force).all()


def test_the_volume_is_kept_over_the_separation(folder, cropped):
    """But for the elastic part, on every mesh."""
    volumes = re.findall(r"volume ([+-][0-9.e-]+) of the first", (folder / "run.log").read_text("utf-8"))
    assert len(volumes) > 5
    assert max(abs(float(volume)) for volume in volumes) < 1e-4
    assert abs(cropped.history["energy_error_percent"]).max() < 3.0


def test_edges_have_the_zones_of_a_cut(cropped):
    edges = {edge["piece"]: edge for edge in cropped.summary["separation"]["edges"]}
    assert set(edges) == {"sheet", "slug"}
    for edge in edges.values():
        zones = [edge[f"{zone}_mm"] for zone in ("rollover", "sheared", "fracture")]
        assert sum(zones) == pytest.approx(edge["thickness_mm"], rel=1e-9)
        assert edge["thickness_mm"] == pytest.approx(2.0, rel=0.05)
        assert 0.05 < zones[0] / 2.0 < 0.35
        assert 0.4 < zones[2] / 2.0 < 0.9
        assert 0.0 <= edge["burr_mm"] < 0.2


def test_a_stopped_cropping_goes_on_with_the_same_bits(folder, tmp_path):
    run_in_two_parts(build_model(cropping()), tmp_path / "run", 66)
    assert_same_bits(tmp_path / "run", folder)


def test_without_separation_the_crack_is_reported_and_not_cut():
    recording = begin(build_model(cropping(separation=None, rows=8)), 1)
    assert isinstance(recording, ExplicitForming)
    assert "cracks" not in recording.columns
    assert not any(isinstance(change, CrackGrowth) for change in recording.mesh_changes)
