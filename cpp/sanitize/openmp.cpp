// SPDX-License-Identifier: Apache-2.0
// OpenMP's runtime, as far as this code calls it, on the threads and barriers that the thread sanitizer knows: it
// cannot see into the compiler's own runtime, and takes every barrier of it for none. Linked in place of that with
// PRESSWORK_SANITIZE=thread alone. Parallel regions are not nested.
#include <pthread.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <vector>

namespace {

struct Team {
  int n;
  pthread_barrier_t barrier;
  std::mutex mutex;
  int singles = 0;  // `single` regions that a thread of the team has entered
};
struct Member {
  Team* team = nullptr;
  int number = 0, singles = 0;
};
thread_local Member member;
std::mutex critical;
int most_threads = std::max(1, std::atoi(std::getenv("OMP_NUM_THREADS") ? std::getenv("OMP_NUM_THREADS") : "2"));

void run(void (*body)(void*), void* data, Team* team, int number) {
  member = {team, number, 0};
  body(data);
  member = {};
}

}  // namespace

extern "C" {

int omp_get_max_threads() { return most_threads; }
void omp_set_num_threads(int n) { most_threads = n; }
int omp_get_num_threads() { return member.team ? member.team->n : 1; }
int omp_get_thread_num() { return member.number; }

void GOMP_parallel(void (*body)(void*), void* data, unsigned n_threads, unsigned) {
  Team team{n_threads > 0 ? static_cast<int>(n_threads) : omp_get_max_threads(), {}, {}};
  pthread_barrier_init(&team.barrier, nullptr, static_cast<unsigned>(team.n));
  std::vector<std::thread> others;
  for (int i = 1; i < team.n; ++i) others.emplace_back(run, body, data, &team, i);
  run(body, data, &team, 0);
  for (auto& other : others) other.join();
  pthread_barrier_destroy(&team.barrier);
}

void GOMP_barrier() {
  if (member.team) pthread_barrier_wait(&member.team->barrier);
}

// True for the first thread that comes to a `single` region.
bool GOMP_single_start() {
  if (!member.team) return true;
  const std::lock_guard lock(member.team->mutex);
  if (member.singles++ != member.team->singles) return false;
  ++member.team->singles;
  return true;
}

void GOMP_critical_start() { critical.lock(); }
void GOMP_critical_end() { critical.unlock(); }
}
