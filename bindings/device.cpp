// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "device/cuda_library.hpp"
#include "device/space.hpp"

namespace presswork::bindings {

namespace {

using explicit_dynamics::SpaceLoop;

template <class Real>
void advance_on(SpaceLoop<Real>& loop, device::Target target, double dt, double dt_before, Doubles force_scale,
                Doubles velocity_scale, double damping) {
  require(force_scale.size() == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  require(device::find_lack(loop).empty(), "no device computes this loop");
  nb::gil_scoped_release release;
  device::advance(
      loop, target,
      {static_cast<int>(force_scale.size()), dt, dt_before, damping, force_scale.data(), velocity_scale.data()});
}

template <class Real>
void bind_for(nb::module_& m) {
  m.def("find_device_lack", &device::find_lack<Real>, nb::arg("loop"),
        "What a loop has that no device computes yet, in words; empty where there is nothing.");
  m.def(
      "advance_on", &advance_on<Real>, nb::arg("loop"), nb::arg("target"), nb::arg("dt"), nb::arg("dt_before"),
      nb::arg("force_scale"), nb::arg("velocity_scale"), nb::kw_only(), nb::arg("damping") = 0.0,
      "Advance a loop, of which nothing lacks, on a device: as many cycles of dt [s] as the scales have values. Raises "
      "RuntimeError where the device does not.");
}

}  // namespace

void bind_device(nb::module_& m) {
  nb::enum_<device::Target>(m, "Device", "What takes the place of the CPU's loop.")
      .value("host", device::Target::host, "the device code on the CPU, a lane after the other")
      .value("cuda", device::Target::cuda, "the first NVIDIA card");
  bind_for<double>(m);
  bind_for<float>(m);
  m.def(
      "list_cuda_cards",
      [] {
        std::string why;
        std::vector<std::tuple<std::string, int, double, double>> cards;
        for (const auto& card : device::list_cards(why))
          cards.emplace_back(card.name, card.capability, card.memory, card.free);
        return std::make_tuple(cards, why);
      },
      "NVIDIA cards: name, ten times the compute capability, memory and free memory [bytes] of each; and why there are "
      "none.");
}

}  // namespace presswork::bindings
