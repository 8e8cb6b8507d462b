// SPDX-License-Identifier: Apache-2.0
// presswork._cpu: level() says which level of x86-64 this CPU has, 1 to 4 (System V ABI), or 0 on another family.
#include <Python.h>

namespace {

long find_level() {
#if defined(__x86_64__)
  if (!(__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt"))) return 1;
  if (!(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
        __builtin_cpu_supports("bmi2")))
    return 2;
  if (!(__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")))
    return 3;
  return 4;
#else
  return 0;
#endif
}

PyObject* level(PyObject*, PyObject*) { return PyLong_FromLong(find_level()); }

PyMethodDef methods[] = {{"level", level, METH_NOARGS, "Level of x86-64 that this CPU has, 1 to 4; 0: another family."},
                         {nullptr, nullptr, 0, nullptr}};
PyModuleDef module = {PyModuleDef_HEAD_INIT, "_cpu", nullptr, -1, methods, nullptr, nullptr, nullptr, nullptr};

}  // namespace

PyMODINIT_FUNC PyInit__cpu() { return PyModule_Create(&module); }
