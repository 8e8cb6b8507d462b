// SPDX-License-Identifier: Apache-2.0
#include "device/cuda_library.hpp"

#include <dlfcn.h>

#include <stdexcept>

namespace presswork::device {

namespace {

struct Library {
  decltype(&presswork_cuda_count) count = nullptr;
  decltype(&presswork_cuda_describe) describe = nullptr;
  decltype(&presswork_cuda_make_double) make_double = nullptr;
  decltype(&presswork_cuda_make_single) make_single = nullptr;
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
  find(made.make_double, "presswork_cuda_make_double");
  find(made.make_single, "presswork_cuda_make_single");
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
std::unique_ptr<Resident<Real>> make_on_card(const Problem<Real>& problem) {
  if (!library().why.empty()) throw std::runtime_error(library().why);
  char message[message_size] = {};
  Resident<Real>* made = nullptr;
  int failed;
  if constexpr (std::is_same_v<Real, double>)
    failed = library().make_double(&problem, &made, message);
  else
    failed = library().make_single(&problem, &made, message);
  if (failed) throw std::runtime_error(message);
  return std::unique_ptr<Resident<Real>>(made);
}

template std::unique_ptr<Resident<double>> make_on_card(const Problem<double>&);
template std::unique_ptr<Resident<float>> make_on_card(const Problem<float>&);

}  // namespace presswork::device
