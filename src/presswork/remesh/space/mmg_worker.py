# SPDX-License-Identifier: Apache-2.0
"""Program that makes meshes by MMG for the process that has started it (mmg_process.py), without the rest of presswork.

It reads requests from its standard input and writes an answer to each, both pickled, until its input ends. A request
names arguments of `make_mesh`, and the processor time that it may take; an answer also holds the time taken.
"""

from __future__ import annotations

import math
import os
import pickle
import sys
from collections.abc import Mapping
from contextlib import suppress
from time import process_time
from typing import Any

import numpy as np


def make_mesh(body: Mapping[str, Any], options: Mapping[str, Any], memory: int) -> dict[str, Any]:
    """Return points, cells, faces and their numbers of a mesh that MMG makes.

    body: points, cells, faces, number, and the size of edges at the points; memory: that MMG may take [MB], since it
    sets up what it may take for a million points at once otherwise. Raises RuntimeError or ValueError.
    """
    from mmgpy import MmgMesh3D

    mesh = MmgMesh3D()
    with suppress(RuntimeError, ValueError):  # notes the memory, and fails since there is no mesh yet
        mesh.remesh(verbose=-1, mem=memory)
    mesh.set_mesh_size(len(body["points"]), len(body["cells"]), 0, len(body["faces"]), 0, 0)
    mesh.set_vertices(np.ascontiguousarray(body["points"]))
    mesh.set_tetrahedra(np.ascontiguousarray(body["cells"], dtype=np.int32))
    mesh.set_triangles(np.ascontiguousarray(body["faces"], dtype=np.int32), body["number"].astype(np.int64))
    mesh["metric"] = np.ascontiguousarray(body["size"][:, None])
    mesh.remesh(verbose=-1, **options)
    faces, number = mesh.get_triangles_with_refs()
    found = {"points": mesh.get_vertices(), "cells": mesh.get_tetrahedra(), "faces": faces, "number": number}
    return {name: np.array(values) for name, values in found.items()}


def limit_time(seconds: float) -> None:
    """End this process once it has taken as much processor time more, in whole seconds; not on Windows."""
    with suppress(ImportError):
        import resource

        used = resource.getrusage(resource.RUSAGE_SELF)
        most, hard = math.ceil(used.ru_utime + used.ru_stime + seconds), resource.getrlimit(resource.RLIMIT_CPU)[1]
        resource.setrlimit(resource.RLIMIT_CPU, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
        resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))


def main() -> None:
    """Answer requests. What MMG prints goes nowhere: answers have the output for themselves."""
    answers = os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for output in (1, 2):
        os.dup2(nowhere, output)
    while True:
        try:
            request = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        limit_time(request.pop("seconds"))
        started = process_time()
        try:
            answer = make_mesh(**request)
        except (RuntimeError, ValueError) as error:
            answer = {"fault": str(error)}
        answer["seconds"] = process_time() - started
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    main()
