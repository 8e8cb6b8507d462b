// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "assembly/assembler.hpp"
#include "assembly/dissection.hpp"
#include "assembly/krylov.hpp"

namespace presswork::bindings {

namespace {

std::vector<const double*> pointers(const std::vector<Doubles>& arrays) {
  std::vector<const double*> result;
  for (const auto& a : arrays) result.push_back(a.data());
  return result;
}

template <int D>
void bind_assembler(nb::module_& m, const char* name, const char* doc) {
  using Assembler = presswork::Assembler<D>;
  constexpr std::size_t frame_values = Assembler::frame_size * Assembler::frame_size;
  nb::class_<Assembler>(m, name, doc)
      .def(
          "__init__",
          [](Assembler* self, int n_nodes, const std::vector<Ints>& connectivity, bool symmetric,
             std::optional<Ints> couplings) {
            std::vector<BlockConnectivity> blocks;
            for (const auto& c : connectivity)
              blocks.push_back({static_cast<int>(c.shape(0)), static_cast<int>(c.shape(1)), c.data()});
            const int n_couplings = couplings ? static_cast<int>(couplings->shape(0)) : 0;
            require(!couplings || couplings->size() == 2 * std::size_t(n_couplings),
                    "couplings must have shape (n, 2)");
            for (int i = 0; i < 2 * n_couplings; ++i)
              require(couplings->data()[i] >= 0 && couplings->data()[i] < n_nodes, "couplings must be node indices");
            new (self) Assembler(n_nodes, blocks, symmetric, n_couplings, couplings ? couplings->data() : nullptr);
          },
          nb::arg("n_nodes"), nb::arg("connectivity"), nb::arg("symmetric"), nb::arg("couplings") = nb::none())
      .def_prop_ro("indptr",
                   [](const Assembler& a) {
                     return nb::ndarray<nb::numpy, const int>(a.indptr().data(), {a.indptr().size()}, nb::find(a));
                   })
      .def_prop_ro("indices",
                   [](const Assembler& a) {
                     return nb::ndarray<nb::numpy, const int>(a.indices().data(), {a.indices().size()}, nb::find(a));
                   })
      .def(
          "assemble_matrix",
          [](const Assembler& a, const std::vector<Doubles>& stiffness, Bytes turned, Doubles frames,
             MutableDoubles data) {
            require(turned.size() == std::size_t(a.n_nodes()) && frames.size() == frame_values * turned.size(),
                    "turned (n_nodes) and frames (n_nodes, F, F), F = 2 in the plane, else 3");
            require(data.size() == a.indices().size(), "data must have the length of indices");
            const auto sources = pointers(stiffness);
            nb::gil_scoped_release release;
            a.assemble_matrix(sources, turned.data(), frames.data(), data.data());
          },
          nb::arg("stiffness"), nb::arg("turned"), nb::arg("frames"), nb::arg("data"),
          "Fill data from element stiffnesses; marked nodes take their freedoms in their own frame.")
      .def(
          "add_blocks",
          [](const Assembler& a, Ints pairs, Doubles blocks, Bytes turned, Doubles frames, MutableDoubles data) {
            require(2 * blocks.size() == D * D * pairs.size(), "pairs (n, 2) and blocks (n, D, D)");
            a.add_blocks(static_cast<int>(pairs.shape(0)), pairs.data(), blocks.data(), turned.data(), frames.data(),
                         data.data());
          },
          nb::arg("pairs"), nb::arg("blocks"), nb::arg("turned"), nb::arg("frames"), nb::arg("data"),
          "Add blocks (n, D, D) at node pairs (n, 2).")
      .def(
          "assemble_vector",
          [](const Assembler& a, const std::vector<Doubles>& element_force) {
            double* force;
            auto result = new_array({static_cast<std::size_t>(a.n_nodes()), D}, &force);
            a.assemble_vector(pointers(element_force), force);
            return result;
          },
          nb::arg("element_force"), "Nodal force (n_nodes, D) of packed element forces.")
      .def(
          "constrain",
          [](const Assembler& a, Bytes mask, Doubles value, double scale, MutableDoubles data, MutableDoubles rhs) {
            const std::size_t n = D * static_cast<std::size_t>(a.n_nodes());
            require(mask.size() == n && value.size() == n && rhs.size() == n, "mask, value, rhs: length D n_nodes");
            nb::gil_scoped_release release;
            a.constrain(mask.data(), value.data(), scale, data.data(), rhs.data());
          },
          nb::arg("mask"), nb::arg("value"), nb::arg("scale"), nb::arg("data"), nb::arg("rhs"),
          "Prescribe the masked freedoms in the matrix and the right-hand side.");
}

}  // namespace

void bind_assembly(nb::module_& m) {
  bind_assembler<1>(m, "ScalarAssembler", "Sparsity pattern and scatter of element arrays, one freedom a node.");
  bind_assembler<2>(m, "Assembler", "Sparsity pattern and scatter of element arrays, two freedoms a node.");
  bind_assembler<3>(m, "SpaceAssembler", "The same with three freedoms a node.");
  bind_assembler<4>(m, "MixedAssembler", "The same with four freedoms a node, displacement and pressure.");
  bind_assembler<6>(m, "ShellAssembler", "The same with six freedoms a node, rotations in the nodes' frames.");
  m.def(
      "solve_iteratively",
      [](Ints indptr, Ints indices, Doubles data, Doubles rhs, bool symmetric, double tolerance,
         int most_iterations) -> std::optional<NewDoubles> {
        require(indptr.size() == rhs.size() + 1 && indices.size() == data.size(),
                "indptr (n + 1), indices and data (nnz), rhs (n)");
        double* x;
        auto result = new_array({rhs.size()}, &x);
        const SparseMatrix matrix{static_cast<int>(rhs.size()), indptr.data(), indices.data(), data.data(), symmetric};
        if (!solve_iteratively(matrix, rhs.data(), tolerance, most_iterations, x)) return std::nullopt;
        return result;
      },
      nb::arg("indptr"), nb::arg("indices"), nb::arg("data"), nb::arg("rhs"), nb::kw_only(), nb::arg("symmetric"),
      nb::arg("tolerance"), nb::arg("most_iterations"),
      "Solution (n,) of a sparse system by conjugate gradients to a residual of tolerance times that of rhs; None if "
      "it "
      "is far.\n\nsymmetric: only one triangle is stored.");
  m.def(
      "dissect",
      [](Doubles points, Ints indptr, Ints indices) {
        require(points.ndim() == 2 && points.shape(1) == 2, "points must have shape (n, 2)");
        const std::size_t n = points.shape(0), rows = indptr.size() - 1;
        require(n > 0 && rows % n == 0, "as many rows of the pattern at every point");
        int* order;
        auto result = new_array({n}, &order);
        const auto found =
            dissect(points.data(), static_cast<int>(n), indptr.data(), indices.data(), static_cast<int>(rows / n));
        std::copy(found.begin(), found.end(), order);
        return result;
      },
      nb::arg("points"), nb::arg("indptr"), nb::arg("indices"),
      "Nodes of a mesh in the plane in an order of elimination (n,) that keeps factors sparse: nested dissection by "
      "coordinates.\n\npoints (n, 2); indptr, indices: the pattern of a matrix, as many rows at every node.");
}

}  // namespace presswork::bindings
