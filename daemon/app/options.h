#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace gonio::daemon {

/// What goniod was started with.
struct Options {
  std::string instrument_file = "instrument.toml";
  std::string store_file = "goniod.sqlite";
  std::string address = "127.0.0.1";
  std::uint16_t port = 8470;
  std::string socket_file;  ///< empty: none
  std::string references;   ///< empty: what instrument.toml says
  std::string ready_file;   ///< empty: none
  std::string log_level = "info";
  std::string record_file;              ///< a tape to be written; empty: none
  std::string replay_file;              ///< a tape to be replayed in place of serving; empty: none
  std::string against;                  ///< a store to compare the replay's with
  bool has_instrument = false;          ///< `instrument_file` was named
  std::optional<std::string> simulate;  ///< a scene; empty text: the usual one
};

/// Help or version (exit code 0), or why the line is wrong (2).
struct OptionsAdvice {
  std::string text;
  int exit_code = 0;
};

/// Reads the arguments after the program's name.
[[nodiscard]] tl::expected<Options, OptionsAdvice> read_options(const std::vector<std::string>& arguments);

}  // namespace gonio::daemon
