#include "drivers/links/tape/tape_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "drivers/links/tape/packing.h"
#include "drivers/links/tape/tape_bytes.h"
#include "drivers/links/tape/tape_format.h"

namespace gonio::drivers {
namespace {

// What a record takes while it waits; only exchanges and inputs are worth counting.
std::size_t memory_of(const TapeRecord& record) {
  std::size_t bytes = sizeof(TapeRecord);
  if (const auto* exchange = std::get_if<TapeExchange>(&record)) {
    bytes += exchange->request.size() + exchange->reply.size() + 2 * exchange->pixels.size();
  } else if (const auto* input = std::get_if<TapeInput>(&record)) {
    bytes += input->text.size();
  }
  return bytes;
}

Error error_of(ErrorCode code, std::string tried, std::string seen, const std::string& file, std::string limit = {}) {
  return {.code = code,
          .device = "tape",
          .tried = std::move(tried),
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file, 0, {}}};
}

}  // namespace

Result<std::unique_ptr<TapeWriter>> TapeWriter::create(const Config& config, const TapeStart& start, OnEnd on_end) {
  const int descriptor = open(config.file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    return failure(error_of(ErrorCode::InvalidInput, "make the tape", std::strerror(errno), config.file));
  }
  std::unique_ptr<TapeWriter> writer(new TapeWriter(config, descriptor, std::move(on_end)));
  GONIO_TRY(writer->write_all(kTapeMagic));
  GONIO_TRY(writer->write(start));
  writer->thread_ = std::thread([raw = writer.get()] { raw->run(); });
  pthread_setname_np(writer->thread_.native_handle(), "tape");
  return writer;
}

TapeWriter::TapeWriter(Config config, int descriptor, OnEnd on_end)
    : config_(std::move(config)), descriptor_(descriptor), on_end_(std::move(on_end)) {}

TapeWriter::~TapeWriter() {
  {
    const std::lock_guard lock(mutex_);
    if (!has_ended_) waiting_.emplace_back(TapeEnd{.reason = "ended"});
    is_closing_ = true;
  }
  arrived_.notify_all();
  if (thread_.joinable()) thread_.join();
  close(descriptor_);
}

void TapeWriter::put(TapeRecord record) {
  const std::size_t bytes = memory_of(record);
  bool is_full = false;
  {
    const std::lock_guard lock(mutex_);
    if (has_ended_ || is_closing_) return;
    is_full = waiting_bytes_ + bytes > config_.most_waiting;
    if (!is_full) {
      waiting_.push_back(std::move(record));
      waiting_bytes_ += bytes;
    }
  }
  if (is_full) {
    return end(error_of(ErrorCode::TooLarge, "record", "the disk is too slow: too much waits to be written",
                        config_.file, fmt::format("{} MiB", config_.most_waiting >> 20U)));
  }
  arrived_.notify_one();
}

std::int64_t TapeWriter::bytes_written() const {
  const std::lock_guard lock(mutex_);
  return bytes_written_;
}

void TapeWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    arrived_.wait(lock, [this] { return !waiting_.empty() || is_closing_ || has_ended_; });
    if (has_ended_ || waiting_.empty()) return;
    const TapeRecord record = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const std::size_t bytes = memory_of(record);
    const Result<void> written = write(record);
    if (!written) return end(written.error());
    lock.lock();
    waiting_bytes_ -= std::min(bytes, waiting_bytes_);
  }
}

void TapeWriter::end(const Error& error) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(has_ended_, true)) return;
    waiting_.clear();
  }
  arrived_.notify_all();
  on_end_(error);
}

Result<void> TapeWriter::write(const TapeRecord& record) {
  const std::vector<std::uint8_t> payload = encode_record(record);
  if (payload.size() > kMostPayload) {
    return failure(error_of(ErrorCode::TooLarge, "record", fmt::format("a record of {} bytes", payload.size()),
                            config_.file, fmt::format("{} bytes", kMostPayload)));
  }
  std::vector<std::uint8_t> framed =
      ByteWriter().u32(static_cast<std::uint32_t>(payload.size())).u32(crc32_of(payload)).take();
  framed.insert(framed.end(), payload.begin(), payload.end());
  return write_all(framed);
}

Result<void> TapeWriter::write_all(std::span<const std::uint8_t> bytes) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const ErrorCode code = errno == ENOSPC ? ErrorCode::DiskFull : ErrorCode::StoreFailed;
      return failure(error_of(code, "record", std::strerror(errno), config_.file));
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  const std::lock_guard lock(mutex_);
  bytes_written_ += count;
  return {};
}

}  // namespace gonio::drivers
