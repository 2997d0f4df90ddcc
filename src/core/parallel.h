#pragma once

#include <cstddef>
#include <functional>

namespace alabaster {

/// Limits every later parallel_for to `count` threads; 0 means all cores. Not thread-safe: call it at
/// start-up.
void set_thread_count(int count);
int thread_count();

/// Calls body(begin, end) on disjoint ranges that cover [0, count), each at most `grain` long. Returns when
/// all are done. If bodies throw, the first exception is rethrown here and ranges not yet begun are dropped.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& body);

/// CPU time (user + system) of the process so far, seconds.
double cpu_seconds();
/// Monotonic wall clock, seconds.
double wall_seconds();

}  // namespace alabaster
