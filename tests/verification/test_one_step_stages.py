# SPDX-License-Identifier: Apache-2.0
"""The blank by way of raised parts. Its truth is validation/test_inverse_of_cup.py; here, what must hold of any cup."""

from dataclasses import replace

import numpy as np
import pytest

from presswork.case.onestep.schema import OneStepCase
from presswork.onestep import solve_one_step
from tests.problems.one_step import cup_profile, fan, make_model, revolve

AROUND = 24


def deep_cup(size: float = 2.5, **process):
    points, quads = revolve(cup_profile(25.0, 5.0, 26.0, 34.0, size), AROUND)
    return make_model(points, fan(AROUND), quads, layers=3, holder_force=15e3, mu=0.1, **process)


@pytest.fixture(scope="module")
def found():
    return {stages: solve_one_step(deep_cup(stages=stages)) for stages in (1, 3)}


def test_a_round_cup_stays_round(found):
    """Neither the order in which raised parts are solved nor carrying the metal over them brings in a direction."""
    radii = np.linalg.norm(found[3].blank - found[3].blank[0], axis=1)[1:].reshape(-1, AROUND)
    assert np.ptp(radii, axis=1).max() < 1e-3 * radii.max()
    assert not found[3].notes
    assert found[3].iterations > found[1].iterations
    assert len(found[3].residuals) == found[3].iterations


def test_one_step_of_a_deep_cup_tells_of_stages(found):
    assert "--stages 3" in found[1].notes[0]
    assert [result.stages for result in found.values()] == [1, 3]
    points, quads = revolve(cup_profile(25.0, 5.0, 14.0, 34.0, 2.5), AROUND)
    shallow = make_model(points, fan(AROUND), quads, layers=3, holder_force=15e3, mu=0.1)
    assert not solve_one_step(shallow).notes


def test_the_wall_keeps_the_stretch_that_the_flange_gave_it(found):
    """As metal left a flange that was wider, its pull was larger than at the end: the upper wall comes out longer."""
    one, three = (
        result.fields["major_strain_middle"][AROUND:].reshape(-1, AROUND).mean(axis=1) for result in found.values()
    )
    z = found[1].model.points[1:, 2].reshape(-1, AROUND)[:, 0]
    rise = (z - z.min()) / np.ptp(z)
    upper = (rise[1:] > 0.5) & (rise[1:] < 0.8) & (rise[:-1] > 0.5)
    assert ((three - one)[upper] > 0.0).all()
    # metal that was formed on a bent path is harder than its strains say
    hardened = [result.fields["equivalent_plastic_strain"] for result in found.values()]
    assert hardened[1].mean() > hardened[0].mean()


def test_the_same_bits_again(found):
    again = solve_one_step(deep_cup(stages=3))
    assert (again.blank == found[3].blank).all()
    assert all((again.fields[name] == values).all() for name, values in found[3].fields.items())


def test_a_part_without_walls_is_found_by_one_step_and_says_so():
    points, quads = revolve(cup_profile(25.0, 5.0, 11.0, 36.0, 2.5), AROUND)
    model = make_model(points, fan(AROUND), quads, layers=3)
    one, three = solve_one_step(model), solve_one_step(replace(model, stages=3))
    assert (one.blank == three.blank).all()
    assert "no wall" in three.notes[0]
    assert three.stages == 1


@pytest.mark.parametrize("stages", [0, 10, 2.5])
def test_stages_out_of_range_are_refused(stages):
    data = {"title": "t", "analysis": "onestep", "part": {"path": "part.stl"}, "process": {"stages": stages},
            "blank": {"material": "dc04", "thickness": 0.8}}  # fmt: skip
    with pytest.raises(Exception, match=r"process\.stages"):
        OneStepCase.from_data(data)
