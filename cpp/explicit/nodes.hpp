// SPDX-License-Identifier: Apache-2.0
// Nodes of the explicit loop: six freedoms each, lumped mass, as records that an element loads whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace presswork::explicit_dynamics {

// An array that starts on a cache line and is not copied.
template <class Real>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : raw_(size + 64 / sizeof(Real), Real(0)), size_(size) {
    const auto at = reinterpret_cast<std::uintptr_t>(raw_.data());
    data_ = raw_.data() + ((64 - at % 64) % 64) / sizeof(Real);
  }
  AlignedArray(const AlignedArray&) = delete;
  AlignedArray& operator=(const AlignedArray&) = delete;
  AlignedArray(AlignedArray&&) = default;
  AlignedArray& operator=(AlignedArray&&) = default;
  Real* data() { return data_; }
  const Real* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  std::vector<Real> raw_;
  Real* data_ = nullptr;
  std::size_t size_ = 0;
};

// Positions are double in single precision too: a step moves a node by less than a float of its coordinate resolves.
template <class Real>
struct Nodes {
  static constexpr int position_stride = 4, motion_stride = 8;
  explicit Nodes(int n) : n(n), position(std::size_t(n) * position_stride), motion(std::size_t(n) * motion_stride) {}

  int n;
  AlignedArray<double> position;  // (n, 4): x, y, z [mm], unused
  AlignedArray<Real> motion;  // (n, 8): velocity [mm/s], angular velocity [1/s] (half a step back), 1/mass, 1/inertia
};

}  // namespace presswork::explicit_dynamics
