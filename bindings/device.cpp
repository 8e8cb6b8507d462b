// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "device/cuda_library.hpp"
#include "device/space.hpp"

namespace presswork::bindings {

namespace {

using device::Part;
using explicit_dynamics::SpaceLoop;

template <class Real>
std::tuple<int, LawStatus, int> advance(device::Session<Real>& self, double dt, double dt_before, Doubles force_scale,
                                        Doubles velocity_scale, double damping) {
  require(force_scale.size() == velocity_scale.size(), "force_scale and velocity_scale must have the same length");
  nb::gil_scoped_release release;
  const device::Failure failure = self.advance(
      {static_cast<int>(force_scale.size()), dt, dt_before, damping, force_scale.data(), velocity_scale.data()});
  return {failure.element, static_cast<LawStatus>(failure.status), failure.cycle};
}

template <class Real>
auto traffic(const device::Session<Real>& self) {
  const device::Traffic& of = self.traffic();
  return std::make_tuple(of.sends, of.sent, of.fetches, of.fetched);
}

template <class Real>
void bind_for(nb::module_& m, const char* name) {
  using Session = device::Session<Real>;
  m.def("find_device_lack", &device::find_lack<Real>, nb::arg("loop"),
        "What a loop has that no device computes yet, in words; empty where there is nothing.");
  nb::class_<Session>(m, name, "State of a loop, of which nothing lacks, on a device, until the loop is changed.")
      .def(
          "__init__",
          [](Session* self, SpaceLoop<Real>& loop, device::Target target, double memory) {
            require(device::find_lack(loop).empty(), "no device computes this loop");
            new (self) Session(loop, target, memory);
          },
          nb::arg("loop"), nb::arg("target"), nb::arg("memory") = 1e15, nb::keep_alive<1, 2>(),
          "Take it there; memory: that of the host build [bytes]. Raises RuntimeError where it does not fit.")
      .def("advance", &advance<Real>, nb::arg("dt"), nb::arg("dt_before"), nb::arg("force_scale"),
           nb::arg("velocity_scale"), nb::kw_only(), nb::arg("damping") = 0.0,
           "Advance by as many cycles of dt [s] as the scales have values; tools, beads and work in the loop follow. "
           "Gives the element that has failed, why, and in which cycle; it is -1 where none has. Stops where a "
           "place is not finite any more. Raises RuntimeError where the device does not.")
      .def_prop_ro("is_finite", &Session::is_finite, "Whether all places were finite after the last call.")
      .def("fetch", &Session::fetch, nb::arg("part"), "Take a part of the state into the loop.")
      .def("fetch_measures", &Session::fetch_measures,
           "Of the elements the thickness of shells, and what point_measures gives of solids, alone.")
      .def("clear_reaction", &Session::clear_reaction, "Sum up reactions anew.")
      .def("send_walls", &Session::send_walls, "Let walls move as those of the loop do now.")
      .def("send_given", &Session::send_given,
           "Take temperatures and limits of friction there that are given now; False where it had none before.")
      .def("send_sums", &Session::send_sums, "Take there what walls of the loop have pressed and rubbed.")
      .def(
          "energies",
          [](Session& self, double dt, double dt_before, double damping, double force_scale, double velocity_scale) {
            return self.energies({dt, 0.5 * (dt_before + dt), damping, force_scale, velocity_scale});
          },
          nb::arg("dt"), nb::arg("dt_before"), nb::kw_only(), nb::arg("damping") = 0.0, nb::arg("force_scale") = 1.0,
          nb::arg("velocity_scale"), "Energies at the present time, as the loop's.")
      .def("bound_frequency", &Session::bound_frequency, "The largest bound of an element's squared frequency [1/s2].")
      .def("keep", &Session::keep, "Keep the present state on the device.")
      .def("put_back", &Session::put_back, "Go back to the state that was kept.")
      .def_prop_ro("needed", &Session::needed, "Memory that it takes [bytes], what is kept counted.")
      .def_prop_ro("traffic", &traffic<Real>, "Copies to the device, bytes of them, copies from it, bytes of them.");
}

}  // namespace

void bind_device(nb::module_& m) {
  nb::enum_<device::Target>(m, "Device", "What takes the place of the CPU's loop.")
      .value("host", device::Target::host, "the device code on the CPU, a lane after the other")
      .value("cuda", device::Target::cuda, "the first NVIDIA card");
  nb::enum_<Part>(m, "DevicePart", "Parts of the state that are taken from a device where they are asked for.")
      .value("places", Part::places)
      .value("nodes", Part::nodes)
      .value("sums", Part::sums)
      .value("reaction", Part::reaction)
      .value("elements", Part::elements)
      .value("damage", Part::damage)
      .value("contact", Part::contact);
  bind_for<double>(m, "DeviceSession");
  bind_for<float>(m, "DeviceSessionSingle");
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
