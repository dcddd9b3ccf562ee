#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/result.h"
#include "drivers/links/tape/tape_sink.h"

namespace gonio::drivers {

/// Writes a tape file on a thread of its own: `put` takes a place in a bounded queue and no more; packing, checksums
/// and the disk are the thread's. Each piece of work ends with a write, so that a killed program loses what was in the
/// queue, a few milliseconds as a rule. When the disk takes no more, or the queue is full because it is too slow, the
/// recording ends with a word to `on_end`; what was written stays a good tape. Threads: any.
class TapeWriter final : public TapeSink {
 public:
  struct Config {
    std::string file;                                    ///< must not be there: a recording is never overwritten
    std::size_t most_waiting = std::size_t{256} << 20U;  ///< bytes of memory of the records that wait
  };
  /// Called once, on any thread, when the recording ends before the program does.
  using OnEnd = std::function<void(const Error&)>;

  /// Errors: InvalidInput (the file is there, or cannot be made).
  [[nodiscard]] static Result<std::unique_ptr<TapeWriter>> create(const Config& config, const TapeStart& start,
                                                                  OnEnd on_end);
  /// Writes what waits, and the end.
  ~TapeWriter() override;
  TapeWriter(const TapeWriter&) = delete;
  TapeWriter& operator=(const TapeWriter&) = delete;

  void put(TapeRecord record) override;

  /// So far. Threads: any.
  [[nodiscard]] std::int64_t bytes_written() const;

 private:
  TapeWriter(Config config, int descriptor, OnEnd on_end);
  void run();
  [[nodiscard]] Result<void> write(const TapeRecord& record);
  [[nodiscard]] Result<void> write_all(std::span<const std::uint8_t> bytes);
  void end(const Error& error);

  const Config config_;
  const int descriptor_;
  const OnEnd on_end_;

  mutable std::mutex mutex_;  ///< guards all that follows
  std::condition_variable arrived_;
  std::deque<TapeRecord> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::int64_t bytes_written_ = 0;
  bool is_closing_ = false;
  bool has_ended_ = false;
  std::thread thread_;
};

}  // namespace gonio::drivers
