#include "daemon/app/options.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <sstream>

namespace gonio::daemon {
namespace {

// "127.0.0.1:8470", "[::1]:8470".
std::string take_listen_address(const std::string& text, Options& options) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return "ADDRESS:PORT is needed, such as 127.0.0.1:8470";
  std::string address = text.substr(0, colon);
  if (address.front() == '[' && address.back() == ']') address = address.substr(1, address.size() - 2);
  const std::string port = text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  if (port.empty() || error != std::errc() || end != port.data() + port.size()) {
    return "\"" + port + "\" is not a port, 0 to 65535";
  }
  options.address = address;
  return {};
}

void add_options(CLI::App& app, Options& options) {
  app.set_version_flag("--version", "goniod " GONIO_VERSION);
  app.add_option("--instrument", options.instrument_file, "the instrument's description")->capture_default_str();
  app.add_option("--store", options.store_file, "the database; made when it is not there")->capture_default_str();
  app.add_option_function<std::string>(
      "--listen",
      [&options](const std::string& text) {
        const std::string wrong = take_listen_address(text, options);
        if (!wrong.empty()) throw CLI::ValidationError("--listen", wrong);
      },
      "loopback ADDRESS:PORT of the REST API; port 0: any free one [127.0.0.1:8470]");
  app.add_option("--socket", options.socket_file, "a unix socket of the REST API beside it");
  app.add_option("--references", options.references, "folder of reference/*.toml [beside the instrument's file]");
  app.add_option("--ready-file", options.ready_file, "written when the REST API answers; holds its URL");
  app.add_option("--log-level", options.log_level)
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
      ->capture_default_str();
  app.add_option("--record", options.record_file, "a tape of every exchange with the devices; must not be there");
  CLI::Option* replay = app.add_option("--replay", options.replay_file,
                                       "run on this tape instead of devices, into a new --store, and end")
                            ->excludes("--record");
  app.add_option("--against", options.against, "compare the replay's store with this one")->needs(replay);
  app.add_option("--simulate", options.simulate, "run on a simulated instrument: goniosim with this scene")
      ->expected(0, 1);
}

}  // namespace

tl::expected<Options, OptionsAdvice> read_options(const std::vector<std::string>& arguments) {
  Options options;
  CLI::App app("goniod runs a gonioreflectometer: stage, detector, scans, results.", "goniod");
  add_options(app, options);
  // What follows --simulate may also be meant for goniosim (--seed, --state): it is passed on.
  app.allow_extras(std::find(arguments.begin(), arguments.end(), "--simulate") != arguments.end());
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(reversed);
    options.has_instrument = app.count("--instrument") > 0;
  } catch (const CLI::ParseError& e) {
    std::ostringstream out;
    std::ostringstream err;
    const bool asked_for = app.exit(e, out, err) == 0;
    return tl::unexpected<OptionsAdvice>({asked_for ? out.str() : err.str(), asked_for ? 0 : 2});
  }
  return options;
}

}  // namespace gonio::daemon
