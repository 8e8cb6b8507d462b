// SPDX-License-Identifier: Apache-2.0
// Memory of the machine that computes cycles, and the copies of a loop's arrays there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace presswork::device {

class Memory {
 public:
  virtual ~Memory() = default;
  virtual void* give(std::size_t bytes) = 0;
  virtual void release(void* at) = 0;
  virtual void send(void* to, const void* from, std::size_t bytes) = 0;
  virtual void fetch(void* to, const void* from, std::size_t bytes) = 0;
  virtual void copy(void* to, const void* from, std::size_t bytes) = 0;  // from one place of it to another
  virtual void clear(void* at, std::size_t bytes) = 0;
  // What it has free, and in all [bytes].
  virtual void measure(double& free, double& all) = 0;
};

// That of the host build: beside the loop's own, so that what is not taken there or back is missed.
class HostMemory final : public Memory {
 public:
  explicit HostMemory(double limit) : limit_(limit) {}
  void* give(std::size_t bytes) override {
    void* made = std::aligned_alloc(line, (bytes + line - 1) / line * line);
    if (!made) throw std::runtime_error("there is no memory left");
    return made;
  }
  void release(void* at) override { std::free(at); }
  void send(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
  void fetch(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
  void copy(void* to, const void* from, std::size_t bytes) override { std::memcpy(to, from, bytes); }
  void clear(void* at, std::size_t bytes) override { std::memset(at, 0, bytes); }
  void measure(double& free, double& all) override { free = all = limit_; }

 private:
  static constexpr std::size_t line = 64;  // of the cache
  double limit_;
};

// What an array is, by when it is taken there and back.
enum class Part {
  fixed,     // taken there once
  given,     // what is given from outside between calls: temperatures, limits of friction
  scratch,   // never
  clock,     // taken there before each call
  table,     // the same, rows of the cycles of a call
  little,    // a handful of numbers, taken back after each call
  places,    // these where they are asked for: places of nodes
  nodes,     // their velocities and forces
  sums,      // what walls have pressed and rubbed at them
  reaction,  // impulses of what holds nodes
  elements,  // state of elements
  damage,    // of their points
  contact    // what nodes and edges remember of tools
};

struct Traffic {
  long sends = 0, fetches = 0;       // copies
  double sent = 0.0, fetched = 0.0;  // [bytes]
};

class Arrays {
 public:
  explicit Arrays(Memory& memory) : memory_(memory) {}
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;
  ~Arrays() {
    for (const Copy& each : copies_) {
      if (each.there) memory_.release(each.there);
      if (each.kept) memory_.release(each.kept);
    }
  }

  // All are listed first, so that their size is known before anything is computed. `array` becomes the pointer there.
  // Arrays whose pointers lie in another array are added before it.
  template <class Number>
  void add(Number*& array, std::size_t n, Part part) {
    auto* host = const_cast<std::remove_const_t<Number>*>(array);
    copies_.push_back({host, nullptr, nullptr, n * sizeof(Number), part, &array});
  }
  // What is to be kept once more (`keep`) counted twice [bytes].
  double needed() const {
    double sum = 0.0;
    for (const Copy& each : copies_) sum += static_cast<double>(each.bytes) * (changes(each) ? 2.0 : 1.0);
    return sum;
  }
  void make() {
    double free = 0.0, all = 0.0;
    memory_.measure(free, all);
    if (needed() > free) {
      char told[200];
      std::snprintf(told, sizeof told,
                    "the run needs %.3g GB on the card, which has %.3g GB free of %.3g: take precision = \"single\", "
                    "fewer shells, or device = \"cpu\"",
                    needed() * 1e-9, free * 1e-9, all * 1e-9);
      throw std::runtime_error(told);
    }
    for (Copy& each : copies_) {
      each.there = memory_.give(std::max<std::size_t>(each.bytes, 1));
      if (each.part != Part::scratch) send(each, each.bytes);
      *static_cast<void**>(each.pointer) = each.there;
    }
  }
  void send(Part part) {
    for (const Copy& each : copies_)
      if (each.part == part) send(each, each.bytes);
  }
  // Of each table the first n of `all` rows.
  void send_rows(std::size_t n, std::size_t all) {
    for (const Copy& each : copies_)
      if (each.part == Part::table) send(each, each.bytes / all * n);
  }
  void fetch(Part part) {
    for (const Copy& each : copies_)
      if (each.part == part) fetch(each.host, each.there, each.bytes);
  }
  void clear(Part part) {
    for (const Copy& each : copies_)
      if (each.part == part) memory_.clear(each.there, each.bytes);
  }
  // Bytes from anywhere there.
  void fetch(void* to, const void* there, std::size_t bytes) {
    if (bytes == 0) return;
    memory_.fetch(to, there, bytes);
    ++traffic.fetches, traffic.fetched += static_cast<double>(bytes);
  }
  // Keep all that changes as it is now, there; and let it be again as it was.
  void keep() {
    for (Copy& each : copies_) {
      if (!changes(each)) continue;
      if (!each.kept) each.kept = memory_.give(std::max<std::size_t>(each.bytes, 1));
      memory_.copy(each.kept, each.there, each.bytes);
    }
  }
  void put_back() {
    for (const Copy& each : copies_)
      if (changes(each)) memory_.copy(each.there, each.kept, each.bytes);
  }

  Traffic traffic;

 private:
  struct Copy {
    void *host, *there, *kept;
    std::size_t bytes;
    Part part;
    void* pointer;
  };
  static bool changes(const Copy& of) { return of.part >= Part::little; }
  void send(const Copy& of, std::size_t bytes) {
    if (bytes == 0) return;
    memory_.send(of.there, of.host, bytes);
    ++traffic.sends, traffic.sent += static_cast<double>(bytes);
  }

  Memory& memory_;
  std::vector<Copy> copies_;
};

}  // namespace presswork::device
