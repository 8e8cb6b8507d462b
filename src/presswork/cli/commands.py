# SPDX-License-Identifier: Apache-2.0
"""The table of commands, and the group that imports a command when it is called."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from presswork import __version__

COMMANDS = {
    "run": "Compute a case, draw its pictures and write its page for the browser.",
    "check": "Validate a case and describe what would be computed; code that it names runs only if allowed.",
    "plot": "Draw PNG pictures of results: mesh with fields, history, contact stress, forming limit diagram.",
    "animate": "Write a film of a run, GIF or MP4: the part with a field, a picture a saved step.",
    "report": "Write one page for the browser: the part in 3D with its fields over time, curves, forming limit, case.",
    "view": "Show the runs of a folder in the browser, and follow those that compute.",
    "new": "Set up a case in the browser: choose a process, fill in a form, see tools and blank, run it.",
    "edit": "Edit a case in the browser: a form with units and ranges, checked and drawn at every change.",
    "examples": "List the example cases, or copy one here.",
    "schema": "Print the JSON schema of case files, for editors that complete them.",
    "sweep": "Run a family of cases in parallel, and leave one table and one picture.",
    "optimise": "Find the best values of keys of a case, within bounds and limits, by runs in parallel.",
    "robust": "Find how often a process passes its limits when inputs scatter, and which input to hold tighter first.",
    "blank": "Find the blank whose drawn flange has the outline wanted: draw, correct, draw again.",
    "compensate": "Correct the tools for springback, loop by loop, until the part has the shape it is drawn to.",
    "devices": "List what explicit runs can compute on: the CPU, and NVIDIA cards where there are any.",
    "materials": "List the sheet materials of the library.",
    "stone": "Draw a stone over a panel: where it would not touch, and by how much.",
    "dies": "Find the stress of a tool's body after a run, with its rings, and whether it holds.",
    "onestep": "Find the flat blank of a finished part: outline, thinning, formability, punch force.",
    "calibrate": "Find a parameter from measured tests.",
    "material": "Sheet materials at a point.",
    "export": "Write the formed part for other programs, with thickness, stress and plastic strain.",
    "import": "Make a case of another program's deck, and report line by line what was kept, changed and dropped.",
}
"""First paragraph of each command's help by its name. A command is the function of that name in the module of that name
in this package; a group of commands is the Typer `app` of its module."""

_STUDIES = ("sweep", "optimise", "robust", "blank", "compensate", "calibrate")
_MODULES = {"import": "import_deck"} | {name: f"study.{name}" for name in _STUDIES}
"""Modules of commands where they have another name."""


def load(name: str) -> Any:
    """Import a command and return it, as typer's own command or group; EPILOG of its module ends its help."""
    module = import_module(f"presswork.cli.{_MODULES.get(name, name)}")
    if hasattr(module, "app"):
        return typer.main.get_command(module.app)
    alone = typer.Typer(add_completion=False)
    alone.command(name, epilog=getattr(module, "EPILOG", None))(getattr(module, name))
    return typer.main.get_command(alone)


class LazyGroup(TyperGroup):
    """A group that knows its commands by name and help alone, and loads the one that is called."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = {name: TyperCommand(name, help=text) for name, text in COMMANDS.items()}

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return name, loaded command and remaining arguments; an unknown name ends the program with a suggestion."""
        name, command, rest = super().resolve_command(ctx, args)
        return name, command and load(str(name)), rest


app = typer.Typer(
    cls=LazyGroup,
    help="Simulate metal forming: a short case file in, force, flow, strain and contact stress out.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"presswork {__version__}")
        raise typer.Exit


@app.callback()
def main(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print it.")
    ] = False,
) -> None:
    """Hold the options that come before a command."""
