// SPDX-License-Identifier: Apache-2.0
// What the library built by a CUDA compiler offers, and how the core finds it: a file beside it, opened when asked for.
//
// The functions give 0, or another number and why in `message`.
#pragma once

#include <string>
#include <vector>

#include "device/resident.hpp"

namespace presswork::device {

inline constexpr int message_size = 512;
inline constexpr int least_capability = 80;  // compute capability 8.0, ten times it

struct CudaCard {
  char name[256];
  int capability;       // ten times it: 90 of a card of 9.0
  double memory, free;  // [bytes]
};

extern "C" {
int presswork_cuda_count(int* cards, char* message);
int presswork_cuda_describe(int card, CudaCard* found, char* message);
int presswork_cuda_make_double(const Problem<double>* problem, Resident<double>** made, char* message);
int presswork_cuda_make_single(const Problem<float>* problem, Resident<float>** made, char* message);
}

// The cards that there are; none and why, where there is no library, no driver or no card.
std::vector<CudaCard> list_cards(std::string& why);
// On the first card. Throws std::runtime_error.
template <class Real>
std::unique_ptr<Resident<Real>> make_on_card(const Problem<Real>& problem);

}  // namespace presswork::device
