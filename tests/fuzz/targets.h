#pragma once

#include <array>
#include <string_view>

#include "tests/fuzz/byte_source.h"

namespace gonio::fuzz {

// One function a format: it takes any bytes and returns, or throws BrokenPromise. What each does stands above its
// definition, in the file of its name in targets/.
void modbus_pdu(Bytes input);
void modbus_tcp(Bytes input);
void modbus_rtu(Bytes input);
void stage_state(Bytes input);
void usbtmc_message(Bytes input);
void scpi_text(Bytes input);
void radiometer(Bytes input);
void tape(Bytes input);
void pixels(Bytes input);
void frame(Bytes input);
void instrument_toml(Bytes input);
void plan_toml(Bytes input);
void reference_toml(Bytes input);
void scene_toml(Bytes input);
void api_text(Bytes input);
void modbus_request(Bytes input);
void gvcp_request(Bytes input);
void usbtmc_device(Bytes input);
void brdf_file(Bytes input);

struct Target {
  std::string_view name;
  void (*run)(Bytes input);
};

inline constexpr std::array kTargets{
    Target{"modbus_pdu", modbus_pdu},
    Target{"modbus_tcp", modbus_tcp},
    Target{"modbus_rtu", modbus_rtu},
    Target{"stage_state", stage_state},
    Target{"usbtmc_message", usbtmc_message},
    Target{"scpi_text", scpi_text},
    Target{"radiometer", radiometer},
    Target{"tape", tape},
    Target{"pixels", pixels},
    Target{"frame", frame},
    Target{"instrument_toml", instrument_toml},
    Target{"plan_toml", plan_toml},
    Target{"reference_toml", reference_toml},
    Target{"scene_toml", scene_toml},
    Target{"api_text", api_text},
    Target{"modbus_request", modbus_request},
    Target{"gvcp_request", gvcp_request},
    Target{"usbtmc_device", usbtmc_device},
    Target{"brdf_file", brdf_file},
};

}  // namespace gonio::fuzz
