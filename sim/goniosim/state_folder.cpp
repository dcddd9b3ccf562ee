#include "sim/goniosim/state_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "sim/goniosim/exposure_journal.h"

namespace gonio::sim {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Error folder_error(ErrorCode code, std::string tried, std::string seen) {
  return {.code = code, .device = "goniosim", .tried = std::move(tried), .seen = std::move(seen)};
}

json to_json(const std::map<ExposedPlace, std::uint64_t>& places) {
  json rows = json::array();
  for (const auto& [place, count] : places) {
    rows.push_back({static_cast<int>(place.station), place.centidegrees[0], place.centidegrees[1],
                    place.centidegrees[2], place.is_lit, count});
  }
  return rows;
}

json to_json(const SimulatorState& state) {
  const InstrumentMemory& memory = state.instrument;
  json axes = json::array();
  if (memory.stage.positions) axes = *memory.stage.positions;
  return {{"boot_counter", memory.stage.boot_counter},
          {"positions", axes},
          {"lags", memory.stage.lags},
          {"moves", memory.stage.moves},
          {"exposures", memory.exposures},
          {"lit_exposures", memory.lit_exposures},
          {"scene_time_s", memory.scene_time_s},
          {"places", to_json(memory.places)},
          {"stage_port", state.stage_port},
          {"camera_address", state.camera_address}};
}

SimulatorState state_of(const json& text) {
  SimulatorState state;
  InstrumentMemory& memory = state.instrument;
  memory.stage.boot_counter = text.at("boot_counter").get<std::uint32_t>();
  const auto positions = text.at("positions").get<std::vector<double>>();
  if (positions.size() == stage::kAxisCount) {
    memory.stage.positions = stage::PerAxis<double>{};
    std::copy(positions.begin(), positions.end(), memory.stage.positions->begin());
  }
  // A folder of before there was backlash has no lags.
  const auto lags = text.value("lags", std::vector<double>());
  if (lags.size() == stage::kAxisCount) std::copy(lags.begin(), lags.end(), memory.stage.lags.begin());
  memory.stage.moves = text.at("moves").get<std::uint64_t>();
  memory.exposures = text.at("exposures").get<std::uint64_t>();
  memory.lit_exposures = text.at("lit_exposures").get<std::uint64_t>();
  memory.scene_time_s = text.at("scene_time_s").get<double>();
  for (const json& row : text.at("places")) {
    const ExposedPlace place{.station = static_cast<Station>(row.at(0).get<int>()),
                             .centidegrees = {row.at(1).get<int>(), row.at(2).get<int>(), row.at(3).get<int>()},
                             .is_lit = row.at(4).get<bool>()};
    memory.places[place] = row.at(5).get<std::uint64_t>();
  }
  state.stage_port = text.at("stage_port").get<std::uint16_t>();
  state.camera_address = text.at("camera_address").get<std::string>();
  return state;
}

}  // namespace

Result<StateFolder> StateFolder::open(const std::string& path) {
  const std::string tried = fmt::format("use the folder {}", path);
  std::error_code trouble;
  fs::create_directories(fs::path(path) / "reference", trouble);
  if (trouble) return failure(folder_error(ErrorCode::FileUnreadable, tried, trouble.message()));
  const std::string absolute = fs::canonical(path, trouble).string();
  FileDescriptor lock(::open((absolute + "/lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock.get() < 0) return failure(folder_error(ErrorCode::FileUnreadable, tried, std::strerror(errno)));
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    return failure(folder_error(ErrorCode::Busy, tried, "another goniosim lives in it"));
  }
  return StateFolder(absolute, std::move(lock));
}

Result<SimulatorState> StateFolder::load() const {
  std::ifstream file(path_ + "/state.json");
  if (!file) return SimulatorState{};
  const auto journal = ExposureJournal::open(exposure_journal());
  if (!journal) return failure(journal.error());
  try {
    SimulatorState state = state_of(json::parse(file));
    journal->catch_up(state.instrument);
    return state;
  } catch (const json::exception& trouble) {
    return failure(folder_error(ErrorCode::InvalidInput, fmt::format("read {}/state.json", path_), trouble.what()));
  }
}

Result<void> StateFolder::write(const std::string& name, const std::string& text) const {
  const std::string file = path_ + "/" + name;
  const std::string aside = file + ".new";
  {
    std::ofstream out(aside, std::ios::binary | std::ios::trunc);
    out << text;
    if (!out.flush())
      return failure(folder_error(ErrorCode::DiskFull, fmt::format("write {}", file), std::strerror(errno)));
  }
  if (::rename(aside.c_str(), file.c_str()) == 0) return {};
  return failure(folder_error(ErrorCode::DiskFull, fmt::format("write {}", file), std::strerror(errno)));
}

Result<void> StateFolder::save(const SimulatorState& state) const {
  return write("state.json", to_json(state).dump() + "\n");
}

Result<void> StateFolder::write_papers(const Scene& scene, const WireAddresses& addresses) const {
  GONIO_TRY(write("reference/" + scene.reference.serial + ".toml", reference_toml(scene.reference)));
  return write("instrument.toml", instrument_toml(scene, addresses));
}

Result<void> StateFolder::write_ready(const WireAddresses& addresses) const {
  const json ready{{"stage_address", addresses.stage_host},
                   {"stage_port", addresses.stage_port},
                   {"stage_line", addresses.stage_line},
                   {"camera_address", addresses.camera_address},
                   {"instrument", instrument_file()},
                   {"references", path_ + "/reference"},
                   {"control", control_socket()},
                   {"pid", ::getpid()},
                   {"usb_environment", addresses.usb_environment}};
  return write("ready", ready.dump() + "\n");
}

void StateFolder::remove_ready() const {
  ::unlink((path_ + "/ready").c_str());
}

}  // namespace gonio::sim
