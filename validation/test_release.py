# SPDX-License-Identifier: Apache-2.0
"""A release: source archive and wheel built by one command; the wheel installed into an empty environment."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from presswork import __version__

pytestmark = pytest.mark.validation

ROOT = Path(__file__).parents[1]
NEEDED = ("CHANGELOG.md", "CITATION.cff", "LICENSE", "README.md", "mkdocs.yml", "docs/site/examples/cases.toml")
EXAMPLE = "upsetting_q4"


def call(*command: str | Path, folder: Path, **variables: str) -> str:
    """Run a command away from the sources and their packages; return what it prints."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"} | variables
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def release(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that packaging/release.sh fills; compiled for this machine alone."""
    folder = tmp_path_factory.mktemp("release")
    script = ROOT / "packaging/release.sh"
    call(script, folder, folder=folder, PRESSWORK_ARCH="native", PYTHON=sys.executable)
    return folder


@pytest.fixture(scope="module")
def presswork(release: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command of the wheel in an environment that had nothing."""
    folder = tmp_path_factory.mktemp("empty")
    call(sys.executable, "-m", "venv", folder / "venv", folder=folder)
    (wheel,) = release.glob("*.whl")
    call(folder / "venv/bin/pip", "install", "-q", wheel, folder=folder)
    return folder / "venv/bin/presswork"


def test_the_source_archive_has_what_a_packager_needs_and_nothing_compiled(release: Path) -> None:
    (archive,) = release.glob("*.tar.gz")
    assert archive.name == f"presswork-{__version__}.tar.gz"
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert set(NEEDED) <= names
    assert not [name for name in names if name.endswith((".so", ".pyc"))]


def test_the_wheel_has_every_file_of_the_package(release: Path) -> None:
    (wheel,) = release.glob("*.whl")
    assert re.fullmatch(rf"presswork-{re.escape(__version__)}-cp3\d+-cp3\d+-manylinux\w+\.whl", wheel.name)
    listed = subprocess.run(
        ["git", "ls-files", "--", "presswork"], cwd=ROOT / "src", capture_output=True, text=True, check=True
    ).stdout.split()
    with zipfile.ZipFile(wheel) as opened:
        assert set(listed) <= set(opened.namelist())


def test_the_installed_wheel_says_its_version_and_runs_an_example(presswork: Path, tmp_path: Path) -> None:
    assert __version__ in call(presswork, "--version", folder=tmp_path)
    call(presswork, "examples", EXAMPLE, folder=tmp_path)
    call(presswork, "run", f"{EXAMPLE}.toml", folder=tmp_path, OMP_NUM_THREADS="1")
    assert json.loads((tmp_path / EXAMPLE / "summary.json").read_text("utf-8"))["status"] == "completed"
