# SPDX-License-Identifier: Apache-2.0
"""What the machine itself can do: memory bandwidth and arithmetic peak, by small C++ programs compiled on the spot."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

FLAGS = ["-std=c++20", "-O3", "-march=native", "-fopenmp", "-fno-math-errno", "-fno-trapping-math", "-Wno-psabi"]

MACHINE_CPP = r"""
#include <chrono>
#include <cstdlib>
#include <vector>
#include <omp.h>
typedef double Vector __attribute__((vector_size(64)));
static double now() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}
extern "C" double triad(int threads, long n, int repeats) {  // best bytes per second of a = b + s c, 24 bytes an entry
  double *a = (double*)std::aligned_alloc(64, 8 * n), *b = (double*)std::aligned_alloc(64, 8 * n),
         *c = (double*)std::aligned_alloc(64, 8 * n), best = 0;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (long i = 0; i < n; ++i) a[i] = 0, b[i] = 1, c[i] = 2;
  for (int r = 0; r < repeats; ++r) {
    double t = now();
#pragma omp parallel for num_threads(threads) schedule(static)
    for (long i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
    t = now() - t;
    if (24.0 * n / t > best) best = 24.0 * n / t;
  }
  double check = a[n / 2];
  std::free(a), std::free(b), std::free(c);
  return check == 7 ? best : -1;
}
extern "C" double peak(int threads, long n, int repeats) {  // best flops per second, 2 per multiply-add
  double best = 0, check = 0;
  for (int r = 0; r < repeats; ++r) {
    double t = now();
#pragma omp parallel num_threads(threads) reduction(+ : check)
    {
      Vector v[12], m = Vector{} + 0.999999, s = Vector{} + 1e-6 * threads;
      for (int k = 0; k < 12; ++k) v[k] = Vector{} + double(k + t);  // nothing the compiler could work out
      for (long i = 0; i < n; ++i)
        for (auto& x : v) x = x * m + s;
      for (auto& x : v) check += x[0] + x[7];
    }
    t = now() - t;
    if (threads * 192.0 * n / t > best) best = threads * 192.0 * n / t;
  }
  return check > 0 ? best : -1;
}
"""


def find_compiler() -> str | None:
    """Return the C++ compiler, or None without one."""
    return os.environ.get("CXX") or shutil.which("g++") or shutil.which("c++")


def run_program(source: str) -> str | None:
    """Return what a C++ program of this folder prints, compiled as the module is; None without a compiler."""
    compiler, here = find_compiler(), Path(__file__).parent
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "program"
        subprocess.run([compiler, *FLAGS, f"-I{here.parent / 'cpp'}", here / source, "-o", program], check=True)
        return subprocess.run([program], check=True, capture_output=True, text=True).stdout


def measure_machine() -> dict[str, dict[str, float]] | None:
    """Return triad bandwidth [B/s] and peak [flop/s] with 1 and 2 threads, or None without a compiler."""
    compiler = find_compiler()
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "machine.cpp", Path(folder) / "machine.so"
        source.write_text(MACHINE_CPP)
        subprocess.run([compiler, *FLAGS, "-shared", "-fPIC", str(source), "-o", str(library)], check=True)
        lib = ctypes.CDLL(str(library))
        for f in (lib.triad, lib.peak):
            f.restype, f.argtypes = ctypes.c_double, [ctypes.c_int, ctypes.c_long, ctypes.c_int]
        return {
            str(t): {"bandwidth": lib.triad(t, 20_000_000, 7), "peak": lib.peak(t, 10_000_000, 5)}
            for t in sorted({1, min(2, os.cpu_count() or 1)})
        }
