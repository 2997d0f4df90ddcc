#include "scene/gltf_accessor.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace alabaster {

namespace {

/// Elements in a buffer view, all known to lie inside it.
struct Strided {
  const unsigned char* data = nullptr;
  std::size_t stride = 0;

  const unsigned char* element(std::size_t i) const { return data + i * stride; }
};

[[noreturn]] void fail(const GltfDocument& document, const std::string& place, const std::string& problem) {
  throw InputError(document.file, place, problem + "; the file is damaged, export it again");
}

std::size_t component_size(const GltfDocument& document, int type, const std::string& place) {
  const int32_t size = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type));
  if (size <= 0 || size > 4) fail(document, place, fmt::format("has unknown component type {}", type));
  return static_cast<std::size_t>(size);
}

/// `stride` 0: tightly packed.
Strided locate(const GltfDocument& document, int view_index, std::size_t offset, std::size_t stride,
               std::size_t element_size, std::size_t count, const std::string& place) {
  const tinygltf::Model& model = *document.model;
  if (view_index < 0 || static_cast<std::size_t>(view_index) >= model.bufferViews.size())
    fail(document, place, "has no buffer view");
  const auto& view = model.bufferViews[static_cast<std::size_t>(view_index)];
  const auto& buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (stride == 0) stride = element_size;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
    fail(document, place, "lies outside its buffer");
  // Compared by division: the products may not fit.
  const bool fits = count == 0 || (offset <= view.byteLength && element_size <= view.byteLength - offset &&
                                   (count - 1) <= (view.byteLength - offset - element_size) / stride);
  if (!fits)
    fail(document, place,
         fmt::format("has {} elements, but bufferViews[{}] ends after {} bytes", count, view_index,
                     view.byteLength));
  if (buffer.empty()) return {};
  return {buffer.data() + view.byteOffset + offset, stride};
}

template <typename T>
T load(const unsigned char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

float to_float(const unsigned char* bytes, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float v = load<int8_t>(bytes);
      return normalized ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float v = load<uint8_t>(bytes);
      return normalized ? v / 255.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float v = load<int16_t>(bytes);
      return normalized ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float v = load<uint16_t>(bytes);
      return normalized ? v / 65535.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_INT:
      return static_cast<float>(load<int32_t>(bytes));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(load<uint32_t>(bytes));
    default:
      return load<float>(bytes);
  }
}

uint32_t to_index(const unsigned char* bytes, std::size_t size) {
  return size == 1 ? load<uint8_t>(bytes) : size == 2 ? load<uint16_t>(bytes) : load<uint32_t>(bytes);
}

const tinygltf::Accessor& accessor_of(const GltfDocument& document, int index, const std::string& place) {
  const auto& accessors = document.model->accessors;
  if (index < 0 || static_cast<std::size_t>(index) >= accessors.size())
    fail(document, place, fmt::format("refers to accessors[{}], which does not exist", index));
  const auto& accessor = accessors[static_cast<std::size_t>(index)];
  if (accessor.count > std::numeric_limits<uint32_t>::max() / 4)
    fail(document, place, fmt::format("claims {} elements", accessor.count));
  return accessor;
}

int component_count(const GltfDocument& document, const tinygltf::Accessor& accessor,
                    const std::string& place) {
  const int32_t components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  if (components <= 0) fail(document, place, "has an unknown type");
  return components;
}

void apply_sparse(const GltfDocument& document, const tinygltf::Accessor& accessor, AccessorValues& result,
                  const std::string& place) {
  const auto& sparse = accessor.sparse;
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > result.count ||
      sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    fail(document, place, "has sparse values that do not fit it");
  const auto count = static_cast<std::size_t>(sparse.count);
  const std::size_t index_size = component_size(document, sparse.indices.componentType, place);
  const std::size_t size = component_size(document, accessor.componentType, place);
  const auto components = static_cast<std::size_t>(result.components);
  const Strided indices =
      locate(document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), 0,
             index_size, count, place);
  const Strided values =
      locate(document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), 0,
             size * components, count, place);
  for (std::size_t i = 0; i < count; ++i) {
    const uint32_t target = to_index(indices.element(i), index_size);
    if (target >= result.count)
      fail(document, place, fmt::format("has a sparse value for element {} of {}", target, result.count));
    for (std::size_t c = 0; c < components; ++c)
      result.values[target * components + c] =
          to_float(values.element(i) + c * size, accessor.componentType, accessor.normalized);
  }
}

}  // namespace

AccessorValues read_values(const GltfDocument& document, int index, const std::string& place) {
  const auto& accessor = accessor_of(document, index, place);
  AccessorValues result;
  result.count = accessor.count;
  result.components = component_count(document, accessor, place);
  if (result.components > 4 && accessor.type != TINYGLTF_TYPE_MAT4) fail(document, place, "must be a vector");
  const auto components = static_cast<std::size_t>(result.components);
  const std::size_t size = component_size(document, accessor.componentType, place);
  if (accessor.bufferView >= 0) {
    const auto stride = document.model->bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
    const Strided data = locate(document, accessor.bufferView, accessor.byteOffset, stride, size * components,
                                accessor.count, place);
    result.values.resize(result.count * components);
    for (std::size_t i = 0; i < result.count; ++i)
      for (std::size_t c = 0; c < components; ++c)
        result.values[i * components + c] =
            to_float(data.element(i) + c * size, accessor.componentType, accessor.normalized);
  } else {
    constexpr std::size_t most_implied = 50'000'000;
    if (result.count > most_implied)
      fail(document, place, fmt::format("claims {} elements, none of which are stored", result.count));
    // glTF: without a buffer view all elements are 0, then sparse values replace some.
    result.values.resize(result.count * components, 0.0f);
  }
  if (accessor.sparse.isSparse) apply_sparse(document, accessor, result, place);
  return result;
}

std::vector<uint32_t> read_integers(const GltfDocument& document, int index, const std::string& place) {
  const auto& accessor = accessor_of(document, index, place);
  const auto components = static_cast<std::size_t>(component_count(document, accessor, place));
  const std::size_t size = component_size(document, accessor.componentType, place);
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
    fail(document, place, "holds floats where whole numbers are needed");
  if (accessor.sparse.isSparse) {
    // Rare; floats hold whole numbers exactly up to 2^24 only.
    const AccessorValues values = read_values(document, index, place);
    std::vector<uint32_t> result;
    for (const float v : values.values) {
      if (!(v >= 0 && v < 16777216.0f)) fail(document, place, "has sparse indices out of range");
      result.push_back(static_cast<uint32_t>(v));
    }
    return result;
  }
  const auto stride =
      accessor.bufferView >= 0
          ? document.model->bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride
          : 0;
  const Strided data = locate(document, accessor.bufferView, accessor.byteOffset, stride, size * components,
                              accessor.count, place);
  std::vector<uint32_t> result(accessor.count * components);
  for (std::size_t i = 0; i < accessor.count; ++i)
    for (std::size_t c = 0; c < components; ++c)
      result[i * components + c] = to_index(data.element(i) + c * size, size);
  return result;
}

}  // namespace alabaster
