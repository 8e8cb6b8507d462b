// SPDX-License-Identifier: Apache-2.0
// A grid of cubes: every face of the master is listed in the cubes that its box meets.
#include <algorithm>
#include <cmath>

#include "contact/face_interface.hpp"
#include "contact/vectors.hpp"

namespace presswork {

namespace {

using contact::cross;
using contact::dot;

struct FaceBox {
  double low[3], high[3], normal[3];

  FaceBox(const FaceList& list, int face, const double* x) {
    const int* f = list.at(face);
    for (int k = 0; k < 3; ++k) {
      low[k] = high[k] = x[3 * f[0] + k];
      for (int i = 1; i < list.nodes; ++i)
        low[k] = std::min(low[k], x[3 * f[i] + k]), high[k] = std::max(high[k], x[3 * f[i] + k]);
    }
    double a[3], b[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = x[3 * f[list.nodes == 3 ? 1 : 2] + k] - x[3 * f[0] + k];
      b[k] = x[3 * f[list.nodes == 3 ? 2 : 3] + k] - x[3 * f[list.nodes == 3 ? 0 : 1] + k];
    }
    cross(a, b, normal);
    const double size = std::sqrt(dot(normal, normal));
    for (double& n : normal) n /= size;
  }
  bool meets(const FaceBox& other, double margin) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > other.high[k] + margin || other.low[k] > high[k] + margin) return false;
    return true;
  }
};

struct Entry {
  std::int64_t cube;
  int face;
};

class Cubes {
 public:
  Cubes(const std::vector<FaceBox>& boxes, double side) : side_(side) {
    if (boxes.empty()) return;
    double high[3];
    for (int k = 0; k < 3; ++k) {
      low_[k] = boxes[0].low[k], high[k] = boxes[0].high[k];
      for (const auto& box : boxes) low_[k] = std::min(low_[k], box.low[k]), high[k] = std::max(high[k], box.high[k]);
    }
    // no more cubes along a side than an index holds
    for (int k = 0; k < 3; ++k) side_ = std::max(side_, (high[k] - low_[k]) / 1e6);
    for (int k = 0; k < 3; ++k) n_[k] = static_cast<std::int64_t>((high[k] - low_[k]) / side_) + 1;
    for (int face = 0; face < static_cast<int>(boxes.size()); ++face)
      visit(boxes[face], 0.0, [&](std::int64_t cube) { entries_.push_back({cube, face}); });
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return a.cube != b.cube ? a.cube < b.cube : a.face < b.face; });
  }

  // Faces listed in the cubes that a box grown by the margin meets, sorted.
  void list(const FaceBox& box, double margin, std::vector<int>& faces) const {
    faces.clear();
    if (entries_.empty()) return;
    visit(box, margin, [&](std::int64_t cube) {
      auto it = std::lower_bound(entries_.begin(), entries_.end(), cube,
                                 [](const Entry& entry, std::int64_t c) { return entry.cube < c; });
      for (; it != entries_.end() && it->cube == cube; ++it) faces.push_back(it->face);
    });
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  }

 private:
  template <class Function>
  void visit(const FaceBox& box, double margin, Function&& call) const {
    std::int64_t from[3], to[3];
    for (int k = 0; k < 3; ++k) {
      const double first = (box.low[k] - margin - low_[k]) / side_, last = (box.high[k] + margin - low_[k]) / side_;
      if (last < 0.0 || first >= static_cast<double>(n_[k])) return;
      from[k] = first <= 0.0 ? 0 : static_cast<std::int64_t>(first);
      to[k] = std::min(n_[k] - 1, static_cast<std::int64_t>(last));
    }
    for (auto i = from[0]; i <= to[0]; ++i)
      for (auto j = from[1]; j <= to[1]; ++j)
        for (auto k = from[2]; k <= to[2]; ++k) call((i * n_[1] + j) * n_[2] + k);
  }

  double side_, low_[3] = {0, 0, 0};
  std::int64_t n_[3] = {1, 1, 1};
  std::vector<Entry> entries_;
};

bool are_neighbours(const FaceList& list, int s, int m) {
  const int *a = list.at(s), *b = list.at(m);
  for (int i = 0; i < list.nodes; ++i)
    if (std::find(b, b + list.nodes, a[i]) != b + list.nodes) return true;
  return false;
}

std::vector<FaceBox> list_boxes(const FaceList& list, const double* x) {
  std::vector<FaceBox> boxes;
  boxes.reserve(list.n);
  for (int face = 0; face < list.n; ++face) boxes.emplace_back(list, face, x);
  return boxes;
}

}  // namespace

std::vector<FacePair> find_face_pairs(const FaceList& slave, const FaceList& master, const double* x, double margin,
                                      bool self) {
  const auto own = list_boxes(slave, x), others = list_boxes(master, x);
  const Cubes cubes(others, 2.0 * margin);
  std::vector<std::vector<FacePair>> found(slave.n);
#pragma omp parallel if (slave.n > 1000)
  {
    std::vector<int> faces;
#pragma omp for schedule(dynamic, 64)
    for (int s = 0; s < slave.n; ++s) {
      cubes.list(own[s], margin, faces);
      for (const int m : faces) {
        if (self && (m <= s || are_neighbours(slave, s, m))) continue;
        // faces that look at each other, or could after a turn of 30 degrees or so
        if (dot(own[s].normal, others[m].normal) < 0.3 && own[s].meets(others[m], margin)) found[s].push_back({s, m});
      }
    }
  }
  std::vector<FacePair> pairs;
  for (const auto& of_face : found) pairs.insert(pairs.end(), of_face.begin(), of_face.end());
  return pairs;
}

}  // namespace presswork
