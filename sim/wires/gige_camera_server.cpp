#include "sim/wires/gige_camera_server.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/wires/big_endian.h"

namespace gonio::sim {
namespace {

constexpr std::uint32_t kControlBits = 0x3;  // exclusive access, control access
constexpr std::size_t kLongestDatagram = 576;
constexpr std::size_t kMostMemory = 536;  // of one READMEM

bool is_same(const sockaddr_in& a, const sockaddr_in& b) {
  return a.sin_port == b.sin_port && a.sin_addr.s_addr == b.sin_addr.s_addr;
}

double in_microseconds(Duration d) {
  return in_seconds(d) * 1e6;
}

// Feature writes of 8 bytes come as two words: they mean something when the second has come.
bool is_number(std::uint32_t at) {
  return at == address::kExposureUs || at == address::kExposureUs + 4 || at == address::kGainDb ||
         at == address::kGainDb + 4;
}

}  // namespace

Result<std::unique_ptr<GigeCameraServer>> GigeCameraServer::start(LiveInstrument& instrument,
                                                                  const std::string& address) {
  auto control = bind_udp(address, kGvcpPort);
  if (!control) return failure(std::move(control).error());
  auto stream = bind_udp(address, 0);
  if (!stream) return failure(std::move(stream).error());
  auto broadcasts = hear_broadcasts(kGvcpPort);
  if (!broadcasts) return failure(std::move(broadcasts).error());
  auto wake_up = make_wake_up();
  if (!wake_up) return failure(std::move(wake_up).error());
  const CameraIdentity identity = instrument.with([&](LiveInstrument::Parts& parts) {
    const DetectorSpec& detector = parts.instrument.scene().detector;
    return CameraIdentity{
        .address = address,
        .serial = detector.serial,
        .width_px = detector.width_px,
        .height_px = detector.height_px,
        .bits = detector.bits,
        .pixel_format = detector.pixel_format,
        .shortest_exposure_us = in_microseconds(parts.camera.shortest_exposure()),
        .longest_exposure_us = in_microseconds(parts.camera.longest_exposure()),
        .most_gain_db = CameraModel::kMostGainDb,
        .temperature_c =
            detector.has_temperature ? std::optional(in_celsius(parts.camera.temperature(parts.now))) : std::nullopt,
        .heartbeat_timeout_ms = static_cast<std::uint32_t>(std::lround(1000.0 * detector.control_heartbeat_wall_s))};
  });
  std::unique_ptr<GigeCameraServer> server(new GigeCameraServer(
      instrument, identity, *std::move(control), *std::move(broadcasts), *std::move(stream), *std::move(wake_up)));
  server->thread_ = std::jthread([s = server.get()](const std::stop_token& stop) { s->run(stop); });
  return server;
}

GigeCameraServer::GigeCameraServer(LiveInstrument& instrument, CameraIdentity identity, FileDescriptor control,
                                   FileDescriptor broadcasts, FileDescriptor stream, FileDescriptor wake_up)
    : instrument_(instrument),
      identity_(std::move(identity)),
      control_(std::move(control)),
      broadcasts_(std::move(broadcasts)),
      stream_socket_(std::move(stream)),
      wake_up_(std::move(wake_up)),
      registers_(identity_) {
  power_up();
}

GigeCameraServer::~GigeCameraServer() {
  thread_.request_stop();
  wake(wake_up_);
}

void GigeCameraServer::set_silent(bool on) {
  if (is_silent_.exchange(on) && !on) ++power_ups_wanted_;
  wake(wake_up_);
}

void GigeCameraServer::power_up() {
  registers_ = CameraRegisters(identity_);
  controller_.reset();
  stream_.clear();
  late_.reset();
  // The first exposure setting lies inside the limits by construction.
  (void)apply_settings();
}

void GigeCameraServer::power_up_if_wanted() {
  const unsigned wanted = power_ups_wanted_;
  if (power_ups_ == wanted) return;
  power_ups_ = wanted;
  power_up();
}

timespec GigeCameraServer::poll_timeout(std::optional<Instant> due) const {
  constexpr Duration kLongest = std::chrono::milliseconds(100);  // how late a silent controller may be noticed
  const Duration left = due ? std::clamp(*due - instrument_.clock().now(), Duration::zero(), kLongest) : kLongest;
  return {.tv_sec = 0, .tv_nsec = left.count()};
}

void GigeCameraServer::run(const std::stop_token& stop) {
  std::optional<Instant> due;
  while (!stop.stop_requested()) {
    std::array<pollfd, 3> watched{
        {{wake_up_.get(), POLLIN, 0}, {control_.get(), POLLIN, 0}, {broadcasts_.get(), POLLIN, 0}}};
    const timespec timeout = poll_timeout(due);
    if (::ppoll(watched.data(), watched.size(), &timeout, nullptr) < 0) continue;
    drain(wake_up_);
    power_up_if_wanted();  // before anything that was sent after it is read
    follow_faults();
    if ((watched[1].revents & POLLIN) != 0) receive();
    if ((watched[2].revents & POLLIN) != 0) answer_search();
    due = work(instrument_.clock().now());
  }
}

std::optional<Instant> GigeCameraServer::work(Instant now) {
  release_silent_controller(now);
  collect_frame();
  if (late_ && late_->due <= now) put_on_stream(std::exchange(late_, std::nullopt)->frame);
  auto due = stream_.send_due(stream_socket_.get(), now);
  const auto exposure_end = instrument_.with([](LiveInstrument::Parts& parts) { return parts.camera.ready_at(); });
  if (exposure_end) due = due ? std::min(*due, *exposure_end) : *exposure_end;
  if (late_) due = due ? std::min(*due, late_->due) : late_->due;
  return due;
}

void GigeCameraServer::collect_frame() {
  struct Finished {
    Exposure exposure;
    std::uint64_t frame_id;
    std::optional<PlannedFault> fault;
  };
  const auto finished = instrument_.with([](LiveInstrument::Parts& parts) -> std::optional<Finished> {
    const auto exposure = parts.camera.collect_exposure(parts.now);
    if (!exposure) return std::nullopt;
    return Finished{*exposure, parts.camera.frames(),
                    parts.instrument.strike(FaultMoment::Frame, parts.now, [](const PlannedFault&) { return true; })};
  });
  const bool is_streaming =
      controller_ && registers_.word(address::kAcquisition) != 0 && !is_silent_ && !is_unplugged_ && !is_taken_;
  if (!finished || !is_streaming) return;
  // Outside of the lock: a frame takes longer to draw than any other request.
  CameraFrame frame = make_frame(instrument_.scene(), finished->exposure, finished->frame_id);
  if (finished->fault)
    spoil(*finished->fault, std::move(frame));
  else
    put_on_stream(std::move(frame));
}

void GigeCameraServer::put_on_stream(CameraFrame frame) {
  sockaddr_in receiver{};
  receiver.sin_family = AF_INET;
  receiver.sin_port = htons(static_cast<std::uint16_t>(registers_.word(address::kStreamPort)));
  receiver.sin_addr.s_addr = htonl(registers_.word(address::kStreamAddress));
  stream_.add(frame, region(), registers_.word(address::kPacketSize) & 0xFFFFU, receiver);
  last_frame_ = std::move(frame);
}

void GigeCameraServer::spoil(const PlannedFault& fault, CameraFrame frame) {
  switch (fault.kind) {
    case FaultKind::FrameLost:
      return;
    case FaultKind::FrameLate:
      late_ = LateFrame{instrument_.clock().now() + fault.late(), std::move(frame)};
      return;
    case FaultKind::FrameStale:
      return put_on_stream(last_frame_ ? CameraFrame(*last_frame_) : std::move(frame));
    case FaultKind::FrameDuplicated: {
      CameraFrame twin = frame;
      put_on_stream(std::move(frame));
      twin.frame_id = instrument_.with([](LiveInstrument::Parts& parts) { return parts.camera.take_frame_id(); });
      return put_on_stream(std::move(twin));
    }
    case FaultKind::PacketsLost:
    case FaultKind::PacketsGone:
      stream_.lose_packets(fault.packets(), fault.kind == FaultKind::PacketsGone);
      return put_on_stream(std::move(frame));
    case FaultKind::FrameSaturated:
      std::ranges::fill(frame.pixels, static_cast<std::uint16_t>(instrument_.scene().detector.full_scale_dn()));
      return put_on_stream(std::move(frame));
    default:
      return put_on_stream(std::move(frame));
  }
}

bool GigeCameraServer::is_active(FaultKind kind) {
  return instrument_.with(
      [kind](LiveInstrument::Parts& parts) { return parts.instrument.faults().active(kind, parts.now) != nullptr; });
}

// A cable that is back in, a controller that has gone again.
void GigeCameraServer::follow_faults() {
  const bool was_unplugged = std::exchange(is_unplugged_, is_active(FaultKind::CameraSilent));
  if (was_unplugged && !is_unplugged_) power_up();
  const bool was_taken = std::exchange(is_taken_, is_active(FaultKind::ControlTaken));
  if (is_taken_ != was_taken) release_control();
  if (is_taken_) registers_.set_word(address::kControl, kControlBits);
}

SentRegion GigeCameraServer::region() const {
  const auto number = [&](std::uint32_t at) { return static_cast<int>(registers_.word(at)); };
  return {.width = number(address::kWidth),
          .height = number(address::kHeight),
          .offset_x = number(address::kOffsetX),
          .offset_y = number(address::kOffsetY),
          .pixel_format = registers_.word(address::kPixelFormat)};
}

void GigeCameraServer::release_silent_controller(Instant now) {
  const auto timeout = std::chrono::milliseconds(registers_.word(address::kHeartbeatTimeoutMs));
  if (controller_ && now > controller_seen_ + timeout) release_control();
}

void GigeCameraServer::release_control() {
  controller_.reset();
  registers_.set_word(address::kControl, 0);
  registers_.set_word(address::kAcquisition, 0);
  stream_.clear();
}

bool GigeCameraServer::is_controller() const {
  return controller_ && is_same(*controller_, sender_);
}

void GigeCameraServer::receive() {
  std::array<std::uint8_t, kLongestDatagram + 1> bytes{};
  socklen_t size = sizeof sender_;
  const ssize_t n =
      ::recvfrom(control_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&sender_), &size);
  if (n <= 0 || is_silent_ || is_unplugged_) return;
  const auto request = parse_gvcp(std::span(bytes).first(static_cast<std::size_t>(n)));
  if (!request) return;
  if (is_controller()) controller_seen_ = instrument_.clock().now();
  std::vector<std::uint8_t> answer;
  const GvcpStatus status = serve(*request, answer);
  if (!request->wants_acknowledge || request->command == GvcpCommand::PacketResend) return;
  if (status != GvcpStatus::Success && request->command != GvcpCommand::WriteRegister) answer.clear();
  const auto datagram = gvcp_acknowledge(*request, status, answer);
  ::sendto(control_.get(), datagram.data(), datagram.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&sender_),
           size);
}

// Somebody looks for cameras. Only this machine's loopback is answered: elsewhere a simulated camera is not to be met.
void GigeCameraServer::answer_search() {
  std::array<std::uint8_t, kLongestDatagram + 1> bytes{};
  sockaddr_in sender{};
  socklen_t size = sizeof sender;
  const ssize_t n =
      ::recvfrom(broadcasts_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&sender), &size);
  constexpr std::uint32_t kLoopback = 127;
  if (n <= 0 || is_silent_ || ntohl(sender.sin_addr.s_addr) >> 24U != kLoopback) return;
  const auto request = parse_gvcp(std::span(bytes).first(static_cast<std::size_t>(n)));
  if (!request || request->command != GvcpCommand::Discovery) return;
  const auto datagram = gvcp_acknowledge(*request, GvcpStatus::Success, registers_.discovery());
  ::sendto(control_.get(), datagram.data(), datagram.size(), MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&sender),
           size);
}

GvcpStatus GigeCameraServer::serve(const GvcpRequest& request, std::vector<std::uint8_t>& answer) {
  switch (request.command) {
    case GvcpCommand::Discovery: {
      const auto device = registers_.discovery();
      answer.assign(device.begin(), device.end());
      return GvcpStatus::Success;
    }
    case GvcpCommand::ReadRegister:
      return read_registers(request, answer);
    case GvcpCommand::ReadMemory:
      return read_memory(request, answer);
    case GvcpCommand::WriteRegister:
      return write_registers(request, answer);
    case GvcpCommand::WriteMemory:
      return write_memory(request, answer);
    case GvcpCommand::PacketResend: {
      if (request.payload.size() < 12) return GvcpStatus::InvalidParameter;
      constexpr std::uint32_t kPacketId = 0xFFFFFF;
      stream_.resend(stream_socket_.get(), get16(request.payload, 2), get32(request.payload, 4) & kPacketId,
                     get32(request.payload, 8) & kPacketId);
      return GvcpStatus::Success;
    }
  }
  return GvcpStatus::NotImplemented;
}

GvcpStatus GigeCameraServer::read_registers(const GvcpRequest& request, std::vector<std::uint8_t>& answer) const {
  if (request.payload.empty() || request.payload.size() % 4 != 0) return GvcpStatus::InvalidParameter;
  for (std::size_t k = 0; k < request.payload.size(); k += 4) {
    const std::uint32_t at = get32(request.payload, k);
    if (at % 4 != 0) return GvcpStatus::BadAlignment;
    const GvcpStatus status = registers_.read(at, 4, answer);
    if (status != GvcpStatus::Success) return status;
  }
  return GvcpStatus::Success;
}

GvcpStatus GigeCameraServer::read_memory(const GvcpRequest& request, std::vector<std::uint8_t>& answer) const {
  if (request.payload.size() != 8) return GvcpStatus::InvalidParameter;
  const std::uint32_t at = get32(request.payload, 0);
  const std::size_t count = get16(request.payload, 6);
  if (count % 4 != 0 || at % 4 != 0) return GvcpStatus::BadAlignment;
  if (count == 0 || count > kMostMemory) return GvcpStatus::InvalidParameter;
  append32(answer, at);
  return registers_.read(at, count, answer);
}

GvcpStatus GigeCameraServer::write_registers(const GvcpRequest& request, std::vector<std::uint8_t>& answer) {
  if (request.payload.empty() || request.payload.size() % 8 != 0) return GvcpStatus::InvalidParameter;
  GvcpStatus status = GvcpStatus::Success;
  std::uint32_t written = 0;
  for (std::size_t k = 0; k < request.payload.size() && status == GvcpStatus::Success; k += 8) {
    const std::uint32_t at = get32(request.payload, k);
    status = write_word(at, get32(request.payload, k + 4));
    if (status == GvcpStatus::Success) status = apply(at);
    if (status == GvcpStatus::Success) ++written;
  }
  append32(answer, written);  // 16 reserved bits, then how many
  return status;
}

GvcpStatus GigeCameraServer::write_memory(const GvcpRequest& request, std::vector<std::uint8_t>& answer) {
  if (request.payload.size() < 8) return GvcpStatus::InvalidParameter;
  if (request.payload.size() % 4 != 0) return GvcpStatus::BadAlignment;
  const std::uint32_t first = get32(request.payload, 0);
  const auto words = static_cast<std::uint32_t>(request.payload.size() / 4 - 1);
  for (std::uint32_t k = 0; k < words; ++k) {
    const GvcpStatus status = write_word(first + 4 * k, get32(request.payload, 4 + 4 * std::size_t{k}));
    if (status != GvcpStatus::Success) return status;
  }
  append32(answer, 4 * words);
  // All words first, then what they do: an 8-byte number is whole by then.
  for (std::uint32_t k = 0; k < words; ++k) {
    const GvcpStatus status = apply(first + 4 * k);
    if (status != GvcpStatus::Success) return status;
  }
  return GvcpStatus::Success;
}

GvcpStatus GigeCameraServer::write_word(std::uint32_t at, std::uint32_t value) {
  if (is_taken_ || (controller_ ? !is_controller() : at != address::kControl)) return GvcpStatus::AccessDenied;
  const GvcpStatus status = registers_.check_write(at, value);
  if (status == GvcpStatus::Success) registers_.set_word(at, value);
  return status;
}

GvcpStatus GigeCameraServer::apply(std::uint32_t at) {
  if (at == address::kControl) {
    if ((registers_.word(at) & kControlBits) == 0)
      release_control();
    else
      controller_ = sender_;
    controller_seen_ = instrument_.clock().now();
  }
  if (at == address::kAcquisition && registers_.word(at) != 0) {
    stream_.clear();
    late_.reset();
    instrument_.with([](LiveInstrument::Parts& parts) { parts.camera.restart_frame_ids(); });
  }
  if (at == address::kTriggerSoftware && registers_.word(at) != 0) return trigger();
  if (at >= address::kWidth && at <= address::kPixelFormat) registers_.refresh_payload_size();
  const bool is_first_half = at == address::kExposureUs || at == address::kGainDb;
  return is_number(at) && !is_first_half ? apply_settings() : GvcpStatus::Success;
}

GvcpStatus GigeCameraServer::apply_settings() {
  const double exposure_us = registers_.number(address::kExposureUs);
  const double gain_db = registers_.number(address::kGainDb);
  return instrument_.with([&](LiveInstrument::Parts& parts) {
    const bool is_taken = std::isfinite(exposure_us) &&
                          parts.camera.set_exposure(std::chrono::round<Duration>(
                              std::chrono::duration<double, std::micro>(std::clamp(exposure_us, 0.0, 1e12)))) &&
                          parts.camera.set_gain(gain_db);
    // What the camera does not take does not stay in its registers either.
    registers_.set_number(address::kExposureUs, in_microseconds(parts.camera.exposure()));
    registers_.set_number(address::kGainDb, parts.camera.gain_db());
    return is_taken ? GvcpStatus::Success : GvcpStatus::InvalidParameter;
  });
}

GvcpStatus GigeCameraServer::trigger() {
  registers_.set_word(address::kTriggerSoftware, 0);
  if (registers_.word(address::kAcquisition) == 0 || registers_.word(address::kTriggerMode) == 0)
    return GvcpStatus::Busy;
  const bool is_heard = instrument_.with([](LiveInstrument::Parts& parts) {
    const auto fault = parts.instrument.strike(FaultMoment::Exposure, parts.now, [](const PlannedFault& f) {
      return traits(f.kind).device == FaultDevice::Camera;
    });
    return (fault && fault->kind == FaultKind::TriggerIgnored) || parts.camera.trigger(parts.now);
  });
  return is_heard ? GvcpStatus::Success : GvcpStatus::Busy;
}

}  // namespace gonio::sim
