// SPDX-License-Identifier: Apache-2.0
#include "element/hex_one_point.hpp"
#include "explicit/space/solids.hpp"

namespace presswork::explicit_dynamics {

namespace {

template <class Law>
class OnePointBlock final : public SpaceSolids {
  static constexpr int count = Hex8::nodes, record = Nodes::record(count);
  using Kernel = HexOnePoint<Pack>;

 public:
  OnePointBlock(std::vector<int> cells, const Nodes& nodes, Owned<Law> law, double density, double fraction)
      : SpaceSolids(count, std::move(cells), Kernel::point, 1, kept_values(law.view), Kernel::work,
                    Kernel::hourglass_work),
        law_(std::move(law)),
        fraction_(fraction) {
    set_masses<Hex8, 8>(nodes, density);
  }

  int advance(const Nodes& nodes, double dt, double time, int first, int last, double* force) override {
    int failed = -1;
    LawOfPack<Law, 1> law(law_.view);
    for (int pack = first; pack < last; ++pack, force += record * lanes) {
      Pack x[count][3], du[count][3], spin[count][3], nodal[record];
      expect_pack(pack + 1);
      gather_positions<count>(nodes, pack_nodes(pack), x);
      gather_motion<count>(nodes, pack_nodes(pack), du, spin);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) du[a][i] *= Pack(dt), nodal[freedoms * a + 3 + i] = Pack(0.0);
      const Pack* degrees = pack_temperature(pack);
      const Pack given = degrees ? *degrees : Pack(start_temperature(law_.view));
      Pack::Mask no_stress = Pack(1.0) < Pack(0.0);
      law.template begin<Hex8>(place_of(pack, time, dt), x);
      const Pack::Mask bad =
          Kernel::advance(law.at(0), fraction_, dt, given, x, du, pack_state(pack), nodal, freedoms, no_stress);
      if (any(bad) || any(no_stress)) {
        if (failed < 0) failed = name_failed(pack, bad, no_stress, law.told());
        continue;
      }
      double* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + record * lane;
      store_records<record>(nodal, to);
    }
    return failed;
  }

  SpaceSection section() const override { return make_section(SpaceSection::Kind::one_point, law_.view, fraction_); }

  void bound_frequencies(const Nodes& nodes, double* squared) const override {
    const double bulk = law_.view.bulk_modulus(), shear = law_.view.shear_modulus();
#pragma omp parallel for schedule(static) if (n_ >= Nodes::serial_elements)
    for (int pack = 0; pack < n_packs(); ++pack) {
      Pack x[count][3], mass[count];
      gather_positions<count>(nodes, pack_nodes(pack), x);
      load_masses(pack, mass);
      const Pack bound = Kernel::bound_frequency(bulk, shear, fraction_, x, mass);
      for (int lane = 0; lane < std::min(lanes, n_ - pack * lanes); ++lane) squared[pack * lanes + lane] = bound[lane];
    }
  }

  void list_state(const std::string& owner, std::vector<StateField>& fields) override {
    SpaceSolids::list_state(owner, fields);
    fields.push_back(rows_field(owner, "work", Kernel::work, 2));
    fields.push_back(rows_field(owner, "hourglass", Kernel::hourglass, 3 * Kernel::modes));
  }

 private:
  Owned<Law> law_;
  double fraction_;
};

}  // namespace

std::unique_ptr<SpaceSolids> make_one_point_hexahedra(std::vector<int> cells, const SpaceNodes<double>& nodes,
                                                      SpaceSolidLaw law, double density, double hourglass_fraction) {
  return std::visit(
      [&]<class Law>(Owned<Law>& chosen) -> std::unique_ptr<SpaceSolids> {
        return std::make_unique<OnePointBlock<Law>>(std::move(cells), nodes, std::move(chosen), density,
                                                    hourglass_fraction);
      },
      law);
}

}  // namespace presswork::explicit_dynamics
