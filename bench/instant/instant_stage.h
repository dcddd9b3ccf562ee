#pragma once

#include <modbus/modbus.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "protocol/stage/register_map.h"

namespace gonio::bench {

/// The least stage that there can be on Modbus TCP: axes are there as soon as they are told to go. A thread a
/// connection, by libmodbus alone; nothing of the simulator.
class InstantStage {
 public:
  InstantStage();
  ~InstantStage();
  InstantStage(const InstantStage&) = delete;
  InstantStage& operator=(const InstantStage&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// One exposure: the gate has opened and closed. Threads: any.
  void count_gate();
  /// Whether the detector's shutter is open. Threads: any.
  [[nodiscard]] bool is_lit();

 private:
  using Context = std::unique_ptr<modbus_t, void (*)(modbus_t*)>;
  void accept();
  void serve(int socket);
  void set(stage::Field field, std::int64_t value);
  [[nodiscard]] std::int64_t get(stage::Field field) const;
  void act();
  void act_before_reading(std::span<const std::uint8_t> request);

  stage::RegisterMap map_ = stage::own_register_map();
  std::unique_ptr<modbus_mapping_t, void (*)(modbus_mapping_t*)> registers_;
  std::mutex mutex_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> ends_ = false;
  std::vector<int> sockets_;
  std::vector<std::jthread> threads_;
  std::jthread acceptor_;
};

}  // namespace gonio::bench
