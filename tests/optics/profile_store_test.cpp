#include "optics/profile_store.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <thread>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/progress.h"
#include "optics/bake.h"
#include "optics/mixture_profile.h"
#include "support/paths.h"

using namespace alabaster;

namespace {

constexpr uint64_t few = 1;  // one chunk of photons
const ProfileRequest other{0.0, 1.3, TableView::all, ProfileForm::tabulated};

const TableData& small_table() {
  static const TableData table = bake_table({{0.0, 1.3}, few, 1, TableView::all});
  return table;
}

std::string refusal(const std::string& bytes) {
  try {
    decode_table(bytes, "file.table");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a table survives being written and read") {
  const TableData& table = small_table();
  const std::string bytes = encode_table(table);
  const TableData again = decode_table(bytes, "bytes");
  CHECK(again.g == table.g);
  CHECK(again.eta == table.eta);
  CHECK(again.photons == table.photons);
  CHECK(again.provenance == table.provenance);
  CHECK(again.log2_density == table.log2_density);
  CHECK(again.mixture == table.mixture);
  CHECK(encode_table(again) == bytes);
}

TEST_CASE("truncated and altered tables are refused in one line that names the file") {
  const std::string bytes = encode_table(small_table());
  REQUIRE(refusal(bytes) == "accepted");
  for (std::size_t length = 0; length < bytes.size(); length += length < 200 ? 1 : 997) {
    const std::string line = refusal(bytes.substr(0, length));
    REQUIRE(line.rfind("file.table: ", 0) == 0);
    REQUIRE(line.find('\n') == std::string::npos);
  }
  for (std::size_t place = 0; place < bytes.size(); place += place < 200 ? 1 : 997) {
    std::string altered = bytes;
    altered[place] = static_cast<char>(altered[place] ^ 0x10);
    REQUIRE(refusal(altered) != "accepted");
  }
  REQUIRE(refusal(bytes + "x") != "accepted");
  REQUIRE(refusal("PNG") == "file.table: not a profile table of Alabaster");
}

TEST_CASE("a bake depends on photons and seed alone") {
  CHECK(encode_table(bake_table({{0.0, 1.3}, few, 1, TableView::all})) == encode_table(small_table()));
  CHECK(bake_table({{0.0, 1.3}, few, 2, TableView::all}).log2_density != small_table().log2_density);
}

TEST_CASE("the store bakes once, keeps the table, and mends a broken file") {
  set_quiet(true);
  const ScratchFolder folder;
  ProfileStore first(folder.path() / "new" / "cache", few);
  CHECK(first.has({}));  // built in
  CHECK_FALSE(first.has(other));
  const auto profile = first.get(other);
  CHECK(profile->g() == 0);
  CHECK(profile->eta() == 1.3);
  CHECK(first.get(other) == profile);
  CHECK(first.bakes() == 1);
  ProfileStore second(folder.path() / "new" / "cache", few);
  CHECK(second.has(other));
  CHECK(second.get(other)->reflectance(0.8) == profile->reflectance(0.8));
  CHECK(second.bakes() == 0);

  const std::string bytes = read_text(second.file_of(other));
  write_text_atomically(second.file_of(other), bytes.substr(0, bytes.size() / 2));
  ProfileStore third(folder.path() / "new" / "cache", few);
  CHECK_FALSE(third.has(other));
  CHECK(third.get(other)->reflectance(0.8) == profile->reflectance(0.8));
  CHECK(third.bakes() == 1);
  CHECK(read_text(third.file_of(other)) == bytes);

  // Another medium's table under this name.
  ProfileRequest elsewhere = other;
  elsewhere.eta = 1.31;
  write_text_atomically(third.file_of(elsewhere), bytes);
  CHECK_FALSE(third.has(elsewhere));
  CHECK(third.get(elsewhere)->eta() == 1.31);
  CHECK(third.bakes() == 2);
  set_quiet(false);
}

TEST_CASE("two that ask at once bake once") {
  set_quiet(true);
  const ScratchFolder folder;
  ProfileStore a(folder.path(), few), b(folder.path(), few);
  std::thread one([&] { a.get(other); }), two([&] { b.get(other); });
  one.join();
  two.join();
  CHECK(a.bakes() + b.bakes() == 1);
  CHECK(a.get(other)->reflectance(0.5) == b.get(other)->reflectance(0.5));
  set_quiet(false);
}

TEST_CASE("the baseline needs no cache, impossible media are refused") {
  ProfileStore store("/nonexistent/folder", few);
  CHECK(store.get({})->reflectance(0.9) == baseline_profile().reflectance(0.9));
  CHECK(store.bakes() == 0);
  for (const double g : {-1.0, 1.0, std::nan("")}) CHECK_THROWS_AS(store.get({g, 1.5, {}, {}}), InputError);
  for (const double eta : {0.9, 5.0}) CHECK_THROWS_AS(store.get({0.3, eta, {}, {}}), InputError);
}

TEST_CASE(
    "the normal-view table returns less than all directions, by reciprocity what adding-doubling says") {
  // Published totals of light arriving along the normal, without its specular 0.04: by reciprocity the light
  // leaving along the normal under diffuse light.
  const TableData table = bake_table({{0.3, 1.5}, 4 * photons_per_chunk, 3, TableView::normal});
  const MixtureProfile mixture(table);
  const ProfileTable& all = baseline_profile();
  const double rows[3][3]{{0.5, 0.06542, 0.0002}, {0.9, 0.21022, 0.0003}, {0.99, 0.55072, 0.0006}};
  for (const auto& [albedo, total, tolerance] : rows) {
    const double expected = (total - 0.04) / 0.96;
    const auto row = static_cast<std::size_t>(AlbedoRows::position(albedo));
    // Scores of one photon are correlated: twice the error of independent ones.
    const double error = 2 * albedo * table.reflectance_standard_error[row];
    const double interpolated =
        albedo * (table.reflectance_over_albedo[row] +
                  (AlbedoRows::position(albedo) - static_cast<double>(row)) *
                      (table.reflectance_over_albedo[row + 1] - table.reflectance_over_albedo[row]));
    INFO("albedo " << albedo << ": " << interpolated << " +- " << error << ", expected " << expected);
    CHECK(std::abs(interpolated - expected) < tolerance / 0.96 + 3 * error + 1e-3 * expected);
    CHECK(interpolated < all.reflectance(albedo));
  }
}
