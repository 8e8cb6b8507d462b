# SPDX-License-Identifier: Apache-2.0
"""The command `devices`."""

import typer

from presswork.explicit.device import describe_devices


def devices() -> None:
    """List what explicit runs can compute on: the CPU, and NVIDIA cards where there are any."""
    for name, text in describe_devices():
        typer.echo(f"{name:6s} {text}")
