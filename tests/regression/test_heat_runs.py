# SPDX-License-Identifier: Apache-2.0
"""Heat alone from its case file to the picture: history, saved steps, balance, resume, threads."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.cli import app
from presswork.examples import copy_example
from presswork.results import Result
from presswork.view.all_plots import plot_all
from tests.regression.whole_runs import run_in_two_parts

OVERRIDES = ["workpiece.mesh.cells=[6,12]", "output.steps=2", "solver.tolerance=20", "output.checkpoint_every=3"]


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    folder = tmp_path_factory.mktemp("case")
    return build_model(read_case(copy_example("billet_cooling", folder), OVERRIDES))


def test_a_run_leaves_history_fields_and_pictures(model, tmp_path) -> None:
    outcome = run_model(model, tmp_path / "out", threads=1)
    result = outcome.result
    assert outcome.status == "completed", outcome.reason
    history = result.history
    assert list(dict.fromkeys(history["stage"])) == ["transfer", "rest on die", "quench"]
    assert history["time"][-1] == pytest.approx(60.0)
    assert (history["temperature_min"] <= history["temperature_mean"]).all()
    assert (history["temperature_mean"] <= history["temperature_max"]).all()
    incoming = sum(history[f"heat_{kind}"] for kind in ("prescribed", "flux", "convection", "radiation"))
    assert history["heat_stored"] == pytest.approx(incoming, rel=1e-8)
    assert result.summary["heat"]["balance_error"] < 1e-8
    nodal = result.field("nodal_temperature")
    assert nodal.min() == pytest.approx(history["temperature_min"][-1])
    assert result.field("temperature").shape == (72,)
    assert len(result.times) == 7
    names = {path.name for path in plot_all(result, tmp_path / "plots")}
    assert {"temperature_time.png", "contours_nodal_temperature_006.png"} <= names


def test_a_resumed_run_gives_the_same_bits(model, tmp_path) -> None:
    run_model(model, tmp_path / "whole", threads=1)

    def interrupt(progress) -> None:
        if progress.fraction > 0.3:
            raise KeyboardInterrupt

    assert run_model(model, tmp_path / "cut", threads=1, on_increment=interrupt).status == "interrupted"
    resumed = run_model(model, tmp_path / "cut", threads=1, resume=True)
    assert resumed.status == "completed"
    assert (tmp_path / "cut/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()
    fields = [run.field("nodal_temperature") for run in (resumed.result, Result(tmp_path / "whole"))]
    assert np.array_equal(*fields)


def test_two_threads_give_the_bits_of_one(model, tmp_path) -> None:
    for threads in (1, 2):
        run_model(model, tmp_path / str(threads), threads=threads)
    assert (tmp_path / "1/history.csv").read_bytes() == (tmp_path / "2/history.csv").read_bytes()


@pytest.mark.parametrize(("flux", "said"), [("1e6", "degrees C at"), ("-5e4", "-2")])
def test_a_run_gives_up_at_temperatures_of_no_forming(flux, said, tmp_path) -> None:
    path = copy_example("billet_cooling", tmp_path)
    film = f'stages.0.flux=[{{set="right",value={flux}}}]'
    outcome = run_model(build_model(read_case(path, [*OVERRIDES, film])), tmp_path / "out", threads=1)
    assert outcome.status == "gave_up"
    assert said in outcome.reason
    assert "temperature of no forming" in outcome.reason
    assert "Look at the fluxes" in outcome.reason


def test_temperatures_beyond_a_table_are_warned_of(tmp_path) -> None:
    path = copy_example("billet_cooling", tmp_path)
    short = "materials.C45.conductivity=[[20, 53.3], [800, 27.3]]"
    result = run_model(build_model(read_case(path, [*OVERRIDES, short])), tmp_path / "out", threads=1).result
    (warning,) = result.summary["warnings"]
    assert "C45: conductivity is given from 20 to 800 degrees C" in warning


def test_a_table_is_judged_by_the_temperatures_of_its_own_metal(tmp_path) -> None:
    """The ring of steel is at 1000 degrees C, beyond the table of its aluminium core, which stays below 450."""
    path = copy_example("bimetal_upsetting", tmp_path)
    small = ["workpiece.mesh.cells=[3,4]", "bodies.ring.mesh.cells=[2,4]", "remesh.enabled=false", "output.steps=1"]
    small += ["stages.0.tools.die.stroke=1", "stages.0.duration=0.03"]
    short = "materials.EN AW-6082.thermal.conductivity=[[20, 191.4], [360, 225]]"
    for keys, expected in (([], []), ([short], ["EN AW-6082: conductivity is given from 20 to 360 degrees C"])):
        outcome = run_model(build_model(read_case(path, [*small, *keys])), tmp_path / str(len(keys)), threads=1)
        found = outcome.result.summary["warnings"]
        assert len(found) == len(expected)
        assert all(one.startswith(said) for one, said in zip(found, expected, strict=True))
    assert 360.0 < float(found[0].split(" to ")[-1].split(":")[0]) < 450.0


def test_check_describes_the_case_in_words(tmp_path) -> None:
    from typer.testing import CliRunner

    path = copy_example("billet_cooling", tmp_path)
    found = CliRunner().invoke(app, ["check", str(path)])
    assert found.exit_code == 0, found.output
    for words in (
        "heat, axisymmetric",
        "latent heat 77 kJ/kg from 690 to 780",
        "workpiece 1200 °C",
        "radiation on right, emissivity 0.8, to 20 °C",
        "convection on bottom, 1000 W/(m2 K) to 150 °C",
    ):
        assert words in found.output


HOT = ["workpiece.mesh.cells=[4,6]", "workpiece.mesh.grading=[1,1]", "stages.0.tools.die.stroke=4", "output.steps=2"]


def test_hot_forming_leaves_temperatures_and_resumes_to_the_same_bits(tmp_path) -> None:
    model = build_model(read_case(copy_example("hot_upsetting", tmp_path), [*HOT, "output.checkpoint_every=5"]))
    whole = run_model(model, tmp_path / "whole", threads=1)
    assert whole.status == "completed", whole.reason
    history = whole.result.history
    incoming = sum(history[f"heat_{kind}"] for kind in ("plastic", "friction", "tools", "convection", "radiation"))
    assert history["heat_stored"] == pytest.approx(incoming, rel=1e-8)
    assert whole.result.summary["heat"]["balance_error"] < 1e-8
    assert history["temperature_min"][-1] < 1100 < history["temperature_mean"][-1] < 1200
    assert 250 < history["die.temperature_max"][-1] < 700
    assert (np.diff(history["die.temperature_max"]) > 0).all()
    nodal = whole.result.field("nodal_temperature")
    assert nodal[whole.result.points()[:, 1] < 1].min() > nodal[whole.result.points()[:, 1] > 25.9].max()
    names = {path.name for path in plot_all(whole.result, tmp_path / "plots")}
    assert {"temperature_time.png", "contours_nodal_temperature_002.png", "force_stroke.png"} <= names

    run_in_two_parts(model, tmp_path / "cut", lambda progress: progress.fraction > 0.5)
    assert (tmp_path / "cut/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()


def test_cold_dies_make_the_billet_harder(tmp_path) -> None:
    path = copy_example("hot_upsetting", tmp_path)
    force = {}
    for name, more in (("cold", []), ("insulated", ["tools.die.heat=", "heat.surroundings="])):
        outcome = run_model(build_model(read_case(path, [*HOT, *more])), tmp_path / name, threads=1)
        force[name] = outcome.result.history["die.force"][-1]
    assert force["cold"] > 1.02 * force["insulated"]


def test_heat_flows_while_nothing_moves(tmp_path) -> None:
    """Transfer, upset, dwell: the first loses heat to air alone; in the last the dies take it and the force stays."""
    path = copy_example("hot_upsetting", tmp_path)
    text = path.read_text()
    transfer = '[[stages]]\nname = "transfer"\nduration = 4\n\n'
    dwell = '[[stages]]\nname = "dwell"\nduration = 1\n\n[output]'
    path.write_text(text.replace("[[stages]]", transfer + "[[stages]]").replace("[output]", dwell))
    apart = "tools.die.profile=[[0, 31], [60, 31]]"
    upset = "stages.1.tools.die.stroke=3"
    quick = ["workpiece.mesh.cells=[4,6]", "workpiece.mesh.grading=[1,1]", "output.steps=1", apart, upset]
    outcome = run_model(build_model(read_case(path, quick)), tmp_path / "out", threads=1)
    assert outcome.status == "completed", outcome.reason
    history = outcome.result.history
    transfer_rows, dwell_rows = (history["stage"] == name for name in ("transfer", "dwell"))
    assert not history["heat_tools"][transfer_rows].any()
    assert not history["die.force"][transfer_rows].any()
    assert (history["heat_radiation"][transfer_rows] < 0).all()
    assert (np.diff(history["heat_tools"][dwell_rows]) < 0).all()
    assert history["die.force"][dwell_rows] == pytest.approx(history["die.force"][-1], rel=1e-3)
