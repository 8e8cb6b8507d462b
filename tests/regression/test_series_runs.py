# SPDX-License-Identifier: Apache-2.0
"""Parts formed one after another between dies that conduct heat: history, fields, pictures, resume."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case import CaseError
from presswork.examples import copy_example
from presswork.results import Result
from presswork.view.all_plots import plot_all
from presswork.view.plots.interface_plot import plot_interface

QUICK = [
    "workpiece.mesh.cells=[4,4]",
    "workpiece.mesh.grading=[1,1]",
    "tools.die.heat.mesh.size=2",
    "series.parts=3",
    "stages.0.tools.die.stroke=3",
    "output.checkpoint_every=4",
]


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    return copy_example("die_series", tmp_path_factory.mktemp("case"))


@pytest.mark.validation
def test_dies_stay_warm_from_part_to_part_and_a_resumed_run_gives_the_same_bits(case, tmp_path) -> None:
    model = build_model(read_case(case, QUICK))
    whole = run_model(model, tmp_path / "whole", threads=1)
    assert whole.status == "completed", whole.reason
    history, summary = whole.result.history, whole.result.summary
    parts = history["part"]
    assert list(np.unique(parts)) == [1, 2, 3]
    assert (np.diff(history["time"]) > 0).all()
    assert history["time"][-1] == pytest.approx(3 * 1.2 + 2 * 6.8)
    peaks = summary["peaks_by_part"]["die.temperature_max"]
    assert peaks == [history["die.temperature_max"][parts == part].max() for part in (1, 2, 3)]
    assert 100 < peaks[0] < peaks[1] < peaks[2] < 1200
    assert peaks[2] - peaks[1] < 0.7 * (peaks[1] - peaks[0]), "towards a steady state"
    assert summary["increments"] == len(history["time"]), "of all parts"
    assert summary["work"] == f"3 parts, {summary['increments']} increments"
    assert summary["heat"]["balance_error"] < 1e-8
    assert summary["heat"]["dies"]["balance_error"] < 1e-8
    first = [history["temperature_max"][parts == part][0] for part in (1, 2, 3)]
    assert first == pytest.approx([1200] * 3, abs=5), "each workpiece is a fresh one"
    (place, cells, values) = whole.result.dies()["die"]
    assert len(place) == len(values)
    assert cells.max() < len(place)
    assert values.max() == pytest.approx(history["die.temperature_max"][-1], abs=0.01)
    assert place[:, 1].min() == pytest.approx(17.0), "the mesh goes along with the die"
    names = {path.name for path in plot_all(whole.result, tmp_path / "plots")}
    assert {"dies_006.png", "parts.png", "temperature_time.png"} <= names
    (curves,) = plot_interface(whole.result).legends
    assert [text.get_text().partition(":")[0] for text in curves.texts][-2:] == ["part 3", "part 3"]

    def interrupt(progress) -> None:
        if progress.fraction > 0.5:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "cut", threads=1, on_increment=interrupt).status == "interrupted"
    assert run_model(model, tmp_path / "cut", threads=2, resume=True).status == "completed"
    assert (tmp_path / "cut/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()
    dies = [run.dies()["die"][2] for run in (whole.result, Result(tmp_path / "cut"))]
    assert np.array_equal(*dies)


@pytest.mark.validation
def test_a_longer_pause_leaves_the_dies_colder(case, tmp_path) -> None:
    peaks = []
    for pause in (2, 60):
        model = build_model(read_case(case, [*QUICK, "series.parts=2", f"series.pause={pause}"]))
        peaks.append(run_model(model, tmp_path / str(pause), threads=1).result.summary["peaks_by_part"])
    short, long = (found["die.temperature_max"] for found in peaks)
    assert short[0] == long[0]
    assert long[0] < long[1] + 1 < short[1]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (["tools.die.heat.mesh=", "tools.die.heat.back_temperature="], "no tool takes heat from part to part"),
        (["tools.die.heat.mesh=", "tools.die.heat.back_temperature=", "tools.die.heat.warms_up=true"], "leaves with"),
        (["tools.die.heat.mesh={size=1}"], "the profile is open"),
        (["tools.die.heat.mesh={size=1,corners=[[40,60],[-5,60]]}"], "beyond the axis"),
        (["tools.die.heat.warms_up=true"], "a tool with a mesh warms up anyway"),
        (["tools.die.heat.conductivity=", "tools.die.heat.specific_heat=", "tools.die.heat.density="], "needs a steel"),
        (["series.parts=1"], "parts"),
    ],
)
def test_bad_input_is_told(case, change, said) -> None:
    with pytest.raises(CaseError, match=said):
        build_model(read_case(case, [*QUICK, *change]))
