#include "integrators/render.h"

#include <catch2/catch.hpp>

#include "core/cancellation.h"
#include "core/parallel.h"

using namespace alabaster;

namespace {

// A value that depends on pixel and sample alone, as an integrator's must.
class Pattern final : public Integrator {
 public:
  PixelSample sample(int x, int y, const Sampler& sampler) const override {
    PixelSample s;
    const Vec2 u = sampler.get_2d(Dimension::pixel);
    s.radiance = Rgb(x + u.x, y + u.y, u.x * u.y);
    s.alpha = 1;
    s.hit = x % 2 == 0;
    s.depth = u.y;
    if (cancel_at_ > 0 && y == cancel_at_) request_cancellation();
    return s;
  }
  int width() const override { return 37; }
  int height() const override { return 29; }
  int cancel_at_ = 0;
};

bool same(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height() || a.channels() != b.channels()) return false;
  for (std::size_t c = 0; c < a.channels().size(); ++c)
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x)
        if (a.at(static_cast<int>(c), x, y) != b.at(static_cast<int>(c), x, y)) return false;
  return true;
}

}  // namespace

TEST_CASE("one, two and three threads render the same image, bit for bit") {
  const Pattern pattern;
  RenderOptions options;
  options.spp = 20;
  set_thread_count(1);
  const Image one = render(pattern, options).film.develop();
  for (const int threads : {2, 3}) {
    set_thread_count(threads);
    CHECK(same(one, render(pattern, options).film.develop()));
  }
  set_thread_count(0);
}

TEST_CASE("a crop is exactly that part of the whole image") {
  const Pattern pattern;
  RenderOptions options;
  options.spp = 5;
  const Image whole = render(pattern, options).film.develop();
  options.crop = PixelRectangle{7, 3, 30, 29};
  const Image part = render(pattern, options).film.develop();
  REQUIRE(part.width() == 23);
  REQUIRE(part.height() == 26);
  for (std::size_t c = 0; c < whole.channels().size(); ++c)
    for (int y = 0; y < part.height(); ++y)
      for (int x = 0; x < part.width(); ++x)
        REQUIRE(part.at(static_cast<int>(c), x, y) == whole.at(static_cast<int>(c), x + 7, y + 3));
}

TEST_CASE("more samples continue fewer: the sums of the first k are the same") {
  const Pattern pattern;
  RenderOptions options;
  for (const uint32_t spp : {1u, 3u, 64u, 100u}) {
    options.spp = spp;
    const RenderResult result = render(pattern, options);
    CHECK(result.complete);
    CHECK(result.fewest == spp);
    CHECK(result.most == spp);
    CHECK(result.samples == spp * 37u * 29u);
  }
}

TEST_CASE("a stop keeps every finished sample") {
  Pattern pattern;
  pattern.cancel_at_ = 20;
  RenderOptions options;
  options.spp = 1000;
  set_thread_count(1);
  const RenderResult result = render(pattern, options);
  clear_cancellation();
  set_thread_count(0);
  CHECK(result.cancelled);
  CHECK_FALSE(result.complete);
  CHECK(result.samples > 0);
  CHECK(result.fewest == 0);
  CHECK(result.most <= 2);
  CHECK(result.film.total_count() == result.samples);
}

TEST_CASE("a time limit ends a render that would go on for ever, with the passes that fitted") {
  const Pattern pattern;
  RenderOptions options;
  options.spp = 1u << 30;
  options.time_limit = 0.1;
  const RenderResult result = render(pattern, options);
  CHECK_FALSE(result.complete);
  CHECK_FALSE(result.cancelled);
  CHECK(result.fewest >= 1);
  CHECK(result.most < options.spp);
}

TEST_CASE("samples that are not finite are counted and left out") {
  class Broken final : public Integrator {
   public:
    PixelSample sample(int x, int, const Sampler&) const override {
      PixelSample s;
      s.radiance = Rgb(x == 0 ? std::nan("") : 1.0);
      return s;
    }
    int width() const override { return 2; }
    int height() const override { return 1; }
  };
  RenderOptions options;
  options.spp = 4;
  const RenderResult result = render(Broken(), options);
  CHECK(result.rejected == 4);
  CHECK(result.film.develop().at(0, 0, 0) == 0);
  CHECK(result.film.develop().at(0, 1, 0) == 1);
}
