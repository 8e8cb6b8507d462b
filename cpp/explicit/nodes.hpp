// SPDX-License-Identifier: Apache-2.0
// What nodes of the explicit loop are kept in: arrays on cache lines, and records that are loaded whole.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace presswork::explicit_dynamics {

// An array that starts on a cache line and is not copied. A large one asks for large pages: packs that follow each
// other then share a page, and a step spends no time on finding them.
template <class Real>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : size_(size) {
    constexpr std::size_t line = 64, page = std::size_t(2) << 20;
    const std::size_t bytes = size * sizeof(Real), align = bytes >= 2 * page ? page : line;
    data_.reset(static_cast<Real*>(std::aligned_alloc(align, (bytes + align - 1) / align * align)));
    if (!data_ && size > 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (align == page) madvise(data_.get(), (bytes + align - 1) / align * align, MADV_HUGEPAGE);
#endif
    std::fill_n(data_.get(), size, Real(0));
  }
  Real* data() { return data_.get(); }
  const Real* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(Real* data) const { std::free(data); }
  };
  std::unique_ptr<Real[], Free> data_;
  std::size_t size_ = 0;
};

// What a step does with a node, for its six freedoms at once and two numbers more: one vector, on any CPU.
typedef double Record __attribute__((vector_size(64)));
typedef std::int64_t Freedoms __attribute__((vector_size(64)));  // which of them: -1, or 0

// Nodes whose work is summed up in one go: the sums do not depend on the threads.
inline constexpr int chunk = 256;
inline int count_chunks(int n) { return (n + chunk - 1) / chunk; }

// Forces and such are rows of six, with room for a record at the last.
inline constexpr int freedoms = 6, spare = 2;
inline std::size_t row_at(int i) { return std::size_t(freedoms) * i; }

// Eight numbers from anywhere; of a row of six the last two are of the row that follows.
inline Record load_record(const double* from) {
  Record r;
  std::memcpy(&r, from, sizeof r);
  return r;
}
inline Record load_record(const float* from) {
  float __attribute__((vector_size(32))) r;
  std::memcpy(&r, from, sizeof r);
  return __builtin_convertvector(r, Record);
}
// The first `count` of them.
template <int count>
inline void store_record(const Record& r, double* to) {
  std::memcpy(to, &r, count * sizeof(double));
}
template <int count>
inline void store_record(const Record& r, float* to) {
  const auto narrow = __builtin_convertvector(r, float __attribute__((vector_size(32))));
  std::memcpy(to, &narrow, count * sizeof(float));
}

typedef double Place __attribute__((vector_size(32)));  // x, y, z and one unused

inline Place load_place(const double* from) {
  Place p;
  std::memcpy(&p, from, sizeof p);
  return p;
}
inline void store_place(const Place& p, double* to) { std::memcpy(to, &p, sizeof p); }

}  // namespace presswork::explicit_dynamics
