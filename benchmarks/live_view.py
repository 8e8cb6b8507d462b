# SPDX-License-Identifier: Apache-2.0
"""What a page that follows a run costs the run: upsetting on one thread, alone and followed in Chromium, in turn.

Target: 2 %. Processor seconds of the run are compared, which other work on the machine changes less than those of the
clock, and it is told how busy the server is. Run as `python -m benchmarks.live_view`; it needs Chromium and Playwright.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from time import perf_counter, process_time, sleep

from presswork.examples import copy_example
from presswork.server.http import Server
from presswork.server.site import Site
from tests.regression.browser import Tab, chromium

ROUNDS = 3
SETTINGS = ("workpiece.mesh.cells=[30,30]", "output.steps=40", "solver.max_increment=0.002")


def compute(case: Path, folder: Path) -> tuple[float, float]:
    """Run the case in a process of its own; return its processor seconds and those of the clock."""
    options = [word for setting in SETTINGS for word in ("--set", setting)]
    command = [
        sys.executable,
        "-c",
        "from presswork.cli import main; main()",
        "run",
        str(case),
        "--output",
        str(folder),
    ]
    command += ["--quiet", "--no-plot", "--no-report", "--threads", "1", *options]
    started = perf_counter()
    process = subprocess.Popen(command, env={**os.environ, "OMP_NUM_THREADS": "1"})
    _, _, used = os.wait4(process.pid, 0)
    process.returncode = 0
    return used.ru_utime + used.ru_stime, perf_counter() - started


def follow(address: str, folder: Path, ended: threading.Event, seen: list[int]) -> None:
    """Have a page open on the run from its first saved step to its end."""
    while not (folder / "results.vtkhdf").is_file():
        sleep(0.05)
    with chromium() as browser:
        page = Tab(browser, f"{address}run?run={folder.name}")
        while not ended.is_set():
            page.tab.wait_for_timeout(200)
        seen.append(page.ask("() => presswork.runs[0].steps.length"))
        page.close()


def main() -> None:
    """Compute alone and followed in turn, and print the ratio of the least of each."""
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        case = copy_example("upsetting_q4", root)
        site = Site(root)
        alone, followed = [], []
        with Server(site.answer) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            for number in range(ROUNDS):
                alone.append(compute(case, root / f"alone_{number}"))
                ended, seen = threading.Event(), list[int]()
                folder = root / f"followed_{number}"
                reader = threading.Thread(target=follow, args=(server.address, folder, ended, seen))
                served = process_time()
                reader.start()
                followed.append(compute(case, folder))
                served = (process_time() - served) / followed[-1][1]
                ended.set()
                reader.join()
                told = f"alone {alone[-1]}, followed {followed[-1]}, {seen[0]} steps seen"
                print(f"{told}, server busy {served:.1%} of the time", flush=True)
            server.shutdown()
        site.close()
    for i, words in enumerate(("processor time", "time of the clock")):
        ratio = min(each[i] for each in followed) / min(each[i] for each in alone)
        print(f"{words}: followed over alone {ratio:.3f}")


if __name__ == "__main__":
    main()
