#include "scene/gltf_document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/atomic_file.h"
#include "core/error.h"
#include "scene/gltf_validate.h"
#include "scene/json_reader.h"

namespace alabaster {

GltfDocument::GltfDocument() : model(std::make_unique<tinygltf::Model>()) {}
GltfDocument::~GltfDocument() = default;
GltfDocument::GltfDocument(GltfDocument&&) noexcept = default;

std::string gltf_place(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{}[{}]", kind, index) : fmt::format("{}[{}] '{}'", kind, index, name);
}

namespace {

uint32_t read_u32(std::string_view bytes, std::size_t offset) {
  std::array<char, 4> raw{};
  std::memcpy(raw.data(), bytes.data() + offset, 4);
  return std::bit_cast<uint32_t>(raw);
}

/// The JSON chunk of a binary glTF file (glTF 2.0, section 4.4).
std::string_view glb_json(const std::string& file, std::string_view bytes) {
  constexpr uint32_t json_chunk = 0x4E4F534A;
  if (bytes.size() < 20) throw InputError(file, "is cut short: a .glb has at least 20 bytes; copy it again");
  const uint32_t version = read_u32(bytes, 4), length = read_u32(bytes, 8);
  if (version != 2)
    throw InputError(
        file, fmt::format("is binary glTF version {}; only 2 can be read, export it as glTF 2.0", version));
  if (length > bytes.size())
    throw InputError(
        file, fmt::format("is cut short: its header says {} bytes, the file has {}; copy it again", length,
                          bytes.size()));
  const uint32_t chunk_length = read_u32(bytes, 12);
  if (read_u32(bytes, 16) != json_chunk || chunk_length > bytes.size() - 20)
    throw InputError(file, "its first chunk is not JSON; the file is damaged, export it again");
  return bytes.substr(20, chunk_length);
}

bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  image->as_is = true;
  image->image.assign(bytes, bytes + std::max(size, 0));
  return true;
}

/// tinygltf reports several lines; the user gets one.
std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

void parse_model(GltfDocument& document, std::string_view bytes, bool binary, const std::string& folder) {
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_encoded, nullptr);
  std::string error, warning;
  bool good = false;
  if (bytes.size() > std::numeric_limits<unsigned int>::max())
    throw InputError(document.file, "is larger than 4 GB, more than glTF can address; split it");
  const auto size = static_cast<unsigned int>(bytes.size());
  try {
    if (binary)
      good = parser.LoadBinaryFromMemory(document.model.get(), &error, &warning,
                                         reinterpret_cast<const unsigned char*>(bytes.data()), size, folder);
    else
      good = parser.LoadASCIIFromString(document.model.get(), &error, &warning, bytes.data(), size, folder);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    error = problem.what();
  }
  if (!good)
    throw InputError(document.file, "cannot be read as glTF 2.0: " +
                                        one_line(error.empty() ? warning : error) + "; export it again");
}

/// "%20" and the like, as URIs write what file names hold.
std::string decode_uri(const std::string& uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 2]));
    if (!escape) {
      out += uri[i];
      continue;
    }
    out += static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16));
    i += 2;
  }
  return out;
}

void require_buffer_files(const GltfDocument& document, const nlohmann::json& root,
                          const std::filesystem::path& folder) {
  const auto buffers = root.find("buffers");
  if (buffers == root.end()) return;
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const auto uri = (*buffers)[i].find("uri");
    if (uri == (*buffers)[i].end()) continue;
    const std::string place = gltf_place("buffers", i, "");
    if (!uri->is_string())
      throw InputError(document.file, place + ".uri", "must be a string; export the file again");
    const auto text = uri->get<std::string>();
    if (text.rfind("data:", 0) == 0) continue;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(folder / decode_uri(text), ignored))
      throw InputError(document.file, place, "'" + text + "' cannot be found; put it beside the model");
  }
}

}  // namespace

GltfDocument read_gltf(const std::filesystem::path& path) {
  GltfDocument document;
  document.file = path.string();
  const std::string bytes = read_text(path);
  if (bytes.empty()) throw InputError(document.file, "is empty; export the model again");
  const bool binary = bytes.size() >= 4 && std::string_view(bytes).substr(0, 4) == "glTF";
  const std::string_view text = binary ? glb_json(document.file, bytes) : std::string_view(bytes);
  const nlohmann::json root = parse_json(document.file, text);
  validate_gltf(document.file, root, document.remarks);
  require_buffer_files(document, root, path.parent_path());
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  parse_model(document, bytes, binary, folder);
  return document;
}

}  // namespace alabaster
