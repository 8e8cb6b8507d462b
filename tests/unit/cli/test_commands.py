# SPDX-License-Identifier: Apache-2.0
"""The command line knows its commands by name and help, and loads only the one that is called."""

import subprocess
import sys

import pytest
from typer.testing import CliRunner

from presswork import __version__
from presswork.cli import app
from presswork.cli.commands import COMMANDS, load


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


def test_help_loads_no_command() -> None:
    assert not {"numpy", "pydantic", *(f"presswork.cli.{name}" for name in COMMANDS)} & loaded_by("--help")
