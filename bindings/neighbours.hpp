// SPDX-License-Identifier: Apache-2.0
// A part of a mesh whose neighbours Python tells and asks: by messages of MPI, which the core does not know.
#pragma once

#include "arrays.hpp"
#include "explicit/neighbours.hpp"
#include "explicit/space/loop.hpp"

namespace presswork::bindings {

namespace parts {

using explicit_dynamics::Neighbours;
using Buffer = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

// messages: an object with send, propose, receive, agree and find_largest, and the arrays that they send and fill.
class PythonNeighbours final : public Neighbours {
 public:
  PythonNeighbours(const nb::object& messages, Buffer sends, Buffer receives, Buffer shares)
      : send_(messages.attr("send")),
        propose_(messages.attr("propose")),
        receive_(messages.attr("receive")),
        agree_(messages.attr("agree")),
        find_largest_(messages.attr("find_largest")),
        arrays_{std::move(sends), std::move(receives), std::move(shares)} {
    out = arrays_[0].data(), in = arrays_[1].data(), shared = arrays_[2].data();
  }
  void send() override { call(send_); }
  void propose() override { call(propose_); }
  void receive() override { call(receive_); }
  void agree() override { call(agree_); }
  void find_largest(double* numbers, int n) override {
    nb::gil_scoped_acquire acquire;
    const nb::ndarray<nb::numpy, double, nb::ndim<1>> view(numbers, {std::size_t(n)}, nb::handle());
    find_largest_(nb::cast(view, nb::rv_policy::reference));
  }

 private:
  static void call(const nb::object& function) {
    nb::gil_scoped_acquire acquire;
    function();
  }
  nb::object send_, propose_, receive_, agree_, find_largest_;
  Buffer arrays_[3];
};

template <class Loop>
void join(Loop& self, const nb::object& messages, Ints sent, Ints ghosts, Buffer out, Buffer in, Buffer shared,
          bool leads) {
  require(out.ndim() == 2 && in.ndim() == 2 && out.shape(0) == sent.size() && in.shape(0) == ghosts.size() &&
              out.shape(1) == in.shape(1),
          "out and into must have shape (nodes, n)");
  require(shared.size() >= 1, "shared must have room for the largest speed");
  auto neighbours = std::make_unique<PythonNeighbours>(messages, out, in, shared);
  neighbours->sent.assign(sent.data(), sent.data() + sent.size());
  neighbours->ghosts.assign(ghosts.data(), ghosts.data() + ghosts.size());
  neighbours->is_ghost.assign(self.nodes.n, 0);
  neighbours->record = static_cast<int>(out.shape(1));
  neighbours->leads = leads, neighbours->n_shared = static_cast<int>(shared.size());
  for (const auto& nodes : {neighbours->sent, neighbours->ghosts})
    for (int node : nodes) require(node >= 0 && node < self.nodes.n, "there is no node of this number");
  for (int node : neighbours->ghosts) neighbours->is_ghost[node] = 1;
  self.join(std::move(neighbours));
}

template <class Loop>
auto list_edges(const Loop& self) {
  const int n = self.contact ? self.contact->n_edges() : 0;
  int* to;
  auto array = new_array({std::size_t(n), 2}, &to);
  for (int edge = 0; edge < n; ++edge)
    for (int end = 0; end < 2; ++end) *to++ = self.contact->edge_node(edge, end);
  return array;
}

}  // namespace parts

template <class Loop>
void bind_join(nb::class_<Loop>& loop) {
  using namespace parts;
  loop.def("join", &join<Loop>, nb::arg("messages"), nb::arg("sent"), nb::arg("ghosts"), nb::kw_only(), nb::arg("out"),
           nb::arg("into"), nb::arg("shared"), nb::arg("leads"),
           "Let the loop be one of those on the parts of a mesh, before it has tools. sent: own nodes whose motion "
           "goes out, ghosts: nodes of others whose motion comes in, those of each neighbour together. messages: has "
           "send, propose, receive and agree, called once a cycle each, and find_largest; out (sent, k), into (ghosts, "
           "k): what is sent and has come, k = 8 where there is a sheet, 3 of solids in space, 2 in the plane; shared "
           "(1 + 3 for each tool of a sheet + 4 for each of solids in space, 2 in the plane): the first becomes the "
           "largest, the others the sums of all parts'.")
      .def_prop_ro(
          "nodal_masses",
          [](Loop& self) {
            const std::vector<double> from = self.sum_all_masses();
            double* to;
            auto array = new_array({std::size_t(self.nodes.n), from.size() / self.nodes.n}, &to);
            std::copy(from.begin(), from.end(), to);
            return array;
          },
          nb::rv_policy::move, "Masses of the nodes, in space with rotary inertias (n_nodes, 1 | 2) [t, t mm2].")
      .def(
          "set_ghost_masses",
          [](Loop& self, Doubles masses) {
            require(self.parts() && masses.ndim() == 2 && masses.shape(0) == std::size_t(self.nodes.n) &&
                        masses.shape(1) == std::size_t(self.nodes.masses),
                    "masses must have shape (n_nodes, 1 | 2), of a part that has joined the others");
            self.set_ghost_masses({masses.data(), masses.data() + masses.size()});
          },
          nb::arg("masses"), "Let ghosts have masses as nodal_masses gives them, of the whole mesh.");
}

template <class Loop>
void bind_parts(nb::class_<Loop>& loop) {
  using namespace parts;
  bind_join(loop);
  loop.def(
          "set_tool_forces",
          [](Loop& self, Doubles force) {
            require(self.contact && force.size() == 3 * self.contact->tools.size(), "force must have shape (tools, 3)");
            const double* from = force.data();
            for (auto& tool : self.contact->tools) std::copy_n(from, 3, tool.force), from += 3;
          },
          nb::arg("force"), "Set this part's share of the sheet's forces on tools (tools, 3) [N].")
      .def_prop_ro("edges", &list_edges<Loop>, nb::rv_policy::move, "Nodes of the edges that tools touch (n, 2).")
      .def_prop_rw(
          "sheet_sizes", [](const Loop& self) { return self.measure_sheet(); },
          [](Loop& self, std::array<double, 3> sizes) { self.sheet_sizes = sizes; },
          "Least thickness, widest shell and mean edge [mm], by which contact looks for what is near; those of the "
          "whole sheet are to be given to its parts, before there are tools.");
}

}  // namespace presswork::bindings
