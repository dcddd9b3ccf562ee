// The adapter of libusb: nothing else in this room knows it.
#include "drivers/links/libusb_usbtmc_link.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace gonio::drivers {
namespace {

// Base class, subclass of the interface (USBTMC 1.0, table 43).
constexpr std::uint8_t kApplicationSpecific = 0xFE;
constexpr std::uint8_t kTestAndMeasurement = 3;
constexpr std::size_t kMostNotificationBytes = 64;

struct ExitContext {
  void operator()(libusb_context* context) const { libusb_exit(context); }
};
struct CloseHandle {
  void operator()(libusb_device_handle* handle) const { libusb_close(handle); }
};
struct FreeConfiguration {
  void operator()(libusb_config_descriptor* descriptor) const { libusb_free_config_descriptor(descriptor); }
};
using Handle = std::unique_ptr<libusb_device_handle, CloseHandle>;

class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) : count_(libusb_get_device_list(context, &devices_)) {}
  ~DeviceList() {
    if (devices_ != nullptr) libusb_free_device_list(devices_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  [[nodiscard]] std::span<libusb_device* const> devices() const {
    return {devices_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
  }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t count_;
};

ErrorCode code_of(int error) {
  switch (error) {
    case LIBUSB_ERROR_TIMEOUT:
      return ErrorCode::TimedOut;
    case LIBUSB_ERROR_PIPE:
      return ErrorCode::DeviceRefused;
    case LIBUSB_ERROR_OVERFLOW:
    case LIBUSB_ERROR_IO:
      return ErrorCode::BadReply;
    case LIBUSB_ERROR_BUSY:
      return ErrorCode::ControlLost;
    default:
      return ErrorCode::Unreachable;
  }
}

std::string words_of(int error) {
  switch (error) {
    case LIBUSB_ERROR_PIPE:
      return "the endpoint stalled";
    case LIBUSB_ERROR_NO_DEVICE:
      return "the device is gone";
    case LIBUSB_ERROR_BUSY:
      return "another program has the interface";
    case LIBUSB_ERROR_ACCESS:
      return "no permission for the device's node: install packaging/udev/70-goniod-usbtmc.rules and plug it in again";
    case LIBUSB_ERROR_OVERFLOW:
      return "more bytes than asked for";
    default:
      return libusb_strerror(error);
  }
}

unsigned milliseconds(Duration timeout) {
  const auto whole = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  // 0 would wait for ever.
  return static_cast<unsigned>(std::clamp<std::int64_t>(whole, 1, std::numeric_limits<int>::max()));
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
  std::array<unsigned char, 256> text{};
  if (index == 0) return {};
  const int n = libusb_get_string_descriptor_ascii(handle, index, text.data(), static_cast<int>(text.size()));
  return n > 0 ? std::string(text.begin(), text.begin() + n) : std::string();
}

// The endpoints of a USBTMC interface; nothing when this is another kind.
std::optional<UsbtmcInterface> as_usbtmc(const libusb_interface_descriptor& descriptor) {
  if (descriptor.bInterfaceClass != kApplicationSpecific || descriptor.bInterfaceSubClass != kTestAndMeasurement) {
    return std::nullopt;
  }
  UsbtmcInterface found{.number = descriptor.bInterfaceNumber};
  for (const auto& endpoint : std::span(descriptor.endpoint, descriptor.bNumEndpoints)) {
    const bool is_in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
    const int type = endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK;
    if (type == LIBUSB_TRANSFER_TYPE_BULK) (is_in ? found.bulk_in : found.bulk_out) = endpoint.bEndpointAddress;
    if (type == LIBUSB_TRANSFER_TYPE_INTERRUPT && is_in) found.interrupt_in = endpoint.bEndpointAddress;
  }
  if (found.bulk_in == 0 || found.bulk_out == 0) return std::nullopt;
  return found;
}

std::optional<UsbtmcInterface> usbtmc_interface_of(libusb_device* device) {
  libusb_config_descriptor* read = nullptr;
  if (libusb_get_active_config_descriptor(device, &read) != LIBUSB_SUCCESS) return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, FreeConfiguration> configuration(read);
  for (const auto& interface : std::span(configuration->interface, configuration->bNumInterfaces)) {
    if (interface.num_altsetting == 0) continue;
    if (const auto found = as_usbtmc(*interface.altsetting)) return found;
  }
  return std::nullopt;
}

}  // namespace

struct LibusbUsbtmcLink::Impl {
  explicit Impl(LibusbConfig the_config) : config(std::move(the_config)) {}

  [[nodiscard]] Error error(ErrorCode code, std::string tried, std::string seen, std::string limit = {}) const {
    return {.code = code,
            .device = config.role,
            .tried = std::move(tried),
            .seen = std::move(seen),
            .limit = std::move(limit)};
  }
  [[nodiscard]] std::string open_words() const {
    return fmt::format("open USB device {:04x}:{:04x}", config.vendor_id, config.product_id);
  }

  // What came of one transfer: `done` bytes, of at least `least`.
  Result<void> outcome(int result, int done, int least, const std::string& tried, Duration timeout) const {
    if (result == LIBUSB_SUCCESS && done >= least) return {};
    const std::string limit = fmt::format("{} ms", milliseconds(timeout));
    if (result == LIBUSB_ERROR_TIMEOUT && done > 0) {
      return failure(error(ErrorCode::IncompleteData, tried, fmt::format("{} bytes, then nothing", done), limit));
    }
    if (result == LIBUSB_ERROR_TIMEOUT) return failure(error(ErrorCode::TimedOut, tried, "nothing", limit));
    if (result != LIBUSB_SUCCESS) return failure(error(code_of(result), tried, words_of(result)));
    return failure(
        error(ErrorCode::IncompleteData, tried, fmt::format("{} bytes", done), fmt::format("{} bytes", least)));
  }

  // A device of the kind that is asked for, opened, with its serial number.
  struct Candidate {
    Handle handle;
    std::string serial;
    DetectorIdentity identity;
  };
  Result<Candidate> candidate(libusb_device* device, const libusb_device_descriptor& descriptor) const {
    libusb_device_handle* opened = nullptr;
    const int result = libusb_open(device, &opened);
    if (result != LIBUSB_SUCCESS) return failure(error(code_of(result), open_words(), words_of(result)));
    Candidate found{.handle = Handle(opened), .serial = text_of(opened, descriptor.iSerialNumber), .identity = {}};
    found.identity = {.vendor = text_of(opened, descriptor.iManufacturer),
                      .model = text_of(opened, descriptor.iProduct),
                      .serial = found.serial};
    return found;
  }

  Result<DetectorIdentity> open() {
    libusb_context* made = nullptr;
    if (context == nullptr) {
      const int result = libusb_init(&made);
      if (result != LIBUSB_SUCCESS) return failure(error(ErrorCode::Internal, "start libusb", words_of(result)));
      context.reset(made);
    }
    const DeviceList list(context.get());
    std::vector<std::string> others;
    std::optional<Error> trouble;
    for (libusb_device* device : list.devices()) {
      libusb_device_descriptor descriptor{};
      if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) continue;
      if (descriptor.idVendor != config.vendor_id || descriptor.idProduct != config.product_id) continue;
      auto found = candidate(device, descriptor);
      if (!found) {
        trouble = std::move(found).error();
      } else if (found->serial == config.serial) {
        return claim(device, *std::move(found));
      } else {
        others.push_back(found->serial);
      }
    }
    if (trouble) return failure(*trouble);
    const std::string limit = "serial " + config.serial;
    if (others.empty()) return failure(error(ErrorCode::Unreachable, open_words(), "no such device", limit));
    return failure(
        error(ErrorCode::WrongDevice, open_words(), fmt::format("serial {}", fmt::join(others, ", ")), limit));
  }

  Result<DetectorIdentity> claim(libusb_device* device, Candidate found) {
    const auto usbtmc = usbtmc_interface_of(device);
    if (!usbtmc) return failure(error(ErrorCode::WrongDevice, open_words(), "no USBTMC interface"));
    // The kernel's own usbtmc driver, where it sits, is put back at release.
    libusb_set_auto_detach_kernel_driver(found.handle.get(), 1);
    const int result = libusb_claim_interface(found.handle.get(), usbtmc->number);
    if (result != LIBUSB_SUCCESS) {
      return failure(error(code_of(result), fmt::format("take interface {}", usbtmc->number), words_of(result)));
    }
    handle = std::move(found.handle);
    interface = *usbtmc;
    return std::move(found.identity);
  }

  void close() {
    if (handle == nullptr) return;
    libusb_release_interface(handle.get(), interface.number);
    handle.reset();
  }

  Result<void> ready() const {
    if (handle != nullptr) return {};
    return failure(error(ErrorCode::WrongState, "talk", "it is not open"));
  }

  LibusbConfig config;
  std::unique_ptr<libusb_context, ExitContext> context;
  Handle handle;
  UsbtmcInterface interface;
};

LibusbUsbtmcLink::LibusbUsbtmcLink(LibusbConfig config) : impl_(std::make_unique<Impl>(std::move(config))) {}
LibusbUsbtmcLink::~LibusbUsbtmcLink() {
  impl_->close();
}

Result<DetectorIdentity> LibusbUsbtmcLink::open() {
  impl_->close();
  return impl_->open();
}
void LibusbUsbtmcLink::close() {
  impl_->close();
}
bool LibusbUsbtmcLink::is_open() const {
  return impl_->handle != nullptr;
}
UsbtmcInterface LibusbUsbtmcLink::interface() const {
  return impl_->interface;
}

Result<void> LibusbUsbtmcLink::bulk_out(std::span<const std::uint8_t> bytes, Duration timeout) {
  GONIO_TRY(impl_->ready());
  std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());  // libusb takes no const
  const int size = static_cast<int>(copy.size());
  int done = 0;
  const int result = libusb_bulk_transfer(impl_->handle.get(), impl_->interface.bulk_out, copy.data(), size, &done,
                                          milliseconds(timeout));
  return impl_->outcome(result, done, size, fmt::format("send {} bytes", size), timeout);
}

Result<std::vector<std::uint8_t>> LibusbUsbtmcLink::bulk_in(std::size_t most, Duration timeout) {
  GONIO_TRY(impl_->ready());
  std::vector<std::uint8_t> bytes(most);
  int done = 0;
  const int result = libusb_bulk_transfer(impl_->handle.get(), impl_->interface.bulk_in, bytes.data(),
                                          static_cast<int>(most), &done, milliseconds(timeout));
  GONIO_TRY(impl_->outcome(result, done, 0, "receive", timeout));
  bytes.resize(static_cast<std::size_t>(done));
  return bytes;
}

Result<std::vector<std::uint8_t>> LibusbUsbtmcLink::interrupt_in(Duration timeout) {
  GONIO_TRY(impl_->ready());
  std::vector<std::uint8_t> bytes(kMostNotificationBytes);
  int done = 0;
  const int result = libusb_interrupt_transfer(impl_->handle.get(), impl_->interface.interrupt_in, bytes.data(),
                                               static_cast<int>(bytes.size()), &done, milliseconds(timeout));
  GONIO_TRY(impl_->outcome(result, done, 0, "receive a notification", timeout));
  bytes.resize(static_cast<std::size_t>(done));
  return bytes;
}

Result<std::vector<std::uint8_t>> LibusbUsbtmcLink::control_in(const usbtmc::ControlRequest& request,
                                                               Duration timeout) {
  GONIO_TRY(impl_->ready());
  std::vector<std::uint8_t> bytes(request.length);
  const auto number = static_cast<std::uint8_t>(request.request);
  const int result = libusb_control_transfer(impl_->handle.get(), request.request_type, number, request.value,
                                             request.index, bytes.data(), request.length, milliseconds(timeout));
  const int error = std::min(result, 0);
  GONIO_TRY(impl_->outcome(error, std::max(result, 0), 0, fmt::format("send control request {}", number), timeout));
  bytes.resize(static_cast<std::size_t>(result));
  return bytes;
}

Result<void> LibusbUsbtmcLink::clear_halt(std::uint8_t endpoint) {
  GONIO_TRY(impl_->ready());
  const int result = libusb_clear_halt(impl_->handle.get(), endpoint);
  return impl_->outcome(result, 0, 0, fmt::format("clear endpoint 0x{:02x}", endpoint), Duration::zero());
}

}  // namespace gonio::drivers
