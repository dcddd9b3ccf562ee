#include "drivers/links/tape/taped_camera_link.h"

#include <utility>

#include "drivers/links/tape/exchange_bytes.h"

namespace gonio::drivers {
namespace {

Result<void> put(const TapeChannel& channel, TapeExchange exchange, Result<void> outcome) {
  if (!outcome) exchange.error = outcome.error();
  channel.put(std::move(exchange));
  return outcome;
}

template <class T>
Result<T> put(const TapeChannel& channel, TapeExchange exchange, Result<T> outcome) {
  if (outcome) {
    exchange.reply = bytes_of(*outcome);
  } else {
    exchange.error = outcome.error();
  }
  channel.put(std::move(exchange));
  return outcome;
}

bool put(const TapeChannel& channel, TapeExchange exchange, bool answer) {
  exchange.reply = bytes_of(answer);
  channel.put(std::move(exchange));
  return answer;
}

}  // namespace

Result<DetectorIdentity> TapedCameraLink::open() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraOpen);
  return put(channel_, std::move(exchange), link_.open());
}

void TapedCameraLink::close() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraClose);
  link_.close();
  channel_.put(std::move(exchange));
}

bool TapedCameraLink::is_open() const {
  TapeExchange exchange = channel_.ask(TapeCall::CameraIsOpen);
  return put(channel_, std::move(exchange), link_.is_open());
}

bool TapedCameraLink::has_lost_control() const {
  TapeExchange exchange = channel_.ask(TapeCall::CameraHasLostControl);
  return put(channel_, std::move(exchange), link_.has_lost_control());
}

Result<void> TapedCameraLink::set_format(const CameraFormat& format) {
  TapeExchange exchange = channel_.ask(TapeCall::CameraSetFormat, bytes_of(format));
  return put(channel_, std::move(exchange), link_.set_format(format));
}

Result<CameraFormat> TapedCameraLink::format() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraFormatRead);
  return put(channel_, std::move(exchange), link_.format());
}

Result<void> TapedCameraLink::set_exposure(const ExposureSettings& settings) {
  TapeExchange exchange = channel_.ask(TapeCall::CameraSetExposure, bytes_of(settings));
  return put(channel_, std::move(exchange), link_.set_exposure(settings));
}

Result<ExposureSettings> TapedCameraLink::exposure() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraExposureRead);
  return put(channel_, std::move(exchange), link_.exposure());
}

Result<std::optional<double>> TapedCameraLink::temperature_c() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraTemperature);
  return put(channel_, std::move(exchange), link_.temperature_c());
}

Result<void> TapedCameraLink::start() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraStart);
  return put(channel_, std::move(exchange), link_.start());
}

void TapedCameraLink::stop() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraStop);
  link_.stop();
  channel_.put(std::move(exchange));
}

bool TapedCameraLink::is_streaming() const {
  TapeExchange exchange = channel_.ask(TapeCall::CameraIsStreaming);
  return put(channel_, std::move(exchange), link_.is_streaming());
}

Result<void> TapedCameraLink::trigger() {
  TapeExchange exchange = channel_.ask(TapeCall::CameraTrigger);
  return put(channel_, std::move(exchange), link_.trigger());
}

// How long it may wait is no part of the request: it follows from clocks, and nothing of it goes over the wire.
Result<std::optional<CameraFrame>> TapedCameraLink::pop(Duration wait) {
  TapeExchange exchange = channel_.ask(TapeCall::CameraPop);
  Result<std::optional<CameraFrame>> frame = link_.pop(wait);
  if (frame && *frame) exchange.pixels = (*frame)->pixels;
  return put(channel_, std::move(exchange), std::move(frame));
}

}  // namespace gonio::drivers
