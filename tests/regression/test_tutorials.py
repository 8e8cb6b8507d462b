# SPDX-License-Identifier: Apache-2.0
"""The tutorials followed to the letter: files saved, commands run, numbers of the text met."""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
TUTORIALS = ROOT / "docs/tutorials"
PAGES = sorted(page.stem for page in TUTORIALS.glob("*.md") if page.stem != "index")
SHORT = {"blank_of_a_part"}
"""Those that run with every test; the others are validations, since they take up to a minute."""


def save_files(text: str, folder: Path) -> None:
    """Save every block of a page that follows "Save as `NAME`:"."""
    for name, content in re.findall(r"Save as `([\w.]+)`:\n\n```\w+\n(.*?)```", text, re.DOTALL):
        (folder / name).write_text(content, encoding="utf-8")


def run_commands(text: str, folder: Path) -> str:
    """Run every line of a page's blocks of commands in a folder; return what they print."""
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    program = bin_folder / "presswork"
    program.write_text(f"#!{sys.executable}\nfrom presswork.cli import main\n\nmain()\n", encoding="utf-8")
    program.chmod(0o755)
    path = os.pathsep.join([str(bin_folder), str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = os.environ | {"PATH": path, "OMP_NUM_THREADS": "1"}
    printed = []
    for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL):
        for line in block.strip().replace("\\\n", "").splitlines():
            done = subprocess.run(
                ["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, f"{line}\n{done.stdout}\n{done.stderr}"
            printed.append(done.stdout)
    return "\n".join(printed)


def read_summary(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text("utf-8"))
    return found


def read_table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def find_numbers(page: str, folder: Path) -> dict[str, float]:
    """Return what a run gives for each number of a tutorial, by the number as the text has it."""
    if page == "upset_a_cylinder":
        runs = {"836 kN": "upsetting_q4", "778 kN": "slides"}
        forces = {text: read_summary(folder / run)["largest_forces"]["punch"]["force_n"] for text, run in runs.items()}
        return {text: force / 1e3 for text, force in forces.items()}
    if page == "forge_with_flash":
        small, large = read_summary(folder / "blank"), read_summary(folder / "large")
        return {
            "83 %": 100 * small["die_fill"]["die"]["wall_filled"],
            "170 mm³": small["die_fill"]["die"]["unfilled_volume_mm3"],
            "1268 kN": small["largest_forces"]["die"]["force_n"] / 1e3,
            "100 %": 100 * large["die_fill"]["die"]["wall_filled"],
            "2982 kN": large["largest_forces"]["die"]["force_n"] / 1e3,
        }
    if page == "draw_a_cup":
        rows = read_table(folder / "square_cup_sweep/table.csv")
        thinning = [float(row["max_thinning_percent"]) for row in rows]
        margins = [float(row["min_forming_limit_margin"]) for row in rows]
        texts = ("15 %", "21 %", "43 %", "0.31", "0.23", "−0.11")
        return dict(zip(texts, [*thinning, *margins], strict=True))
    if page == "springback_of_a_hat":
        rows = read_table(folder / "hat_compensate/table.csv")
        found = [abs(float(row["largest_deviation_mm"])) for row in rows]
        return dict(zip(("0.71 mm", "0.07 mm", "0.04 mm"), found, strict=True))
    if page == "hot_stamping":
        last, short = (read_table(folder / run / "history.csv")[-1] for run in ("hot_stamping_hat", "short"))
        warm, hot = ({text: float(row["temperature_max"])} for text, row in (("83 °C", last), ("342 °C", short)))
        return warm | hot | {"0.97": float(last["martensite_mean"]), "0.59": float(short["martensite_mean"])}
    one = read_summary(folder / "blank")
    return {
        "85 mm": one["blank"]["extent_mm"][0],
        "5904 mm²": one["blank"]["area_mm2"],
        "82 %": one["blank"]["strip"]["utilisation_percent"],
        "5.3 %": one["formability"]["largest_thinning_percent"]["value"],
        "28 kN": one["punch_force_kN"],
    }


@pytest.mark.parametrize(
    "page", [page if page in SHORT else pytest.param(page, marks=pytest.mark.validation) for page in PAGES]
)
def test_a_tutorial_runs_and_gives_the_numbers_of_its_text(page: str, tmp_path: Path) -> None:
    text = (TUTORIALS / f"{page}.md").read_text("utf-8")
    save_files(text, tmp_path)
    run_commands(text, tmp_path)
    for shown, value in find_numbers(page, tmp_path).items():
        assert shown in " ".join(text.split()), f"{shown}: not in the text"
        number = float(re.sub(r"[^\d.−]", "", shown).replace("−", "-"))
        half = 0.5 * 10.0 ** -len(shown.partition(".")[2].split(" ")[0]) if "." in shown else 0.5
        assert value == pytest.approx(number, rel=0.03, abs=1.2 * half), shown
