# SPDX-License-Identifier: Apache-2.0
"""The command line knows its commands by name and help, and loads only the one that is called."""

import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from presswork import __version__
from presswork.cli import app
from presswork.cli.commands import COMMANDS, load
from presswork.cli.plot import _read_section
from presswork.examples import copy_example


@pytest.mark.parametrize("name", COMMANDS)
def test_table_has_the_first_paragraph_of_a_commands_help(name: str) -> None:
    command = load(name)
    assert (command.name or name) == name
    assert " ".join(command.help.split("\n\n")[0].split()) == COMMANDS[name]


def test_help_lists_every_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    text = CliRunner().invoke(app, ["--help"]).output
    for name, line in COMMANDS.items():
        assert f" {name} " in text
        assert line in text


def test_unknown_command_is_refused_with_the_nearest_one() -> None:
    refused = CliRunner().invoke(app, ["rnu"])
    assert refused.exit_code == 2
    assert "'run'" in refused.output


def loaded_by(*arguments: str) -> set[str]:
    """Return the modules that the program has loaded when it ends."""
    code = (
        "import sys\nfrom presswork.cli import main\nsys.argv[1:] = sys.argv[2:]\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print('\\n'.join(['', 'MODULES', *sys.modules]))"
    )
    run = subprocess.run([sys.executable, "-c", code, "presswork", *arguments], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.split("MODULES\n")[1].split())


def test_version_loads_neither_typer_nor_numpy() -> None:
    assert not {"typer", "rich", "numpy", "presswork.cli.commands"} & loaded_by("--version")
    assert CliRunner().invoke(app, ["--version"]).output == f"presswork {__version__}\n"


def test_the_program_is_a_module_of_python_and_names_a_warning(tmp_path: Path) -> None:
    command = ["check", str(copy_example("hot_upsetting", tmp_path)), "--set", "heat.initial_temperature=1473"]
    done = subprocess.run([sys.executable, "-m", "presswork", *command], capture_output=True, text=True, check=False)
    assert done.stderr.startswith("warning: "), done.stderr
    assert "kelvin" in done.stderr


def test_help_loads_no_command() -> None:
    assert not {"numpy", "pydantic", *(f"presswork.cli.{name}" for name in COMMANDS)} & loaded_by("--help")


SLOW = {
    "pint",
    "h5py",
    "matplotlib",
    "tomli_w",
    "ezdxf",
    "meshio",
    "pyuff",
    "scipy.sparse",
    "scipy.ndimage",
    "scipy.stats",
}
OTHER_KINDS = {f"presswork.case.{kind}.schema" for kind in ("shell", "space", "stamping", "onestep")}


def test_check_loads_the_schema_of_its_own_kind_and_no_solver(tmp_path: Path) -> None:
    case = copy_example("upsetting_4cst", tmp_path)
    loaded = loaded_by("check", str(case))
    assert "presswork.case.plane.schema" in loaded
    assert not (SLOW | OTHER_KINDS | {"pypardiso", "rich"}) & loaded


def test_run_loads_what_it_computes_and_draws_with(tmp_path: Path) -> None:
    case = copy_example("upsetting_4cst", tmp_path)
    short = ("--set", "stages.0.tools.punch.stroke=0.1", "--quiet")
    loaded = loaded_by("run", str(case), "--no-plot", *short)
    assert "h5py" in loaded
    assert not ({"pint", "matplotlib", "scipy.stats", "scipy.ndimage", "scipy.optimize"} | OTHER_KINDS) & loaded
    drawn = loaded_by("plot", str(case.with_suffix("")))
    assert "matplotlib" in drawn
    assert not {"matplotlib.pyplot", "scipy.stats", "presswork.case.plane.schema"} & drawn


def test_an_example_that_cannot_be_written_is_told(tmp_path) -> None:
    (tmp_path / "file").write_text("")
    done = CliRunner().invoke(app, ["examples", "square_cup", "--to", str(tmp_path / "file" / "folder")])
    assert done.exit_code == 2
    assert "cannot be written" in done.output
    assert "copy elsewhere, by --to" in " ".join(done.output.split())


def test_a_section_is_named_by_point_and_angle_or_by_two_points() -> None:
    assert _read_section("45") == (0.0, 0.0, 45.0)
    assert _read_section("10,0,90") == (10.0, 0.0, 90.0)
    assert _read_section("10,0,10,50") == pytest.approx((10.0, 0.0, 90.0))
    for text in ("10,0", "1,2,1,2", "a", "1,2,3,4,5"):
        with pytest.raises(typer.Exit):
            _read_section(text)
