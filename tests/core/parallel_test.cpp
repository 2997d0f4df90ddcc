#include "core/parallel.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <vector>

using namespace alabaster;

TEST_CASE("parallel_for visits every index once in ranges no longer than the grain") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{1000}}) {
    std::vector<std::atomic<int>> visits(count);
    std::atomic<bool> too_long{false};
    parallel_for(count, 7, [&](std::size_t begin, std::size_t end) {
      if (end - begin > 7) too_long = true;
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    CHECK_FALSE(too_long);
    for (const auto& v : visits) REQUIRE(v == 1);
  }
}

TEST_CASE("parallel_for hands an exception to its caller") {
  CHECK_THROWS_AS(parallel_for(100, 1,
                               [](std::size_t begin, std::size_t) {
                                 if (begin == 50) throw std::runtime_error("fifty");
                               }),
                  std::runtime_error);
}

TEST_CASE("set_thread_count limits the threads at work") {
  set_thread_count(1);
  CHECK(thread_count() == 1);
  std::atomic<int> at_work{0}, most{0};
  parallel_for(64, 1, [&](std::size_t, std::size_t) {
    const int now = ++at_work;
    if (now > most) most = now;
    --at_work;
  });
  set_thread_count(0);
  CHECK(most == 1);
  CHECK(thread_count() >= 1);
}
