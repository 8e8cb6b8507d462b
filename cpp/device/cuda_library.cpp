// SPDX-License-Identifier: Apache-2.0
#include "device/cuda_library.hpp"

#include <dlfcn.h>

#include <stdexcept>

namespace presswork::device {

namespace {

struct Library {
  decltype(&presswork_cuda_count) count = nullptr;
  decltype(&presswork_cuda_describe) describe = nullptr;
  decltype(&presswork_cuda_advance_double) advance_double = nullptr;
  decltype(&presswork_cuda_advance_single) advance_single = nullptr;
  std::string why;  // where there is none
};

Library open() {
  Library made;
  Dl_info own;
  if (!dladdr(reinterpret_cast<const void*>(&list_cards), &own) || !own.dli_fname) {
    made.why = "this build does not know where it lies";
    return made;
  }
  const std::string core = own.dli_fname;
  const std::string file = core.substr(0, core.rfind('/') + 1) + "libpresswork_cuda.so";
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    made.why = "this build has no CUDA library; install with -Ccmake.define.PRESSWORK_CUDA=ON (CONTRIBUTING.md)";
    return made;
  }
  const auto find = [&](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(handle, name));
    if (!function) made.why = "the CUDA library " + file + " is of another version: install presswork anew";
  };
  find(made.count, "presswork_cuda_count");
  find(made.describe, "presswork_cuda_describe");
  find(made.advance_double, "presswork_cuda_advance_double");
  find(made.advance_single, "presswork_cuda_advance_single");
  return made;
}

const Library& library() {
  static const Library opened = open();
  return opened;
}

}  // namespace

std::vector<CudaCard> list_cards(std::string& why) {
  why = library().why;
  if (!why.empty()) return {};
  char message[message_size] = {};
  int n = 0;
  std::vector<CudaCard> cards;
  bool told = library().count(&n, message) != 0;
  for (int card = 0; !told && card < n; ++card) {
    cards.emplace_back();
    told = library().describe(card, &cards.back(), message) != 0;
  }
  if (told) why = message, cards.clear();
  return cards;
}

template <class Real>
void advance_on_cuda(const Problem<Real>& problem, const Cycles& cycles) {
  if (!library().why.empty()) throw std::runtime_error(library().why);
  char message[message_size] = {};
  int failed;
  if constexpr (std::is_same_v<Real, double>)
    failed = library().advance_double(&problem, &cycles, message);
  else
    failed = library().advance_single(&problem, &cycles, message);
  if (failed) throw std::runtime_error(message);
}

template void advance_on_cuda(const Problem<double>&, const Cycles&);
template void advance_on_cuda(const Problem<float>&, const Cycles&);

}  // namespace presswork::device
