# SPDX-License-Identifier: Apache-2.0
"""Studies on a Dask cluster: rows and bits of processes, lost workers, no shared folder, Ctrl-C, what is refused."""

import csv
import sys
from pathlib import Path

import psutil
import pytest
from distributed.security import Security
from typer.testing import CliRunner

from presswork import Case
from presswork.cli import app
from presswork.examples import copy_example
from presswork.results import OutputError
from presswork.study import Cluster, ClusterError, run_sweep
from presswork.study.cluster import connection
from presswork.study.cluster.connection import connect, find_unlike
from presswork.study.cluster.pool import open_cluster_pool
from presswork.study.runner import Ended, Moved, Started, Task
from tests.problems.dask_cluster import DaskCluster, dask_cluster

SMALL = ["workpiece.mesh.cells=[2,1]", "stages.0.tools.punch.stroke=0.6", "output.steps=2"]
HIDE_PRESSWORK = """
from distributed import versions
versions._version_cached = lambda name, find=versions._version_cached: None if name == "presswork" else find(name)
"""
LONG = ["workpiece.mesh.cells=[4,2]", "output.checkpoint_every=3"]


@pytest.fixture(scope="module")
def case_file(tmp_path_factory) -> Path:
    return copy_example("ring_compression", tmp_path_factory.mktemp("case"))


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    with dask_cluster(tmp_path_factory.mktemp("dask")) as started:
        started.add_worker()
        yield started


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(connection, "PATIENCE", 1.0)


def read_rows(folder: Path) -> list[dict[str, str]]:
    """The table but for the time that each member took."""
    with open(folder / "table.csv", encoding="utf-8") as file:
        return [{key: value for key, value in row.items() if key != "wall_seconds"} for row in csv.DictReader(file)]


@pytest.mark.validation
def test_killed_worker_costs_no_row_and_no_bit_of_a_sweep(cluster: DaskCluster, case_file, tmp_path):
    vary = {"tools.punch.m": [0.05, 0.1, 0.15, 0.2, 0.25, 0.3]}
    run_sweep(case_file, vary, tmp_path / "processes", settings=SMALL, jobs=2)
    victim = cluster.add_worker()
    most = 0

    def kill_a_worker(progress):
        nonlocal most
        most = max(most, progress.counts["running"])
        if progress.counts["running"] == 2:
            victim.kill()

    swept = run_sweep(
        case_file, vary, tmp_path / "cluster", settings=SMALL, cluster=cluster.address, on_progress=kill_a_worker
    )
    assert victim.wait() < 0
    assert most == 2
    assert [member.status for member in swept.members] == 6 * ["completed"]
    assert read_rows(tmp_path / "cluster") == read_rows(tmp_path / "processes")
    for member in swept.members:
        for name in ("history.csv", "checkpoint.h5"):
            there = tmp_path / "processes" / member.folder.name / name
            assert (member.folder / name).read_bytes() == there.read_bytes()
    assert not list((tmp_path / "cluster").glob(".*"))


@pytest.mark.validation
def test_results_come_from_workers_that_do_not_see_the_folder(cluster: DaskCluster, case_file, tmp_path, monkeypatch):
    """/proc/self/cwd is another folder for every process, so that no worker sees the one that is meant here."""
    monkeypatch.chdir(tmp_path)
    vary, out = {"tools.punch.m": [0.1, 0.2]}, Path("/proc/self/cwd/out")
    with pytest.raises(ClusterError, match=r"workers cannot write to /proc/self/cwd/out .*--bring-back"):
        run_sweep(case_file, vary, out, settings=SMALL, cluster=cluster.address)
    swept = run_sweep(case_file, vary, out, settings=SMALL, cluster=Cluster(cluster.address, bring_back=True))
    assert [member.status for member in swept.members] == ["completed", "completed"]
    run_sweep(case_file, vary, tmp_path / "processes", settings=SMALL)
    for member in swept.members:
        there = tmp_path / "processes" / member.folder.name
        assert sorted(p.name for p in member.folder.iterdir()) == sorted(p.name for p in there.iterdir())
        assert (member.folder / "history.csv").read_bytes() == (there / "history.csv").read_bytes()
    assert not list(cluster.folder.rglob("presswork-*"))
    assert not list(Path("out").glob(".*"))


@pytest.mark.validation
@pytest.mark.parametrize("is_brought_back", [False, True])
def test_interrupted_member_goes_on_to_the_same_bits(cluster: DaskCluster, case_file, tmp_path, is_brought_back):
    case = Case.from_toml(case_file, LONG)
    with open_cluster_pool(Cluster(cluster.address, is_brought_back), 0) as pool:
        events = []
        for event in pool.run({i: Task(case, tmp_path / f"member_{i}", "new") for i in range(3)}):
            events.append(event)
            if isinstance(event, Moved) and event.fraction > 0.1 and not pool.interrupts.count:
                pool.interrupts.add()
        assert [type(event) for event in events if not isinstance(event, Moved)] == [Started, Ended]
        assert events[-1].status == "interrupted"
        *_, end = pool.run({0: Task(case, tmp_path / "member_0", "resume")})
        assert end == Ended(0, "completed", "")
        *_, end = pool.run({0: Task(case, tmp_path / "whole", "new")})
    assert "resumed after increment" in (tmp_path / "member_0/run.log").read_text()
    assert (tmp_path / "member_0/history.csv").read_bytes() == (tmp_path / "whole/history.csv").read_bytes()


def test_member_that_dies_or_cannot_be_written_costs_itself_alone(cluster: DaskCluster, case_file, tmp_path):
    case = Case.from_toml(case_file, SMALL)
    (tmp_path / "b").write_text("")
    tasks = {
        0: Task("no case", tmp_path / "a", "new"),  # type: ignore[arg-type]
        1: Task(case, tmp_path / "b", "new"),
        2: Task(case, tmp_path / "c", "new"),
    }
    with open_cluster_pool(Cluster(cluster.address), 0) as pool:
        ends = {e.member: e for e in pool.run(tasks) if isinstance(e, Ended)}
    assert [ends[i].status for i in range(3)] == ["failed", "failed", "completed"]
    assert "TypeError: expected a case, not a str" in ends[0].reason
    assert "is a file, not a folder" in ends[1].reason


def refuse_connection(address: str, jobs: int = 0) -> str:
    """Return why a cluster cannot be used."""
    with pytest.raises(ClusterError) as refusal, connect(Cluster(address), jobs):
        pass
    return str(refusal.value)


def test_scheduler_that_does_not_answer_is_told_with_how_to_start_one(impatient):
    refusal = refuse_connection("tcp://127.0.0.1:1")
    assert "no scheduler answers at tcp://127.0.0.1:1: start one by `dask scheduler`" in refusal
    for address in ("nowhere", "http://127.0.0.1:8786", "tcp://127.0.0.1", "two words:8786"):
        assert f"no scheduler answers at {address}: an address has the form tcp://" in refuse_connection(address)


def test_scheduler_without_workers_and_worker_without_presswork_are_told(impatient, monkeypatch, tmp_path):
    with dask_cluster(tmp_path) as empty:
        assert f"has no workers: start some by `dask worker {empty.address}`" in refuse_connection(empty.address)
        hide = tmp_path / "hide.py"
        hide.write_text(HIDE_PRESSWORK)
        monkeypatch.setattr(connection, "PATIENCE", 60.0)
        empty.add_worker("--preload", str(hide))
        refusal = refuse_connection(empty.address)
    assert "have none on tcp" in refusal
    assert 'pip install "presswork[cluster]==' in refusal


def test_versions_that_differ_are_named_with_what_to_install():
    own = {"python": "3.11.7.final.0", "presswork": "0.2.0", "distributed": "2026.8.0"}
    assert find_unlike(own, {"tcp://a:1": {**own, "python": "3.11.2.final.0"}}) == []
    (fault,) = find_unlike(own, {"tcp://a:1": own, "tcp://b:1": {**own, "distributed": "2024.8.0"}})
    assert "distributed 2026.8.0, as here, and have 2024.8.0 on tcp://b:1" in fault
    assert "pip install distributed==2026.8.0" in fault
    (fault,) = find_unlike(own, {"tcp://b:1": {**own, "python": "3.12.1.final.0"}})
    assert "python 3.11, as here, and have 3.12 on tcp://b:1; start the workers with Python 3.11" in fault


def test_command_computes_on_the_cluster_and_prints_the_dashboards_address(cluster: DaskCluster, case_file, tmp_path):
    sets = [word for setting in SMALL for word in ("--set", setting)]
    words = ["sweep", str(case_file), "--vary", "tools.punch.m=0.1,0.2", *sets, "--output", str(tmp_path / "out")]
    done = CliRunner().invoke(app, [*words, "--cluster", cluster.address])
    assert done.exit_code == 0, done.output
    assert "dashboard of the cluster: http://127.0.0.1:" in done.output
    assert "2 of 2 completed" in done.output
    alone = CliRunner().invoke(app, [*words, "--bring-back", "--overwrite"])
    assert alone.exit_code == 2
    assert "--bring-back goes with --cluster" in alone.output


def test_local_cluster_answers_this_machine_and_the_holder_of_its_certificate_alone(impatient):
    with connect(Cluster("local"), 1) as client:
        address = client.scheduler.address
        [process] = [p for p in psutil.Process().children() if "presswork.study.cluster.local" in " ".join(p.cmdline())]
        family = [process, *process.children(recursive=True)]
        listening = {c.laddr.ip for p in family for c in p.net_connections("inet") if c.status == psutil.CONN_LISTEN}
        assert listening == {"127.0.0.1"}
        assert address.startswith("tls://127.0.0.1:")
        for strange, other in ((address.replace("tls", "tcp"), None), (address, Security.temporary())):
            with (
                pytest.raises(ClusterError, match="no scheduler answers"),
                connect(Cluster(strange, security=other), 0),
            ):
                pass
        assert client.submit(sum, [1, 2]).result() == 3


def test_missing_library_and_options_that_do_not_go_together_are_refused(monkeypatch):
    assert "--jobs does not go with the address of a cluster" in refuse_connection("tcp://127.0.0.1:1", 2)
    assert "asks for a certificate: name it in Dask's configuration" in refuse_connection("tls://127.0.0.1:1")
    monkeypatch.setattr(connection, "find_spec", lambda name: None)
    assert 'local needs cryptography: pip install "presswork[cluster]"' in refuse_connection("local")
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert 'needs distributed: pip install "presswork[cluster]"' in refuse_connection("local")


def test_folder_that_is_used_already_is_refused_before_anything_is_sent(cluster: DaskCluster, case_file, tmp_path):
    (tmp_path / "out").write_text("")
    with pytest.raises(OutputError, match="is a file"):
        run_sweep(case_file, {"tools.punch.m": [0.1, 0.2]}, tmp_path / "out", settings=SMALL, cluster=cluster.address)
