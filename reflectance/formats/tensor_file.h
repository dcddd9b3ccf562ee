#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace gonio::formats {

/// One named array of a tensor file, row by row, the last index fastest.
struct Tensor {
  std::vector<std::size_t> shape;
  std::vector<double> values;
};
using Tensors = std::map<std::string, Tensor, std::less<>>;

/// The container of the RGL material database (Dupuy and Jakob 2018): "tensor_file", version 1.0, named arrays of 8-bit
/// whole numbers, floats or doubles, little-endian. Errors: InvalidInput with the byte: another file, a name, shape or
/// place that the file's bytes do not bear out, an array of another kind, more than 64 of them.
[[nodiscard]] Result<Tensors> read_tensors(std::string_view bytes, const std::string& file);

/// What `write_tensors` puts there: bytes for texts and switches, floats for all else.
struct TensorField {
  std::string name;
  bool is_bytes = false;
  Tensor tensor;
};
[[nodiscard]] std::string write_tensors(const std::vector<TensorField>& fields);

}  // namespace gonio::formats
