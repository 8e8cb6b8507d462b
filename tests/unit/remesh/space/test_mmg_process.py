# SPDX-License-Identifier: Apache-2.0
"""A mesh that MMG never finishes, or on which it crashes, is given up; the next one is made."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from presswork.mesh.checks import MeshError
from presswork.remesh.space import fill
from presswork.remesh.space.fill import FilledBody, mesh_to_size
from presswork.remesh.space.mmg_process import MMG
from presswork.remesh.space.tetrahedra import find_skin, measure_volumes
from tests.unit.remesh.space.bodies import mesh_box


def mesh(size: float) -> FilledBody:
    points, cells = mesh_box((3, 3, 3), (4.0, 4.0, 4.0))
    faces, _ = find_skin(cells)
    body = FilledBody(points, cells, faces, np.zeros(len(faces), dtype=np.intp))
    return mesh_to_size(body, np.full(len(points), size), smallest=0.9 * size, largest=1.1 * size, away=0.1)


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of processor time")
def test_a_mesh_that_takes_too_long_is_given_up(monkeypatch):
    before = mesh(0.9)
    monkeypatch.setattr(fill, "SECONDS", 0.0)
    monkeypatch.setattr(fill, "SECONDS_PER_CELL", 1e-9)
    with pytest.raises(MeshError, match=r"MMG has not made a mesh in .* s"):
        mesh(0.15)  # 270,000 cells
    monkeypatch.undo()
    after = mesh(0.9)
    assert after.points.tobytes() == before.points.tobytes()
    assert measure_volumes(after.points, after.cells).sum() == pytest.approx(64.0)


@pytest.mark.skipif(sys.platform == "win32", reason="no limit of processor time")
def test_a_limit_that_the_system_sets_is_kept():
    """As on a cluster: no process may ask for more."""
    program = (
        "import resource\nfrom presswork.remesh.space.mmg_worker import limit_time\n"
        "resource.setrlimit(resource.RLIMIT_CPU, (500, 500))\nlimit_time(1e6)\n"
        "print(*resource.getrlimit(resource.RLIMIT_CPU))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["500", "500"]


@pytest.mark.skipif(sys.platform == "win32", reason="no such signal")
def test_a_crash_costs_one_mesh():
    before = mesh(0.9)
    process = MMG._start()
    os.kill(process.pid, signal.SIGSEGV)
    process.wait()
    with pytest.raises(MeshError, match="MMG has crashed"):
        mesh(0.9)
    assert mesh(0.9).points.tobytes() == before.points.tobytes()


def test_a_body_that_mmg_cannot_mesh_is_refused_in_words():
    points, cells = mesh_box((2, 2, 2), (1.0, 1.0, 1.0))
    faces, _ = find_skin(cells)
    body = FilledBody(points * [1.0, 1.0, 0.0], cells, faces, np.zeros(len(faces), dtype=np.intp))
    with pytest.raises(MeshError, match="MMG"):
        mesh_to_size(body, np.full(len(points), 0.5), smallest=0.4, largest=0.6, away=0.1)
