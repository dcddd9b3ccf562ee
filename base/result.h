#pragma once

#include <tl/expected.hpp>
#include <utility>

#include "base/error.h"

namespace gonio {

/// A value, or the Error that stood in its way. Later std::expected.
template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> failure(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace gonio

/// Leaves the function with the error of a Result expression; does nothing when it holds a value.
#define GONIO_TRY(expression)                                                            \
  do {                                                                                   \
    auto gonio_try_result = (expression);                                                \
    if (!gonio_try_result) return ::gonio::failure(std::move(gonio_try_result).error()); \
  } while (false)
