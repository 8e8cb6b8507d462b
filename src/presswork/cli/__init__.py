# SPDX-License-Identifier: Apache-2.0
"""The command line: a table of commands, each of which is imported when it is called.

`main` is the program `presswork`; `app` is the same as a Typer app, for tests and other programs.
"""

import gc
import os
import sys
from typing import Any

from presswork import __version__


def main() -> None:
    """Run the command line. `--version` alone is answered without loading typer."""
    if sys.argv[1:] == ["--version"]:
        print(f"presswork {__version__}")
        return
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # which it would look for in every installed package
    gc.set_threshold(100_000)  # what is imported stays: searching it for garbage takes a tenth of a short command
    name_levels()
    from presswork.cli.commands import app

    app()


def name_levels() -> None:
    """Print what is logged as "warning: ..." or "error: ...", unless a program has set handlers of its own."""

    import logging

    class Named(logging.Formatter):
        def format(self, record: logging.LogRecord) -> str:
            return f"{record.levelname.lower()}: {super().format(record)}"

    if logging.lastResort is not None:
        logging.lastResort.setFormatter(Named())


def __getattr__(name: str) -> Any:
    """Import the Typer app when it is first asked for."""
    if name == "app":
        from presswork.cli.commands import app

        return app
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
