# SPDX-License-Identifier: Apache-2.0
"""A process that dies is told as such, and the others go on."""

import pickle

import pytest

from presswork import Case
from presswork.examples import copy_example
from presswork.study.member_process import MemberProcess, Work
from presswork.study.processes import Processes
from presswork.study.runner import Ended, Started, Task


@pytest.mark.parametrize("jobs", [1, 2])
def test_dead_process_is_told_with_its_last_words_and_the_others_go_on(tmp_path, jobs):
    case = Case.from_toml(copy_example("ring_compression", tmp_path), ["workpiece.mesh.cells=[2,1]", "output.steps=1"])
    tasks = {0: Task("no case", tmp_path / "a", "new"), 1: Task(case, tmp_path / "b", "new")}
    events = list(Processes(jobs).run(tasks))
    assert {e.member for e in events if isinstance(e, Started)} == {0, 1}
    ends = {e.member: e for e in events if isinstance(e, Ended)}
    assert ends[0].status == "failed"
    assert "TypeError: expected a case, not a str" in ends[0].reason
    assert ends[1].status == "completed"


def test_folder_that_cannot_be_written_is_told_by_the_member(tmp_path):
    case = Case.from_toml(copy_example("ring_compression", tmp_path), ["workpiece.mesh.cells=[2,1]"])
    (tmp_path / "b").write_text("")
    *_, end = Processes(1).run({0: Task(case, tmp_path / "b", "new")})
    assert isinstance(end, Ended)
    assert (end.status, "is a file" in end.reason) == ("failed", True)


def test_workpiece_that_nothing_holds_is_bad_input(tmp_path):
    away = ["tools.punch.profile=[[0,7],[60,7]]", "stages.0.tools.punch.stroke=2", "workpiece.mesh.cells=[2,1]"]
    case = Case.from_toml(copy_example("ring_compression", tmp_path), [*away, "boundary={}"])
    *_, end = Processes(1).run({0: Task(case, tmp_path / "b", "new")})
    assert isinstance(end, Ended)
    assert (end.status, "nothing holds" in end.reason) == ("bad_input", True)


def test_member_that_needs_more_than_its_share_of_memory_fails_and_says_so(tmp_path):
    path = copy_example("ring_compression", tmp_path)
    for cells, status in (("[2,1]", "completed"), ("[200,200]", "failed")):
        case = Case.from_toml(path, [f"workpiece.mesh.cells={cells}", "stages.0.tools.punch.stroke=0.1"])
        work = Work(pickle.dumps(case), str(tmp_path / status), "new", memory=250_000_000)
        ended, reason = MemberProcess(work).follow(lambda *_: None)
        assert ended == status, reason
    assert "MB of memory are needed" in reason
    assert "its share of the worker's memory was 250 MB: give the workers more memory, or fewer threads" in reason


def test_member_that_does_not_end_in_time_fails(tmp_path):
    case = Case.from_toml(
        copy_example("ring_compression", tmp_path), ["workpiece.mesh.cells=[120,120]", "solver.max_increment=0.001"]
    )
    for mode, seconds in (("new", 6.0), ("overwrite", 0.1)):
        *_, end = Processes(1, seconds).run({0: Task(case, tmp_path / "b", mode)})
        assert isinstance(end, Ended)
        assert end.status == "failed"
        assert f"not over after --member-timeout {seconds:g} s" in end.reason


def test_interrupted_pool_starts_nothing_more(tmp_path):
    case = Case.from_toml(copy_example("ring_compression", tmp_path))
    pool = Processes(1)
    events = []
    for event in pool.run({i: Task(case, tmp_path / f"{i}", "new") for i in range(3)}):
        events.append(event)
        pool.interrupts.add()
    assert [e.status for e in events if isinstance(e, Ended)] == ["interrupted"]
