# SPDX-License-Identifier: Apache-2.0
"""Discs drawn at random are blanked: `python -m validation.blanked_discs SEED ...` prints a row for each.

A seed draws thickness, radius, clearance, radii of the edges and strength; lengths of cells and the speed follow the
thickness as in the example `blanking`. The force is compared with the rule of thumb 0.8 UTS t L.
"""

from __future__ import annotations

import sys
import tomllib
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from presswork import Case, build_model
from presswork.recorder import run_model


def draw_disc(seed: int) -> tuple[dict[str, Any], str, float]:
    """Return a case, its description, and the force of the rule of thumb [N]."""
    chance = np.random.default_rng(seed)
    t = round(float(chance.uniform(0.8, 4.0)), 2)
    radius = round(t * float(chance.uniform(3.0, 8.0)), 2)
    clearance = round(t * float(chance.uniform(0.04, 0.16)), 3)
    edge = round(t * float(chance.uniform(0.04, 0.08)), 3)
    k = round(float(chance.uniform(700.0, 1600.0)))
    n = 0.2655
    data = tomllib.loads((files("presswork") / "examples" / "blanking.toml").read_text("utf-8"))
    scale = t / 2.0
    wide = radius + clearance
    outer = wide + 3.0 * t
    data["workpiece"]["mesh"] = {"kind": "rectangle", "size": [outer, t], "cells": [round(10 * outer / t), 10]}
    steel = data["materials"]["steel"]
    steel["hardening"] |= {"K": k}
    steel["damage"] |= {"A": k, "c2": k * 720.0 / 1275.9, "length": 0.1 * scale}
    tools = data["tools"]
    tools["punch"]["profile"] = [[-1, t], {"to": [radius, t], "radius": edge}, [radius, 8 * t]]
    tools["die"]["profile"] = [[wide, -8 * t], {"to": [wide, 0], "radius": edge}, [outer + t, 0]]
    tools["holder"]["profile"] = [[outer + t, t], [wide + 0.1 * t, t], [wide + 0.1 * t, 3 * t]]
    data["stages"][0] |= {"duration": f"{0.3 * scale} ms"}
    data["stages"][0]["tools"]["punch"]["stroke"] = 0.45 * t
    data["separation"]["size"] = 0.05 * scale
    box = [radius - 0.1 * t, -0.5 * t, wide + 0.1 * t, t]
    data["remesh"] |= {"size": 0.4 * scale, "smallest_size": 0.0125 * t, "windows": [{"box": box, "size": 0.025 * t}]}
    data["explicit"]["target_step"] = 1.5e-8 * scale
    data["output"] |= {"steps": 1}
    strength = k * (n / np.e) ** n * np.exp(steel["hardening"]["e0"])
    words = f"t {t:.2f}, radius {radius:.1f}, clearance {100 * clearance / t:.0f} %, edges {edge:.3f}, K {k}"
    return data, words, 0.8 * float(strength) * t * 2.0 * np.pi * radius


def blank(seed: int) -> str:
    """Return the row of a disc: what it is, how the run ended, force over the rule, parting stroke, seconds."""
    data, words, rule = draw_disc(seed)
    started = process_time()
    with TemporaryDirectory() as folder:
        outcome = run_model(build_model(Case(**data)), Path(folder) / "run", threads=1)
        summary = outcome.result.summary["separation"]
    parted = summary.get("parted", {}).get("stroke_mm", float("nan"))
    return (
        f"| {seed} | {words} | {outcome.status}, {summary['pieces']} pieces | {summary['largest_force_N'] / rule:.2f} "
        f"| {parted:.3f} mm | {process_time() - started:.0f} s | {outcome.reason or ''}"
    )


if __name__ == "__main__":
    for each in sys.argv[1:]:
        print(blank(int(each)), flush=True)
