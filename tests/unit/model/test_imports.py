# SPDX-License-Identifier: Apache-2.0
"""The Model is data: who imports it loads neither files, nor schemas, nor solvers."""

import subprocess
import sys


def test_import_of_the_model_loads_nothing_that_it_is_not_made_of() -> None:
    code = "import sys, presswork.model\nprint(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert not {"h5py", "pydantic", "scipy", "matplotlib", "typer"} & loaded
    rooms = {name.split(".")[1] for name in loaded if name.startswith("presswork.")}
    assert rooms <= {"model", "formability", "simd", "threads", "_core", "_cpu"}
