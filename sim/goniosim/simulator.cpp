#include "sim/goniosim/simulator.h"

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "sim/scene/check_fault.h"
#include "sim/wires/modbus_server.h"
#include "sim/wires/rtu_server.h"

namespace gonio::sim {
namespace {

// An address for the camera of this folder: the same each time, and another one for another folder.
std::string camera_candidate(const std::string& folder, unsigned attempt) {
  const std::uint64_t hash = std::hash<std::string>{}(folder) + std::uint64_t{attempt} * 0x9E3779B97F4A7C15ULL;
  constexpr std::uint64_t kHosts = 253;
  return fmt::format("127.{}.{}.{}", 1 + (hash >> 40U) % kHosts, 1 + (hash >> 24U) % kHosts, 1 + (hash >> 8U) % kHosts);
}

}  // namespace

Simulator::Simulator(Scene scene, StateFolder folder, InstrumentMemory memory, ExposureJournal journal,
                     const Clock& clock)
    : folder_(std::move(folder)),
      journal_(std::move(journal)),
      instrument_(std::move(scene), std::move(memory), clock) {
  instrument_.with([this](LiveInstrument::Parts& parts) {
    parts.instrument.tell_exposures_to([this](const ExposureNote& exposure) { journal_.note(exposure); });
  });
}

Result<std::unique_ptr<Simulator>> Simulator::start(Scene scene, const std::string& state_folder,
                                                    const WireWishes& wishes, const Clock& clock) {
  for (const PlannedFault& fault : scene.faults) GONIO_TRY(check_fault(fault, scene));
  auto folder = StateFolder::open(state_folder);
  if (!folder) return failure(std::move(folder).error());
  folder->remove_ready();
  auto last = folder->load();
  if (!last) return failure(std::move(last).error());
  auto journal = ExposureJournal::open(folder->exposure_journal());
  if (!journal) return failure(std::move(journal).error());
  std::unique_ptr<Simulator> simulator(
      new Simulator(std::move(scene), *std::move(folder), last->instrument, *std::move(journal), clock));
  GONIO_TRY(simulator->bind(*last, wishes));
  GONIO_TRY(simulator->folder_.write_papers(simulator->instrument_.scene(), simulator->addresses_));
  GONIO_TRY(simulator->save());
  GONIO_TRY(simulator->folder_.write_ready(simulator->addresses_));
  return simulator;
}

Simulator::~Simulator() {
  if (!control_) return;  // it never came up
  folder_.remove_ready();
  (void)save();  // on the way out there is nobody left to tell
}

Result<void> Simulator::bind_stage(const SimulatorState& last, const WireWishes& wishes) {
  if (wishes.wants_rtu) {
    addresses_.stage_port = last.stage_port;
    addresses_.stage_line = folder_.stage_line();
    addresses_.stage_baud = wishes.stage_baud;
    auto stage = RtuServer::start(instrument_, addresses_.stage_line, {.baud = wishes.stage_baud});
    if (!stage) return failure(std::move(stage).error());
    stage_ = *std::move(stage);
    return {};
  }
  const std::uint16_t port = wishes.stage_port != 0 ? wishes.stage_port : last.stage_port;
  auto stage = ModbusServer::start(instrument_, addresses_.stage_host, port);
  if (!stage) return failure(std::move(stage).error());
  addresses_.stage_port = (*stage)->port();
  stage_ = *std::move(stage);
  return {};
}

Result<void> Simulator::bind(const SimulatorState& last, const WireWishes& wishes) {
  GONIO_TRY(bind_stage(last, wishes));
  GONIO_TRY(bind_camera(wishes.camera_address.empty() ? last.camera_address : wishes.camera_address));
  GONIO_TRY(plug_radiometers(wishes));
  auto control = ControlServer::start(folder_.control_socket(), instrument_, *stage_, usb_.get());
  if (!control) return failure(std::move(control).error());
  control_ = *std::move(control);
  return {};
}

// After the other wires: from here on this process sees devices through the emulation.
Result<void> Simulator::plug_radiometers(const WireWishes& wishes) {
  std::vector<LiveRadiometer*> all;
  for (const RadiometerSpec& spec : instrument_.scene().radiometers) {
    all.push_back(&radiometers_.emplace_back(instrument_, spec));
  }
  if (all.empty()) return {};
  if (!wishes.make_usb) {
    return failure({.code = ErrorCode::Internal,
                    .device = "goniosim",
                    .tried = "serve the radiometers",
                    .seen = "this program has no emulated USB",
                    .limit = {}});
  }
  usb_ = wishes.make_usb(all);
  for (std::size_t port = 0; port < all.size(); ++port) GONIO_TRY(usb_->plug(port));
  addresses_.usb_environment = usb_->environment();
  return {};
}

Result<void> Simulator::bind_camera(const std::string& wished) {
  constexpr unsigned kAttempts = 32;
  for (unsigned attempt = 0;; ++attempt) {
    addresses_.camera_address = wished.empty() ? camera_candidate(folder_.path(), attempt) : wished;
    auto camera = GigeCameraServer::start(instrument_, addresses_.camera_address);
    if (camera) {
      camera_ = *std::move(camera);
      return {};
    }
    const bool may_try_another =
        wished.empty() && attempt + 1 < kAttempts && camera.error().code == ErrorCode::PortBusy;
    if (!may_try_another) return failure(std::move(camera).error());
  }
}

Result<void> Simulator::save() {
  const InstrumentMemory memory =
      instrument_.with([](LiveInstrument::Parts& parts) { return parts.instrument.memory(parts.now); });
  if (has_saved_ && memory.exposures == saved_exposures_ && memory.stage.moves == saved_moves_) return {};
  GONIO_TRY(folder_.save(
      {.instrument = memory, .stage_port = addresses_.stage_port, .camera_address = addresses_.camera_address}));
  has_saved_ = true;
  saved_exposures_ = memory.exposures;
  saved_moves_ = memory.stage.moves;
  return {};
}

}  // namespace gonio::sim
