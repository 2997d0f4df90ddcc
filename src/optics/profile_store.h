#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

#include "optics/profile_table.h"
#include "optics/shape_families.h"
#include "optics/table_data.h"

namespace alabaster {

/// How a table is read: interpolated (the default, the more accurate and the faster), or [EK17]'s five
/// exponentials.
enum class ProfileForm { tabulated, mixture };

struct ProfileRequest {
  double g = 0.3, eta = 1.5;
  TableView view = TableView::all;
  ProfileForm form = ProfileForm::tabulated;
};

/// Tables by (g, eta, view), baked once and kept in a folder. Safe against other threads and other processes:
/// who comes second waits for the first one's table. A broken or outdated file is reported and baked anew;
/// when the folder cannot be written the table is baked for this run only, with a warning.
class ProfileStore {
 public:
  ProfileStore(std::filesystem::path folder, uint64_t photons);

  /// Throws InputError for g outside [-0.99, 0.99] or eta outside [1, 4].
  std::shared_ptr<const ProfileTable> get(const ProfileRequest& request);
  /// Whether get() would find the table without baking.
  bool has(const ProfileRequest& request);
  std::filesystem::path file_of(const ProfileRequest& request) const;
  /// The shapes of the same medium, kept beside the table; `photons` of the table set theirs too.
  std::shared_ptr<const ShapeFamilies> get_shapes(double g, double eta);
  /// Tables baked by this object so far.
  int bakes() const { return bakes_; }

 private:
  std::shared_ptr<const TableData> load_or_bake(const ProfileRequest& request);
  ShapeTable load_or_bake_shapes(double g, double eta);
  TableData bake(const ProfileRequest& request);

  std::filesystem::path folder_;
  uint64_t photons_;
  int bakes_ = 0;
  std::mutex mutex_;
  std::map<std::tuple<double, double, TableView>, std::shared_ptr<const TableData>> tables_;
  std::map<std::tuple<double, double, TableView, ProfileForm>, std::shared_ptr<const ProfileTable>> profiles_;
  std::map<std::pair<double, double>, std::shared_ptr<const ShapeFamilies>> shapes_;
};

/// The built-in baseline, or a table of the user's cache ($XDG_CACHE_HOME/alabaster, else
/// ~/.cache/alabaster), baked with progress on standard error when it is not there yet.
std::shared_ptr<const ProfileTable> profile_for(const ProfileRequest& request);
/// The same for a medium of a scene: beyond the range the nearest there is, with a warning. Kept until the
/// program ends.
std::shared_ptr<const ProfileTable> profile_for(double g, double eta);
/// Whether that one would be found without baking.
bool profile_is_baked(double g, double eta);
/// The shapes that go with it: built in for the baseline, else baked once.
std::shared_ptr<const ShapeFamilies> shapes_for(double g, double eta);

/// The data of the built-in baseline table.
const TableData& baseline_table();

}  // namespace alabaster
