# SPDX-License-Identifier: Apache-2.0
"""The command `view`."""

from __future__ import annotations

import signal
import webbrowser
from contextlib import closing, suppress
from pathlib import Path
from typing import Annotated

import typer

from presswork.cli.terminal import refuse

Port = Annotated[int, typer.Option(min=0, max=65535, help="Port on this machine; 0 takes a free one.")]
Browser = Annotated[bool, typer.Option(help="Open the browser; without it the address is printed alone.")]


def view(
    folder: Annotated[Path, typer.Argument(help="Folder with runs, sweeps and cases.")] = Path(),
    port: Port = 0,
    browser: Browser = True,
) -> None:
    """Show the runs of a folder in the browser, and follow those that compute."""
    serve(folder, "", port, browser)


def serve(folder: Path, page: str, port: int, browser: bool) -> None:
    """Serve a folder, beginning with a page of it, until Ctrl-C, SIGTERM or SIGHUP."""
    from presswork.server.confined import confine
    from presswork.server.http import Server
    from presswork.server.site import Site

    if not folder.is_dir():
        raise refuse(f"there is no folder {folder}")
    for number in (signal.SIGTERM, signal.SIGHUP):  # a terminal that is closed ends it as Ctrl-C does
        signal.signal(number, signal.default_int_handler)
    with suppress(KeyboardInterrupt), closing(Site(folder)) as site:
        try:
            server = Server(site.answer, port)
        except OSError as error:
            raise refuse(f"port {port} cannot be used: {error.strerror or error}; choose another by --port") from error
        with server:
            typer.echo(f"{server.address}{page}")
            typer.echo("Ctrl-C ends it; runs that were begun here stop with a checkpoint", err=True)
            if browser:
                webbrowser.open(f"{server.address}{page}")
            confine(site.opened.root, site.scratch.folder)
            server.serve_forever()
