#include "image/exr_file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

Image numbered(int width, int height, std::vector<std::string> names) {
  Image image(width, height, std::move(names));
  for (int c = 0; c < static_cast<int>(image.channels().size()); ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) image.at(c, x, y) = static_cast<float>(c + 0.25 * x + 16 * y);
  return image;
}

// What other renderers write: half, tiled, with a data window beside the display window.
void write_foreign(const std::filesystem::path& path, bool tiled, const Imath::Box2i& display,
                   const Imath::Box2i& data, const std::vector<std::string>& names) {
  Imf::Header header(display, data);
  if (tiled) header.setTileDescription(Imf::TileDescription(16, 16, Imf::ONE_LEVEL));
  const int w = data.max.x - data.min.x + 1, h = data.max.y - data.min.y + 1;
  std::vector<std::vector<half>> planes;
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < names.size(); ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::HALF));
    planes.emplace_back(static_cast<std::size_t>(w * h));
    for (int i = 0; i < w * h; ++i)
      planes[c][static_cast<std::size_t>(i)] = half(static_cast<float>(static_cast<double>(c) + 0.5 * i));
  }
  for (std::size_t c = 0; c < names.size(); ++c)
    buffer.insert(names[c], Imf::Slice::Make(Imf::HALF, planes[c].data(), data.min, w, h, sizeof(half),
                                             sizeof(half) * static_cast<std::size_t>(w)));
  if (tiled) {
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(h);
  }
}

}  // namespace

TEST_CASE("an EXR file comes back bit for bit, channels in reading order") {
  const ScratchFolder folder;
  Image image = numbered(7, 5, {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "depth.Z"});
  image.at(0, 3, 2) = std::numeric_limits<float>::infinity();
  image.at(1, 3, 2) = std::nanf("");
  image.at(2, 3, 2) = 1e-42f;
  write_exr(folder / "a.exr", image, {{"alabaster", "version 1"}, {"command", "render x"}});
  const ExrFile read = read_exr(folder / "a.exr");
  REQUIRE(read.image.width() == 7);
  REQUIRE(read.image.height() == 5);
  CHECK(read.image.channels() ==
        std::vector<std::string>{"R", "G", "B", "A", "depth.Z", "variance.R", "variance.G", "variance.B"});
  CHECK(read.attributes.at("command") == "render x");
  for (const std::string& name : image.channels())
    for (int i = 0; i < 35; ++i) {
      const float a = image.plane(image.find(name))[i], b = read.image.plane(read.image.find(name))[i];
      REQUIRE((a == b || (std::isnan(a) && std::isnan(b))));
    }
}

TEST_CASE("half-float, tiled and layered files of other renderers are read") {
  const ScratchFolder folder;
  const Imath::Box2i box({0, 0}, {39, 29});
  for (const bool tiled : {false, true}) {
    write_foreign(folder / "b.exr", tiled, box, box,
                  {"ViewLayer.Combined.A", "ViewLayer.Combined.B", "ViewLayer.Combined.G",
                   "ViewLayer.Combined.R", "ViewLayer.Depth.Z", "ViewLayer.Normal.X"});
    const Image image = read_exr(folder / "b.exr").image;
    REQUIRE(image.width() == 40);
    const auto colour = find_colour(image);
    REQUIRE(colour);
    CHECK(colour->layer == "ViewLayer.Combined");
    CHECK(colour->rgb == std::array<int, 3>{0, 1, 2});
    CHECK(colour->get(image, 1, 0) == Rgb(3.5, 2.5, 1.5));
    CHECK(image.at(colour->alpha, 0, 1) == 20.0f);
  }
}

TEST_CASE("pixels stand where the display window puts them") {
  const ScratchFolder folder;
  write_foreign(folder / "crop.exr", false, {{0, 0}, {9, 9}}, {{4, 6}, {11, 8}}, {"R", "G", "B"});
  const Image image = read_exr(folder / "crop.exr").image;
  REQUIRE(image.width() == 10);
  REQUIRE(image.height() == 10);
  CHECK(image.at(0, 4, 6) == 0.0f);
  CHECK(image.at(1, 5, 6) == 1.5f);
  CHECK(image.at(1, 4, 7) == 1.0f + 0.5f * 8);
  CHECK(image.at(1, 3, 6) == 0.0f);
  CHECK(image.at(1, 4, 9) == 0.0f);
}

TEST_CASE("colour is found in plain, lower-case, grey and auxiliary-laden files") {
  CHECK(find_colour(Image(1, 1, {"albedo.R", "albedo.G", "albedo.B", "R", "G", "B"}))->rgb[0] == 3);
  CHECK(find_colour(Image(1, 1, {"albedo.R", "albedo.G", "albedo.B", "light.R", "light.G", "light.B"}))
            ->layer == "light");
  CHECK(find_colour(Image(1, 1, {"r", "g", "b"}))->rgb == std::array<int, 3>{0, 1, 2});
  CHECK(find_colour(Image(1, 1, {"Y"}))->rgb == std::array<int, 3>{0, 0, 0});
  CHECK_FALSE(find_colour(Image(1, 1, {"R", "G", "depth.Z"})));
}

TEST_CASE("unusable EXR files are refused in one line") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(read_exr(folder / "missing.exr"), InputError);
  write_text_atomically(folder / "text.exr", "not a picture");
  CHECK_THROWS_AS(read_exr(folder / "text.exr"), InputError);
  write_exr(folder / "whole.exr", numbered(64, 64, {"R", "G", "B"}));
  const std::string bytes = read_text(folder / "whole.exr");
  for (const double part : {0.02, 0.1, 0.5, 0.95}) {
    write_text_atomically(folder / "cut.exr", std::string_view(bytes).substr(
                                                  0, static_cast<std::size_t>(part * double(bytes.size()))));
    try {
      read_exr(folder / "cut.exr");
      FAIL("a truncated file was accepted");
    } catch (const InputError& error) {
      CHECK(std::string(error.what()).find('\n') == std::string::npos);
      CHECK(std::string(error.what()).find("cut.exr") != std::string::npos);
    }
  }
  CHECK_THROWS_AS(write_exr(folder / "empty.exr", Image(0, 0, {"R"})), InputError);
}
