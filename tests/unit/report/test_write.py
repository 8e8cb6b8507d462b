# SPDX-License-Identifier: Apache-2.0
"""The page as a file: everything in it, of the size asked for, and text of a case stays text."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork import read_case, run
from presswork.cli import app
from presswork.examples import copy_example
from presswork.report import write_report
from presswork.report.case_data import list_defaults
from presswork.report.choose import choose
from presswork.results import Result, reader
from tests.unit.report.unpack import unpack
from tests.unit.results.upset_output import write_upset_output


def read_page(path: Path) -> tuple[dict, list[str]]:
    """Return header and blocks of a page."""
    text = path.read_text("utf-8")
    header = re.search(r'id="header">(.*?)</script>', text, re.DOTALL)
    assert header
    return json.loads(header[1]), re.findall(r'id="block-\d+">(.*?)</script>', text)


def test_page_holds_fields_and_places_of_all_steps(tmp_path: Path) -> None:
    result = Result(write_upset_output(tmp_path / "upset"))
    (run,), blocks = (lambda found: (found[0]["runs"], found[1]))(read_page(write_report(result)))
    assert [step["saved"] for step in run["steps"]] == list(range(len(result.times)))
    for number, step in enumerate(run["steps"]):
        reach = np.ptp(result.points(number), axis=0).max()
        np.testing.assert_allclose(unpack(step["points"], blocks), result.points(number), atol=reach / 65534)
        for field, packed in zip(run["fields"], step["fields"], strict=True):
            values = result.scalar(field["name"], number)
            np.testing.assert_allclose(unpack(packed, blocks)[:, 0], values, atol=np.ptp(values) / 65534 + 1e-12)
            assert field["range"][0] <= values.min() <= values.max() <= field["range"][1]
    force = next(column for column in run["history"]["columns"] if column["name"] == "die.force")
    np.testing.assert_allclose(unpack(force["values"], blocks), 1e-3 * result.history["die.force"], rtol=1e-6)
    assert force["unit"] == "kN"
    assert run["history"]["curves"] == [["die.stroke", "die.force"]]


@pytest.mark.parametrize("placing", ["", "press"])
def test_a_page_of_four_times_the_steps_reads_the_history_once_and_four_times_the_places(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, placing: str
) -> None:
    calls = {"history": 0, "places": 0}

    def count(name: str, call):
        def counted(*arguments):
            calls[name] += 1
            return call(*arguments)

        return counted

    monkeypatch.setattr(reader, "read_history", count("history", reader.read_history))
    monkeypatch.setattr(Result, "tool_pose", count("places", Result.tool_pose))
    places = []
    for steps in (10, 40):
        calls.update(history=0, places=0)
        result = Result(write_upset_output(tmp_path / f"of_{steps}", steps=steps))
        result.__dict__["info"] = {**result.info, "placing": placing}
        write_report(result)
        assert calls["history"] == 1
        places.append(calls["places"])
    assert places[1] <= 4 * places[0]


def test_first_field_is_the_one_that_pictures_show_first(tmp_path: Path) -> None:
    (run,) = read_page(write_report(Result(write_upset_output(tmp_path / "upset"))))[0]["runs"]
    first = run["fields"][0]
    assert (first["name"], first["label"], first["unit"]) == ("effective_stress", "effective stress", "MPa")


def test_heat_alone_is_no_plane_strain(tmp_path: Path) -> None:
    path = copy_example("billet_cooling", tmp_path)
    quick = ["workpiece.mesh.cells=[3,6]", "solver.tolerance=100", "output.steps=1", 'geometry="plane"']
    outcome = run(read_case(path, quick), tmp_path / "out", threads=1)
    (page,) = read_page(write_report(outcome.result))[0]["runs"]
    assert page["analysis"] == "heat, plane"


def test_steps_are_thinned_to_the_budget_and_the_page_says_so(tmp_path: Path) -> None:
    result = Result(write_upset_output(tmp_path / "upset", n=20, steps=40))
    path = write_report(result, tmp_path / "small.html", budget=1_150_000)
    (run,) = read_page(path)[0]["runs"]
    assert path.stat().st_size < 1_150_000
    saved = [step["saved"] for step in run["steps"]]
    assert 2 < len(saved) < 40
    assert (saved[0], saved[-1]) == (0, 39)
    assert f"{len(saved)} of 40 saved steps are here" in run["notes"][0]


def test_fields_are_left_out_rather_than_most_steps(tmp_path: Path) -> None:
    result = Result(write_upset_output(tmp_path / "upset", n=20, steps=30))
    whole, cut = choose(result, 10_000_000), choose(result, 100_000)
    assert len(whole.steps) == 30
    assert not whole.notes
    assert len(cut.fields) < len(whole.fields)
    assert cut.fields == whole.fields[: len(cut.fields)]
    assert len(cut.steps) >= 10
    assert whole.fields[-1].name in cut.notes[-1]


def test_a_script_in_a_title_or_case_stays_text(tmp_path: Path) -> None:
    folder = write_upset_output(tmp_path / "upset")
    attack = "</script><script>alert(1)</script><!--"
    (folder / "case.toml").write_text(f'title = "{attack}"', encoding="utf-8")
    text = write_report(Result(folder)).read_text("utf-8")
    assert "alert(1)" in text
    assert "<script>alert" not in text
    assert "</script><script>" not in text.replace("</script>\n<script", "")


def test_page_names_no_address(tmp_path: Path) -> None:
    text = write_report(Result(write_upset_output(tmp_path / "upset"))).read_text("utf-8")
    assert not re.findall(r"""(?:src|href)\s*=|url\(|@import""", re.sub(r">[A-Za-z0-9+/=]{200,}<", "><", text))
    assert "default-src 'none'" in text


def test_defaults_are_what_the_case_does_not_say(tmp_path: Path) -> None:
    case = copy_example("upsetting_q4", tmp_path)
    found = dict(list_defaults(case))
    assert found["materials.steel.yield_function.law"] == '"von_mises"'
    assert "materials.steel.young" not in found, "the case says it"
    assert found["procedure"] == '"implicit"'
    case.write_text("title = 'broken'", encoding="utf-8")
    assert list_defaults(case) == []


def test_command_writes_the_page_beside_the_results(tmp_path: Path) -> None:
    folder = write_upset_output(tmp_path / "upset")
    found = CliRunner().invoke(app, ["report", str(folder)])
    assert found.exit_code == 0, found.output
    assert (folder / "report.html").is_file()
    missing = CliRunner().invoke(app, ["report", str(tmp_path / "none")])
    assert missing.exit_code == 2
    assert "there is no folder" in missing.output


def test_several_runs_share_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folders = [write_upset_output(tmp_path / name, n=n) for name, n in (("coarse", 4), ("fine", 8))]
    monkeypatch.chdir(tmp_path)
    found = CliRunner().invoke(app, ["report", *map(str, folders)])
    assert found.exit_code == 0, found.output
    runs = read_page(tmp_path / "comparison" / "report.html")[0]["runs"]
    assert [run["name"] for run in runs] == ["coarse", "fine"]


@pytest.mark.parametrize("wanted", [True, False])
def test_a_run_leaves_its_page_unless_it_is_refused(tmp_path: Path, wanted: bool) -> None:
    case = copy_example("upsetting_q4", tmp_path)
    options = ["--set", "workpiece.mesh.cells=[2,2]", "--no-plot", "--quiet", *([] if wanted else ["--no-report"])]
    found = CliRunner().invoke(app, ["run", str(case), *options])
    assert found.exit_code == 0, found.output
    assert (tmp_path / "upsetting_q4" / "report.html").is_file() is wanted
