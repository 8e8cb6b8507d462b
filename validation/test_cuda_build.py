# SPDX-License-Identifier: Apache-2.0
"""The library for NVIDIA cards compiles on a machine without one, by the compiler from wheels.

`python -m pytest -n 0 -s -m validation validation/test_cuda_build.py` prints registers and spills by kernel.
"""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.validation

ROOT = Path(__file__).parents[1]
WHEELS = ("nvidia-cuda-nvcc", "nvidia-nvvm", "nvidia-cuda-crt", "nvidia-cuda-runtime")
SHELLS = {
    "quadrilaterals": ("14OnePointShells", "Li4E"),
    "triangles": ("14OnePointShells", "Li3E"),
    "mitc": ("10MitcShells", ""),
}
LAWS = {"": "9FastMises", "_of_any_law": "12GeneralSheet"}
MEASURES = {"settle": "6Settle", "half_step": "8HalfStep", "work": "14WorkOfElements", "farthest": "8Farthest"}
KERNELS = {
    "move_nodes": "10move_nodesI([df])",
    **{
        f"{verb}_{name}{of_any_law}": f"{start}NS0_{kind}I([df]){corners}NS_{law}E"
        for name, (kind, corners) in SHELLS.items()
        for of_any_law, law in LAWS.items()
        for verb, start in (("advance", "16advance_elementsI"), ("bound", "14measure_chunksINS0_5BoundI[df]"))
    },
    **{f"measure_{name}": f"14measure_chunksINS0_{kind}I([df])" for name, kind in MEASURES.items()},
    "damage_elements": "15damage_elementsI([df])",
    "hold_beads": "10hold_beadsI([df])",
    "push_sheet": "13push_sheet_ofI([df])",
    "gather_nodes": "12gather_nodesI([df])",
    "start_tools": "14start_tools_ofI([df])",
    "touch_nodes": "11touch_nodesI([df])",
    "press_edges": "11press_edgesI([df])",
}
"""And what the compiler's name of each has in it, with the letter of its scalar."""
SOLIDS = {"hexahedra": "17OnePointHexahedra", "tetrahedra": "15NodalTetrahedra"}
LAWS_OF_SOLIDS = {"": "8VonMises", "_of_any_law": "14ElasticPlasticILi6E"}
IN_DOUBLE = {
    "close_tools": "11close_toolsE",
    "end_cycle": "9end_cycleE",
    "join_chunks": "11join_chunksE",
    "measure_stored": "14measure_chunksINS0_6StoredE",
    "measure_stored_at_edges": "14measure_chunksINS0_13StoredAtEdgesE",
    **{
        f"{verb}_{kind}{suffix}": f"{start}NS0_{template}INS_{law}"
        for kind, template in SOLIDS.items()
        for suffix, law in LAWS_OF_SOLIDS.items()
        for verb, start in (("advance", "16advance_elementsI"), ("bound", "14measure_chunksINS0_5BoundId"))
    },
    **{
        f"{name}_of_tetrahedra{suffix}": f"{called}INS0_15NodalTetrahedraINS_{law}"
        for name, called in (("measure_cells", "13measure_cells"), ("measure_nodes", "13measure_nodes"))
        for suffix, law in LAWS_OF_SOLIDS.items()
    },
    "move_nodes_between_walls": "24move_nodes_between_wallsE",
    "move_walls": "10move_wallsE",
    "lead_nodes": "10lead_nodesE",
    "give_back_forces": "16give_back_forcesE",
}
"""In double precision alone."""
CAPABILITIES = ("80", "90")
FEW_SPILLS = 72
SPILLS = {
    "advance_mitc": 256,
    "advance_hexahedra": 264,
    "press_edges": 400,
    "measure_half_step": 592,
    "move_nodes_between_walls": 780,
}
"""Bytes a thread, and of kernels with more; those of any law call functions, across which they keep what they need."""


@pytest.fixture(scope="module")
def nvcc(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiler, installed in a folder of its own."""
    folder = tmp_path_factory.mktemp("cuda")
    install = [sys.executable, "-m", "pip", "install", "-q", "--target", folder, *(f"{name}==13.*" for name in WHEELS)]
    done = subprocess.run(install, capture_output=True, text=True, timeout=900)
    if done.returncode:
        pytest.skip(f"the compiler's wheels cannot be had here: {done.stderr.strip().splitlines()[-1]}")
    return folder / "nvidia" / "cu13" / "bin" / "nvcc"


@pytest.fixture(scope="module")
def build(nvcc: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder of the library, and what the compiler told."""
    folder = tmp_path_factory.mktemp("build")
    options = ["-DPRESSWORK_CUDA=ON", f"-DPRESSWORK_NVCC={nvcc}", f"-DPython_EXECUTABLE={sys.executable}"]
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, *options], check=True, capture_output=True, timeout=300)
    command = ["cmake", "--build", folder, "--target", "presswork_cuda"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3000)
    told = done.stdout + done.stderr
    assert done.returncode == 0, told
    return folder, told


def read_kernels(told: str) -> dict[tuple[str, str, str], tuple[int, int]]:
    """Registers and spilled bytes a thread, by kernel, precision and compute capability."""
    found = {}
    for name, capability, spilled, registers in re.findall(
        r"entry function '(\w+)' for 'sm_(\d+)'.*?(\d+) bytes spill stores.*?Used (\d+) registers", told, re.DOTALL
    ):
        kernel, match = next(
            (kernel, match) for kernel, pattern in (KERNELS | IN_DOUBLE).items() if (match := re.search(pattern, name))
        )
        precision = "single" if match.groups() == ("f",) else "double"
        found[kernel, precision, capability] = (int(registers), int(spilled))
    return found


def test_kernels_fit_into_registers(build: tuple[Path, str]) -> None:
    found = read_kernels(build[1])
    expected = {(k, p, c) for k in KERNELS for p in ("double", "single") for c in CAPABILITIES}
    assert set(found) == expected | {(k, "double", c) for k in IN_DOUBLE for c in CAPABILITIES}
    for (kernel, precision, capability), (registers, spilled) in sorted(found.items()):
        print(f"sm_{capability} {kernel:33s} {precision}: {registers:3d} registers, {spilled} bytes spilled")
        assert registers <= 255
        if not kernel.endswith("any_law"):
            assert spilled <= SPILLS.get(kernel, FEW_SPILLS)


def test_the_lowest_bit_is_found_on_a_card(nvcc: Path, tmp_path: Path) -> None:
    """`std::countr_zero` compiles to the constant 32 there, which made a card search triangles where there are none."""
    source, assembly = tmp_path / "bits.cu", tmp_path / "bits.ptx"
    source.write_text(
        '#include "contact/triangle_search.hpp"\n'
        "__global__ void find(unsigned* x) { x[1] = presswork::contact::eights::lowest(x[0]); }\n"
    )
    options = ["-std=c++20", "-O3", "--expt-relaxed-constexpr", "-arch=compute_90", "-ptx", f"-I{ROOT / 'cpp'}"]
    subprocess.run([nvcc, *options, source, "-o", assembly], check=True, capture_output=True, timeout=300)
    assert "bfind" in assembly.read_text()


def test_the_library_is_opened_and_says_what_is_missing(build: tuple[Path, str]) -> None:
    """On a machine without driver or card; on one with a card it is counted."""
    library = ctypes.CDLL(str(build[0] / "libpresswork_cuda.so"))
    cards, message = ctypes.c_int(0), ctypes.create_string_buffer(512)
    if library.presswork_cuda_count(ctypes.byref(cards), message):
        assert "there is no NVIDIA" in message.value.decode()
    else:
        assert cards.value > 0
