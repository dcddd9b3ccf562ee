#include "reflectance/formats/tensor_file.h"

#include <utility>

#include <fmt/format.h>

#include "reflectance/formats/byte_io.h"

namespace gonio::formats {
namespace {

constexpr std::string_view kTensorMagic{"tensor_file\0", 12};
constexpr std::uint8_t kTensorBytes = 1;
constexpr std::uint8_t kTensorFloats = 10;
constexpr std::uint8_t kTensorDoubles = 11;
constexpr std::size_t kTensorAlignment = 8;
constexpr std::size_t kMostTensorValues = 128'000'000;  // 1 GB as doubles

std::size_t size_of_kind(std::uint8_t kind) {
  if (kind == kTensorBytes) return 1;
  if (kind == kTensorFloats) return sizeof(float);
  return kind == kTensorDoubles ? sizeof(double) : 0;
}

double value_of_kind(std::uint8_t kind, const char* bytes) {
  if (kind == kTensorBytes) return static_cast<double>(little_endian<std::uint8_t>(bytes));
  if (kind == kTensorFloats) return static_cast<double>(little_endian<float>(bytes));
  return little_endian<double>(bytes);
}

Result<std::vector<std::size_t>> read_shape(ByteReader& bytes, const std::string& name, std::size_t dimensions,
                                            std::size_t& count) {
  std::vector<std::size_t> shape;
  count = 1;
  for (std::size_t n = 0; n < dimensions; ++n) {
    const Result<std::uint64_t> length = bytes.number<std::uint64_t>("shape of " + name);
    if (!length) return failure(length.error());
    // Each factor first: their product must not wrap.
    if (*length > kMostTensorValues || count * *length > kMostTensorValues)
      return failure(bytes.error("shape of " + name, fmt::format("{} along axis {}", *length, n),
                                 fmt::format("{} values in all", kMostTensorValues)));
    shape.push_back(*length);
    count *= *length;
  }
  return shape;
}

Result<Tensor> read_tensor(ByteReader& bytes, const std::string& name) {
  constexpr std::uint16_t kMostDimensions = 8;
  const Result<std::uint16_t> dimensions = bytes.number<std::uint16_t>("dimensions of " + name);
  if (!dimensions) return failure(dimensions.error());
  const Result<std::uint8_t> kind = bytes.number<std::uint8_t>("kind of " + name);
  if (!kind) return failure(kind.error());
  const Result<std::uint64_t> offset = bytes.number<std::uint64_t>("place of " + name);
  if (!offset) return failure(offset.error());
  if (*dimensions > kMostDimensions)
    return failure(bytes.error("dimensions of " + name, fmt::format("{}", *dimensions), "at most 8"));
  const std::size_t size = size_of_kind(*kind);
  if (size == 0)
    return failure(bytes.error("kind of " + name, fmt::format("{}", *kind), "bytes (1), floats (10), doubles (11)"));
  std::size_t count = 0;
  Result<std::vector<std::size_t>> shape = read_shape(bytes, name, *dimensions, count);
  if (!shape) return failure(shape.error());
  const Result<std::string_view> stored = bytes.slice(*offset, count * size, name);
  if (!stored) return failure(stored.error());
  Tensor tensor{.shape = *std::move(shape), .values = {}};
  tensor.values.reserve(count);
  for (std::size_t n = 0; n < count; ++n) tensor.values.push_back(value_of_kind(*kind, stored->data() + n * size));
  return tensor;
}

std::size_t aligned(std::size_t at) {
  return (at + kTensorAlignment - 1) / kTensorAlignment * kTensorAlignment;
}

}  // namespace

Result<Tensors> read_tensors(std::string_view data, const std::string& file) {
  constexpr std::uint32_t kMostFields = 64;
  ByteReader bytes(data, "RGL tensor file", file);
  const Result<std::string_view> magic = bytes.take(kTensorMagic.size(), "first bytes");
  if (!magic || *magic != kTensorMagic) return failure(bytes.error("first bytes", "another file", "tensor_file"));
  const Result<std::uint16_t> version = bytes.number<std::uint16_t>("version");
  if (!version) return failure(version.error());
  if (*version != 1) return failure(bytes.error("version", fmt::format("{}", *version), "1.0"));
  const Result<std::uint32_t> count = bytes.number<std::uint32_t>("number of fields");
  if (!count) return failure(count.error());
  if (*count > kMostFields)
    return failure(bytes.error("number of fields", fmt::format("{}", *count), fmt::format("at most {}", kMostFields)));
  Tensors tensors;
  for (std::uint32_t n = 0; n < *count; ++n) {
    const Result<std::uint16_t> length = bytes.number<std::uint16_t>("length of a name");
    if (!length) return failure(length.error());
    const Result<std::string_view> name = bytes.take(*length, "name");
    if (!name) return failure(name.error());
    Result<Tensor> tensor = read_tensor(bytes, std::string(*name));
    if (!tensor) return failure(tensor.error());
    tensors.insert_or_assign(std::string(*name), *std::move(tensor));
  }
  return tensors;
}

std::string write_tensors(const std::vector<TensorField>& fields) {
  std::size_t at = kTensorMagic.size() + sizeof(std::uint16_t) + sizeof(std::uint32_t);
  for (const TensorField& field : fields)
    at += 2 * sizeof(std::uint16_t) + field.name.size() + 1 + sizeof(std::uint64_t) * (1 + field.tensor.shape.size());
  std::string head(kTensorMagic);
  put_little_endian(head, std::uint16_t{1});
  put_little_endian(head, static_cast<std::uint32_t>(fields.size()));
  const std::size_t head_size = at;
  std::string body;
  for (const TensorField& field : fields) {
    body.resize(aligned(head_size + body.size()) - head_size);
    put_little_endian(head, static_cast<std::uint16_t>(field.name.size()));
    head += field.name;
    put_little_endian(head, static_cast<std::uint16_t>(field.tensor.shape.size()));
    put_little_endian(head, field.is_bytes ? kTensorBytes : kTensorFloats);
    put_little_endian(head, static_cast<std::uint64_t>(head_size + body.size()));
    for (const std::size_t length : field.tensor.shape) put_little_endian(head, static_cast<std::uint64_t>(length));
    for (const double value : field.tensor.values) {
      if (field.is_bytes) {
        put_little_endian(body, static_cast<std::uint8_t>(value));
      } else {
        put_little_endian(body, static_cast<float>(value));
      }
    }
  }
  return head + body;
}

}  // namespace gonio::formats
