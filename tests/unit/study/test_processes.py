# SPDX-License-Identifier: Apache-2.0
"""A process that dies is told as such, and the others go on."""

import pytest

from presswork import Case
from presswork.examples import copy_example
from presswork.study.member import Task
from presswork.study.processes import Ended, Pool, Started


@pytest.mark.parametrize("jobs", [1, 2])
def test_dead_process_is_told_with_its_last_words_and_the_others_go_on(tmp_path, jobs):
    case = Case.from_toml(copy_example("ring_compression", tmp_path), ["workpiece.mesh.cells=[2,1]", "output.steps=1"])
    tasks = {0: Task("no case", tmp_path / "a", "new"), 1: Task(case, tmp_path / "b", "new")}
    events = list(Pool(tasks, jobs).run())
    assert {e.member for e in events if isinstance(e, Started)} == {0, 1}
    ends = {e.member: e for e in events if isinstance(e, Ended)}
    assert ends[0].status == "failed"
    assert "TypeError: expected a case, not a str" in ends[0].reason
    assert ends[1].status == "completed"


def test_folder_that_cannot_be_written_is_told_by_the_member(tmp_path):
    case = Case.from_toml(copy_example("ring_compression", tmp_path), ["workpiece.mesh.cells=[2,1]"])
    (tmp_path / "b").write_text("")
    *_, end = Pool({0: Task(case, tmp_path / "b", "new")}, 1).run()
    assert isinstance(end, Ended)
    assert (end.status, "is a file" in end.reason) == ("failed", True)


def test_workpiece_that_nothing_holds_is_bad_input(tmp_path):
    away = ["tools.punch.profile=[[0,7],[60,7]]", "stages.0.tools.punch.stroke=2", "workpiece.mesh.cells=[2,1]"]
    case = Case.from_toml(copy_example("ring_compression", tmp_path), [*away, "boundary={}"])
    *_, end = Pool({0: Task(case, tmp_path / "b", "new")}, 1).run()
    assert isinstance(end, Ended)
    assert (end.status, "nothing holds" in end.reason) == ("bad_input", True)


def test_interrupted_pool_starts_nothing_more(tmp_path):
    case = Case.from_toml(copy_example("ring_compression", tmp_path))
    pool = Pool({i: Task(case, tmp_path / f"{i}", "new") for i in range(3)}, 1)
    events = []
    for event in pool.run():
        events.append(event)
        pool.interrupt()
    assert [e.status for e in events if isinstance(e, Ended)] == ["interrupted"]
