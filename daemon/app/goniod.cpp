// goniod: options, then one thing after the other that can be refused, then the threads, then waiting for the end.
#include <csignal>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <mutex>
#include <optional>

#include <fmt/format.h>

#include "daemon/analysis/analysis_desk.h"
#include "daemon/app/daemon_service.h"
#include "daemon/app/devices.h"
#include "daemon/app/engine.h"
#include "daemon/app/log.h"
#include "daemon/app/options.h"
#include "daemon/app/recording.h"
#include "daemon/app/replay.h"
#include "daemon/app/simulate.h"
#include "daemon/desks/scan_reports.h"
#include "daemon/engine/file_limit.h"
#include "daemon/http/server.h"
#include "daemon/store/store_writer.h"
#include "daemon/tape/tape_deck.h"

namespace gonio::daemon {
namespace {

/// Events go out while there is a server; those committed before and after are fetched from the store by whoever asks.
class Publisher {
 public:
  /// From here on until it is destroyed, which comes before the server's end.
  class Attached {
   public:
    Attached(Publisher& publisher, Server& server) : publisher_(publisher) { publisher_.set(&server); }
    ~Attached() { publisher_.set(nullptr); }
    Attached(const Attached&) = delete;
    Attached& operator=(const Attached&) = delete;

   private:
    Publisher& publisher_;
  };

  void operator()(const EventRecord& event) {
    const std::lock_guard lock(mutex_);
    if (server_ != nullptr) server_->publish(event_report(event));
  }

 private:
  void set(Server* server) {
    const std::lock_guard lock(mutex_);
    server_ = server;
  }

  std::mutex mutex_;
  Server* server_ = nullptr;
};

std::string boot_id() {
  std::ifstream in("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(in, id);
  return id;
}

// Written aside, then renamed: whoever sees it can read it whole.
Result<void> write_ready_file(const std::string& path, const std::string& url) {
  const std::string aside = path + ".part";
  std::ofstream out(aside);
  out << url << '\n';
  out.close();
  if (out.good() && std::rename(aside.c_str(), path.c_str()) == 0) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .device = "goniod",
                  .tried = "write the ready file",
                  .seen = "it cannot be written",
                  .where = InputLocation{path, 0, "--ready-file"}});
}

// Beside this program, as goniosim is.
std::string analysis_program() {
  if (const char* named = std::getenv("GONIO_ANALYSE")) return named;
  return (std::filesystem::path(own_path()).parent_path() / "gonio-analyse").string();
}

void log_references(const ReferenceShelf& shelf) {
  for (const ShelfEntry& entry : shelf.all()) {
    if (entry.standard) {
      log_info(fmt::format("reference: {} ({}), certificate of {}, expires {}", entry.standard->serial(),
                           entry.standard->material(), entry.standard->certificate().date,
                           entry.standard->certificate().expires));
      for (const std::string& finding : entry.shape.findings) {
        log_warning(fmt::format("reference: the table of {}: {}", entry.standard->serial(), finding));
      }
    } else {
      log_warning("reference: " + describe(entry.standard.error()));
    }
  }
}

// SIGTERM and SIGINT are waited for, not handled: blocked here, before any thread is made, and taken one by one in
// main.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

void wait_for_end(const sigset_t& signals) {
  int signal = 0;
  while (sigwait(&signals, &signal) != 0) {
  }
  log_info(fmt::format("ending: signal {}", signal));
}

// Everything that can be refused comes first, and changes nothing: options, files, port, store. Then the instrument.
Result<void> serve(const Options& options, const sigset_t& signals) {
  GONIO_TRY(limit_open_files());
  const SystemClock clock;
  const Result<Instrument> instrument = read_instrument(options.instrument_file);
  if (!instrument) return failure(instrument.error());
  Result<Listeners> listeners = Listeners::bind(options.address, options.port, options.socket_file);
  if (!listeners) return failure(listeners.error());
  Result<std::unique_ptr<drivers::TapeWriter>> tape(nullptr);
  if (!options.record_file.empty()) {
    tape = start_recording(options.record_file, options.store_file, *instrument, boot_id(), clock);
    if (!tape) return failure(tape.error());
  }
  TapeDeck deck = *tape ? TapeDeck(clock, **tape) : TapeDeck(clock);
  const Result<std::unique_ptr<StoreWriter>> writer =
      StoreWriter::open({.path = options.store_file, .boot_id = boot_id(), .version = GONIO_VERSION},
                        deck.clock(drivers::TapeParty::Store));
  if (!writer) return failure(writer.error());
  const ReferenceShelf shelf(options.references.empty() ? instrument->reference_directory : options.references);
  log_references(shelf);

  Publisher publisher;
  Devices devices(*instrument, deck);
  Engine engine({.instrument = *instrument, .store_file = options.store_file, .tape = deck.sink()}, devices.all(),
                **writer, clock, [&publisher](const EventRecord& event) { publisher(event); });
  AnalysisDesk analyses(
      {.program = analysis_program(), .store_file = options.store_file, .folder = options.store_file + ".analysis"},
      clock);
  DaemonService service({.engine = engine,
                         .instrument = *instrument,
                         .shelf = shelf,
                         .clock = clock,
                         .analyses = analyses,
                         .store_file = options.store_file,
                         .version = GONIO_VERSION});
  const Result<api::StatusReport> status = service.status();
  if (!status) return failure(status.error());
  Result<std::unique_ptr<Server>> server =
      Server::start(std::move(*listeners), {.last_event = status->last_event}, service, clock);
  if (!server) return failure(server.error());
  const Publisher::Attached attached(publisher, **server);  // the store's thread may commit until the engine's end
  const std::string url = fmt::format("http://{}:{}", options.address, (*server)->port());
  log_info(fmt::format("instrument \"{}\" ({:.12}), store {}, REST API at {}", instrument->name, instrument->sha256,
                       options.store_file, url));
  if (!options.ready_file.empty()) GONIO_TRY(write_ready_file(options.ready_file, url));
  wait_for_end(signals);
  return {};
}

ReplayWanted replay_of(const Options& options) {
  return {.tape_file = options.replay_file,
          .store_file = options.store_file,
          .instrument_file = options.has_instrument ? options.instrument_file : "",
          .against = options.against};
}

int run(const std::vector<std::string>& arguments) {
  const auto options = read_options(arguments);
  if (!options) {
    (options.error().exit_code == 0 ? std::cout : std::cerr) << options.error().text;
    return options.error().exit_code;
  }
  start_log(options->log_level);
  Error error;
  if (options->simulate) {
    error = become(simulation_command(arguments, own_path()));
  } else {
    const Result<void> served =
        options->replay_file.empty() ? serve(*options, block_end_signals()) : replay(replay_of(*options), std::cout);
    if (served) return 0;
    error = served.error();
  }
  std::cerr << "goniod: " << explain(error) << '\n';
  return traits(error.code).exit_code;
}

}  // namespace
}  // namespace gonio::daemon

int main(int argc, char** argv) {
  return gonio::daemon::run({argv + 1, argv + argc});
}
