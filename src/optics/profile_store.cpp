#include "optics/profile_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "core/error.h"
#include "core/progress.h"
#include "core/user_cache.h"
#include "optics/bake.h"
#include "optics/mixture_profile.h"
#include "optics/shape_bake.h"
#include "optics/tabulated_profile.h"

namespace alabaster {

namespace fs = std::filesystem;

namespace {

// An exclusive lock between processes; the operating system lifts it when its holder dies.
class FileLock {
 public:
  explicit FileLock(const fs::path& path)
      : descriptor_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) return;
    if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    say("waiting for another process that bakes " + path.stem().string());
    flock(descriptor_, LOCK_EX);
  }
  ~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  bool held() const { return descriptor_ >= 0; }

 private:
  int descriptor_;
};

void check(const ProfileRequest& request) {
  if (!(request.g >= -0.99 && request.g <= 0.99))
    throw InputError(fmt::format("g = {}: outside [-0.99, 0.99]", request.g));
  if (!(request.eta >= 1 && request.eta <= 4))
    throw InputError(fmt::format("eta = {}: outside [1, 4]", request.eta));
}

bool is_of(const TableData& table, const ProfileRequest& request) {
  return table.g == request.g && table.eta == request.eta && table.view == request.view;
}

bool is_baseline(const ProfileRequest& request) {
  return is_of(baseline_table(), request);
}

}  // namespace

ProfileStore::ProfileStore(fs::path folder, uint64_t photons)
    : folder_(std::move(folder)), photons_(photons) {}

fs::path ProfileStore::file_of(const ProfileRequest& request) const {
  return folder_ / fmt::format("profile_g{}_eta{}{}.table", request.g, request.eta,
                               request.view == TableView::normal ? "_normal" : "");
}

TableData ProfileStore::bake(const ProfileRequest& request) {
  const std::string label = fmt::format("baking the profile of g = {}, eta = {}", request.g, request.eta);
  say(label + " (once; kept in " + folder_.string() + ")");
  Progress progress(label);
  ++bakes_;
  BakeOptions options;
  options.medium = {request.g, request.eta};
  options.photons = photons_;
  options.view = request.view;
  return bake_table(options, [&](double done) { progress.update(done); });
}

namespace {

// The table in that file if it is there and `fits`, else a new one, which is left there.
template <typename Table, typename Read, typename Fits, typename Bake, typename Write>
Table read_or_bake(const fs::path& file, const Read& read, const Fits& fits, const Bake& bake,
                   const Write& write) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const FileLock lock(fs::path(file).replace_extension(".lock"));
  if (!lock.held()) {
    warn(file.parent_path().string() +
         ": cannot be written, so the profile is baked for this run only; set XDG_CACHE_HOME");
    return bake();
  }
  if (fs::exists(file, error)) {
    try {
      Table table = read(file);
      if (fits(table)) return table;
      warn(file.string() + ": holds the profile of another medium; baking it anew");
    } catch (const InputError& problem) {
      warn(std::string(problem.what()) + " (doing so)");
    }
  }
  Table table = bake();
  try {
    write(file, table);
  } catch (const InputError& problem) {
    warn(problem.what());
  }
  return table;
}

}  // namespace

std::shared_ptr<const TableData> ProfileStore::load_or_bake(const ProfileRequest& request) {
  return std::make_shared<TableData>(read_or_bake<TableData>(
      file_of(request), read_table, [&](const TableData& table) { return is_of(table, request); },
      [&] { return bake(request); }, write_table));
}

ShapeTable ProfileStore::load_or_bake_shapes(double g, double eta) {
  const auto half_space = get({g, eta, TableView::all, ProfileForm::tabulated});
  return read_or_bake<ShapeTable>(
      folder_ / fmt::format("shapes_g{}_eta{}.table", g, eta), read_shape_table,
      [&](const ShapeTable& table) { return table.g == g && table.eta == eta; },
      [&] {
        const std::string label = fmt::format("baking the shapes of g = {}, eta = {}", g, eta);
        say(label + " (once; kept in " + folder_.string() + ")");
        Progress progress(label);
        ++bakes_;
        ShapeBakeOptions options;
        options.medium = {g, eta};
        options.photons = std::max<uint64_t>(photons_ * quick_shape_photons / quick_photons, 1);
        return bake_shapes(options, *half_space, [&](double done) { progress.update(done); });
      },
      write_shape_table);
}

std::shared_ptr<const ShapeFamilies> ProfileStore::get_shapes(double g, double eta) {
  check({g, eta, TableView::all, ProfileForm::tabulated});
  {
    const std::lock_guard<std::mutex> guard(mutex_);
    if (const auto found = shapes_.find({g, eta}); found != shapes_.end()) return found->second;
  }
  const bool is_baseline = g == baseline_shape_table().g && eta == baseline_shape_table().eta;
  const auto shapes =
      is_baseline ? std::shared_ptr<const ShapeFamilies>(&baseline_shapes(), [](const ShapeFamilies*) {})
                  : std::make_shared<const ShapeFamilies>(load_or_bake_shapes(g, eta));
  const std::lock_guard<std::mutex> guard(mutex_);
  return shapes_.emplace(std::pair{g, eta}, shapes).first->second;
}

std::shared_ptr<const ProfileTable> ProfileStore::get(const ProfileRequest& request) {
  check(request);
  const std::lock_guard<std::mutex> guard(mutex_);
  auto& profile = profiles_[{request.g, request.eta, request.view, request.form}];
  if (profile) return profile;
  auto& table = tables_[{request.g, request.eta, request.view}];
  if (!table)
    table = is_baseline(request)
                ? std::shared_ptr<const TableData>(&baseline_table(), [](const TableData*) {})
                : load_or_bake(request);
  if (request.form == ProfileForm::mixture)
    profile = std::make_shared<MixtureProfile>(*table);
  else
    profile = std::make_shared<TabulatedProfile>(*table);
  return profile;
}

bool ProfileStore::has(const ProfileRequest& request) {
  check(request);
  if (is_baseline(request)) return true;
  const std::lock_guard<std::mutex> guard(mutex_);
  auto& table = tables_[{request.g, request.eta, request.view}];
  try {
    if (!table) table = std::make_shared<TableData>(read_table(file_of(request)));
    if (is_of(*table, request)) return true;
  } catch (const InputError&) {
  }
  table = nullptr;
  return false;
}

namespace {

ProfileStore& store_of_user() {
  static ProfileStore store(user_cache_folder(), quick_photons);
  return store;
}

ProfileRequest nearest_request(double g, double eta) {
  ProfileRequest request;
  request.g = std::clamp(g, -0.99, 0.99);
  request.eta = std::clamp(eta, 1.0, 4.0);
  return request;
}

}  // namespace

std::shared_ptr<const ProfileTable> profile_for(const ProfileRequest& request) {
  return store_of_user().get(request);
}

bool profile_is_baked(double g, double eta) {
  return store_of_user().has(nearest_request(g, eta));
}

std::shared_ptr<const ShapeFamilies> shapes_for(double g, double eta) {
  return store_of_user().get_shapes(std::clamp(g, -0.99, 0.99), std::clamp(eta, 1.0, 4.0));
}

std::shared_ptr<const ProfileTable> profile_for(double g, double eta) {
  const ProfileRequest request = nearest_request(g, eta);
  if (request.g != g || request.eta != eta)
    warn(fmt::format(
        "profiles end at |g| = 0.99 and eta = 4: for g = {}, eta = {} that of g = {}, eta = {} is taken", g,
        eta, request.g, request.eta));
  return profile_for(request);
}

}  // namespace alabaster
