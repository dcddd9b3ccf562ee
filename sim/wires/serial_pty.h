#pragma once

#include <string>

#include "base/result.h"
#include "sim/wires/file_descriptor.h"

namespace gonio::sim {

/// A serial line whose other end is here: a pseudo terminal, with a symbolic link that says where its open end is.
/// Raw, so that nothing is echoed or translated. It has no speed: whoever answers on it keeps the time.
class SerialPty {
 public:
  /// A link that is there already is replaced. Errors: Internal (no pseudo terminal), InvalidInput (not a link's
  /// place).
  [[nodiscard]] static Result<SerialPty> open(const std::string& link);
  SerialPty(SerialPty&&) noexcept = default;
  SerialPty& operator=(SerialPty&&) noexcept = default;

  [[nodiscard]] int descriptor() const { return master_.get(); }

 private:
  SerialPty(FileDescriptor master, FileDescriptor slave) : master_(std::move(master)), slave_(std::move(slave)) {}
  FileDescriptor master_;
  FileDescriptor slave_;  ///< held open: else the master fails whenever a client closes
};

}  // namespace gonio::sim
