# SPDX-License-Identifier: Apache-2.0
"""The first crack of a steady extrusion: the mean damage of a neighbourhood hardly depends on the mesh, its peak does.

A bar of 10 mm is pushed through a cone of 20 degrees to 8.4 mm. On its axis the damage of Cockcroft and Latham ripples
with the mesh, which is made anew 46 to 112 times.
"""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.observe.damage import DamagePeaks
from presswork.process.begin import begin

RADIUS, LENGTH, BORE, BEARING = 5.0, 14.0, 4.2, 2.2


def extrude(across: int):
    """Return the recording of the extrusion at its end, with so many cells over the radius."""
    die = [[RADIUS, 34.0], [RADIUS, 0.0], {"to": [BORE, -BEARING], "radius": 0.5}, [BORE, -BEARING - 1.0],
           [BORE + 0.3, -BEARING - 2.0], [BORE + 0.3, -60.0]]  # fmt: skip
    case = Case(
        title="extrusion",
        analysis="axisymmetric",
        workpiece={
            "material": "steel",
            "mesh": {"size": [RADIUS, LENGTH], "cells": [across, round(across * LENGTH / RADIUS)]},
        },
        materials={
            "steel": {
                "young": 206e3,
                "poisson": 0.3,
                "hardening": {"law": "swift", "K": 700, "e0": 0.015, "n": 0.2},
                "damage": {"critical": 0.24},
            }
        },
        tools={
            "ram": {"profile": [[0, LENGTH], [RADIUS + 1, LENGTH]], "contact": "frictionless"},
            "die": {"profile": die, "contact": "shear", "m": 0.05},
        },
        boundary={"axis": {"set": "left", "fix": ["x"]}},
        stages=[{"name": "extrude", "tools": {"ram": {"stroke": 12.0, "direction": [0, -1]}}}],
        remesh={},
        output={"steps": 1},
    )
    recording = begin(build_model(case), 1)
    for _ in recording.advance():
        pass
    return recording


@pytest.mark.validation
def test_the_mean_that_decides_is_alike_on_three_meshes_and_no_ripple_is_a_crack():
    peaks, means = [], []
    for across in (6, 10, 16):
        run = extrude(across)
        (peak,) = run.observers.find(DamagePeaks).find(run)
        print(f"{across} cells: largest {peak.value:.4f}, mean {peak.mean.value:.4f} over {peak.mean.length:g} mm")
        peaks.append(peak.value)
        means.append(peak.mean.value)
        assert not peak.mean.is_beyond
        assert peak.mean.length == pytest.approx(1.0, rel=0.01), "a tenth of the bar"
    assert min(peaks) > 0.24, "single points pass the critical value on every mesh"
    assert min(means) > 0.21, "a critical value below the mean is passed on every mesh"
    assert np.ptp(means[1:]) < 0.04 * np.mean(means[1:]), "on 10 and 16 cells"
    assert means[0] > 0.9 * means[2], "on 6 cells the length of increments alone moves it from 0.219 to 0.222"
