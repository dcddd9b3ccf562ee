// The adapter of umockdev: nothing else in this room knows it.
#include "sim/wires/usb_bus.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "sim/wires/file_descriptor.h"

namespace gonio::sim {
namespace {

constexpr std::size_t kSetupBytes = 8;
constexpr std::uint8_t kDirectionIn = 0x80;
constexpr int kOneSlotBytes = 4096;  // the smallest pipe: one page
constexpr int kFirstAddress = 2;     // 1 is the root hub
constexpr Duration kFaultLook = std::chrono::milliseconds(50);
constexpr Duration kNothingToDo = std::chrono::hours(1);
constexpr const char* kPreload = "libumockdev-preload.so.0";

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using Owned = std::unique_ptr<T, Unref>;
using Data = Owned<UMockdevIoctlData>;
using Client = Owned<UMockdevIoctlClient>;

template <class T>
Owned<T> another(T* object) {
  return Owned<T>(static_cast<T*>(g_object_ref(object)));
}

// A part of the client's memory, here. Null when the client has been killed meanwhile.
Data resolved(UMockdevIoctlData* from, std::size_t offset, std::size_t length) {
  return Data(umockdev_ioctl_data_resolve(from, offset, length, nullptr));
}

// A transfer that a client has submitted: its usbdevfs_urb and buffer, and what came of it.
struct Urb {
  Client owner;
  Data urb;
  Data buffer;  ///< null: it has none
  gulong address = 0;
  std::uint8_t type = 0;
  std::uint8_t endpoint = 0;
  std::size_t length = 0;
  int status = 0;
  std::size_t actual = 0;
  std::vector<std::uint8_t> bytes;
};

int status_of(UsbOutcome outcome) {
  return outcome == UsbOutcome::Stalled ? -EPIPE : 0;
}

gboolean complete(UMockdevIoctlClient* client, glong result, int error = 0) {
  umockdev_ioctl_client_complete(client, result, error);
  return TRUE;
}

// The node as a pipe of one slot, which libusb polls for "can be written to": full means that nothing is to be reaped.
class Node {
 public:
  Node() = default;
  explicit Node(std::string path) : path_(std::move(path)) {
    std::filesystem::create_directories(std::filesystem::path(path_).parent_path());
    if (::mkfifo(path_.c_str(), 0666) == 0)
      pipe_ = FileDescriptor(::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (pipe_.get() < 0 || ::fcntl(pipe_.get(), F_SETPIPE_SZ, kOneSlotBytes) < 0) return;
    is_sound_ = true;
    set_ready(false);
  }
  [[nodiscard]] bool is_sound() const { return is_sound_; }
  void set_ready(bool on) {
    if (!is_sound_ || on == is_ready_) return;
    char slot = 0;
    const ssize_t done = on ? ::read(pipe_.get(), &slot, 1) : ::write(pipe_.get(), &slot, 1);
    if (done == 1) is_ready_ = on;
  }
  void remove() { ::unlink(path_.c_str()); }

 private:
  std::string path_;
  FileDescriptor pipe_;
  bool is_sound_ = false;
  bool is_ready_ = true;
};

}  // namespace

// The emulated system that the ports share.
struct UsbBus::System {
  Owned<UMockdevTestbed> testbed{umockdev_testbed_new()};
  std::atomic<int> last_address{kFirstAddress - 1};

  [[nodiscard]] std::string root() const {
    gchar* root = umockdev_testbed_get_root_dir(testbed.get());
    std::string path = root;
    g_free(root);
    return path;
  }
};

struct UsbBus::Port {
  Port(System& the_system, LiveRadiometer& the_radiometer, std::size_t number)
      : system(the_system),
        radiometer(the_radiometer),
        device_path(fmt::format("/devices/pci0000:00/usb1/1-{}", number)),
        handler(umockdev_ioctl_base_new()) {
    g_signal_connect(handler.get(), "handle-ioctl", G_CALLBACK(&Port::on_ioctl), this);
    clockwork = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~Port() {
    clockwork.request_stop();
    clockwork.join();  // first: it may be putting the cable back
    unplug();
  }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  [[nodiscard]] std::string device_text() const;
  Result<void> plug();
  void unplug();
  [[nodiscard]] tl::unexpected<Error> failed(std::string seen) const;

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
    return static_cast<Port*>(self)->serve(client);
  }
  gboolean serve(UMockdevIoctlClient* client);
  gboolean serve_claim(UMockdevIoctlClient* client, UMockdevIoctlData* argument, bool is_claim);
  gboolean serve_capabilities(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  gboolean serve_clear_halt(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  gboolean submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  gboolean discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  gboolean reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument);

  void transfer(Urb urb);
  [[nodiscard]] UsbAnswer poll_in(const Urb& urb);
  void pump();
  void finish(Urb urb, int status);
  void forget_the_dead();
  void run(const std::stop_token& stop);
  void look_at_faults();
  [[nodiscard]] bool has_to_follow_faults();
  void follow_faults(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] Duration patience() const;

  System& system;
  LiveRadiometer& radiometer;
  std::string device_path;  ///< below /sys
  Owned<UMockdevIoctlBase> handler;
  std::mutex mutex;  ///< over all below; the instrument's is taken inside of it
  std::condition_variable_any something_due;
  std::optional<Instant> due;
  bool has_faults_to_follow = false;  ///< one is armed, or holds the cable out: look now and then
  bool looks_at_faults = true;        ///< at once
  bool is_pulled = false;             ///< by a fault
  int address = 0;
  std::string node_name;
  Node node;
  bool is_there = false;
  std::map<std::uint32_t, Client> claims;  ///< by interface
  std::list<Urb> waiting;
  std::list<Urb> finished;
  std::jthread clockwork;  // last: it uses all of the above
};

tl::unexpected<Error> UsbBus::Port::failed(std::string seen) const {
  return failure({.code = ErrorCode::Internal,
                  .device = "USB bus",
                  .tried = "plug the radiometer in",
                  .seen = std::move(seen),
                  .limit = {}});
}

// As `umockdev-record` writes devices, but for the node: from an "N:" line it would be a plain file, always ready, on
// which libusb spins.
std::string UsbBus::Port::device_text() const {
  std::string hex;
  for (const std::uint8_t byte : radiometer.with([](UsbtmcFunction&f, Instant) { return f.descriptors(); })) {
    hex += fmt::format("{:02X}", byte);
  }
  return fmt::format(
      "P: {4}\n"
      "E: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM={0:03}\n"
      "E: DEVNAME={1}\nE: MAJOR=189\nE: MINOR={2}\n"
      "A: busnum=1\\n\nA: devnum={0}\\n\nA: bConfigurationValue=1\\n\nA: speed=480\\n\nH: descriptors={3}\n",
      address, node_name, address - 1, hex, device_path);
}

Result<void> UsbBus::Port::plug() {
  {
    const std::lock_guard lock(mutex);
    if (is_there) {
      return failure(
          {.code = ErrorCode::WrongState, .device = "USB bus", .tried = "plug in", .seen = "it is", .limit = {}});
    }
    address = ++system.last_address;
    node_name = fmt::format("/dev/bus/usb/001/{:03}", address);
    node = Node(system.root() + node_name);
    if (!node.is_sound()) return failed(fmt::format("no pipe at {}: {}", node_name, std::strerror(errno)));
    radiometer.with([](UsbtmcFunction& function, Instant) { function.power_up(); });
    is_there = true;
  }
  // Handler and node come first: adding the device announces it.
  GError* error = nullptr;
  const std::string text = device_text();
  if (umockdev_testbed_attach_ioctl(system.testbed.get(), node_name.c_str(), handler.get(), &error) == FALSE ||
      umockdev_testbed_add_from_string(system.testbed.get(), text.c_str(), &error) == FALSE) {
    const std::string seen = error == nullptr ? "umockdev refused" : error->message;
    g_clear_error(&error);
    return failed(seen);
  }
  return {};
}

void UsbBus::Port::unplug() {
  {
    const std::lock_guard lock(mutex);
    if (!is_there) return;
    is_there = false;
    claims.clear();
    while (!waiting.empty()) {
      Urb urb = std::move(waiting.front());
      waiting.pop_front();
      finish(std::move(urb), -ESHUTDOWN);
    }
    node.remove();
  }
  const std::string sys_path = "/sys" + device_path;
  umockdev_testbed_uevent(system.testbed.get(), sys_path.c_str(), "remove");
  umockdev_testbed_remove_device(system.testbed.get(), sys_path.c_str());
  umockdev_testbed_detach_ioctl(system.testbed.get(), node_name.c_str(), nullptr);
}

gboolean UsbBus::Port::serve(UMockdevIoctlClient* client) {
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  const gulong request = umockdev_ioctl_client_get_request(client);
  const std::lock_guard lock(mutex);
  if (request == USBDEVFS_REAPURBNDELAY || request == USBDEVFS_REAPURB) return reap(client, argument);
  if (!is_there) return complete(client, -1, ENODEV);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      return serve_capabilities(client, argument);
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
      return serve_claim(client, argument, request == USBDEVFS_CLAIMINTERFACE);
    case USBDEVFS_CLEAR_HALT:
      return serve_clear_halt(client, argument);
    case USBDEVFS_SUBMITURB:
      return submit(client, argument);
    case USBDEVFS_DISCARDURB:
      return discard(client, argument);
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_RESET:
      return complete(client, 0);
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      return complete(client, -1, ENODATA);  // no driver of the kernel sits on it
    default:
      return complete(client, -1, ENOTTY);
  }
}

// The first request after each opening. With these libusb never cuts a transfer into pieces.
gboolean UsbBus::Port::serve_capabilities(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  forget_the_dead();
  constexpr std::uint32_t kCapabilities = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                          USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_BULK_CONTINUATION |
                                          USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
  const Data data = resolved(argument, 0, sizeof kCapabilities);
  if (data == nullptr) return complete(client, -1, EFAULT);
  std::memcpy(data->data, &kCapabilities, sizeof kCapabilities);
  return complete(client, 0);
}

gboolean UsbBus::Port::serve_claim(UMockdevIoctlClient* client, UMockdevIoctlData* argument, bool is_claim) {
  std::uint32_t number = 0;
  const Data data = resolved(argument, 0, sizeof number);
  if (data == nullptr) return complete(client, -1, EFAULT);
  std::memcpy(&number, data->data, sizeof number);
  const auto holder = claims.find(number);
  const bool is_ours = holder != claims.end() && holder->second.get() == client;
  if (is_claim && holder != claims.end() && !is_ours) return complete(client, -1, EBUSY);
  if (is_claim && !is_ours) claims.emplace(number, another(client));
  if (!is_claim && is_ours) claims.erase(holder);
  return complete(client, 0);
}

gboolean UsbBus::Port::serve_clear_halt(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  std::uint32_t endpoint = 0;
  const Data data = resolved(argument, 0, sizeof endpoint);
  if (data == nullptr) return complete(client, -1, EFAULT);
  std::memcpy(&endpoint, data->data, sizeof endpoint);
  radiometer.with([&](UsbtmcFunction& f, Instant) { f.clear_halt(static_cast<std::uint8_t>(endpoint)); });
  return complete(client, 0);
}

gboolean UsbBus::Port::submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  Urb urb{.owner = another(client), .urb = resolved(argument, 0, sizeof(usbdevfs_urb)), .buffer = {}, .bytes = {}};
  if (urb.urb == nullptr) return complete(client, -1, EFAULT);
  usbdevfs_urb asked;  // not initialised: its array of no elements cannot be
  std::memcpy(&asked, urb.urb->data, sizeof asked);
  urb.address = urb.urb->client_addr;
  urb.type = asked.type;
  urb.endpoint = asked.endpoint;
  urb.length = static_cast<std::size_t>(std::max(asked.buffer_length, 0));
  if (urb.length > 0) {
    urb.buffer = resolved(urb.urb.get(), offsetof(usbdevfs_urb, buffer), urb.length);
    if (urb.buffer == nullptr) return complete(client, -1, EFAULT);
  }
  transfer(std::move(urb));
  pump();
  return complete(client, 0);
}

// Control and OUT are done at once; IN waits until the device has something.
void UsbBus::Port::transfer(Urb urb) {
  const std::span<const std::uint8_t> given =
      urb.buffer == nullptr ? std::span<const std::uint8_t>() : std::span(urb.buffer->data, urb.length);
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    if (given.size() < kSetupBytes) return finish(std::move(urb), -EINVAL);
    auto answer =
        radiometer.with([&](UsbtmcFunction& f, Instant now) { return f.control(given.first<kSetupBytes>(), now); });
    urb.bytes = std::move(answer.bytes);
    urb.actual = urb.bytes.size();
    return finish(std::move(urb), status_of(answer.outcome));
  }
  if ((urb.endpoint & kDirectionIn) != 0) {
    waiting.push_back(std::move(urb));
    return;
  }
  const auto outcome = radiometer.with([&](UsbtmcFunction& f, Instant now) { return f.bulk_out(given, now); });
  urb.actual = outcome == UsbOutcome::Done ? urb.length : 0;
  finish(std::move(urb), status_of(outcome));
}

UsbAnswer UsbBus::Port::poll_in(const Urb& urb) {
  return radiometer.with([&](UsbtmcFunction& f, Instant now) {
    return urb.type == USBDEVFS_URB_TYPE_INTERRUPT ? f.interrupt_in() : f.bulk_in(urb.length, now);
  });
}

void UsbBus::Port::pump() {
  radiometer.with([](UsbtmcFunction& f, Instant now) { f.advance_to(now); });
  for (auto urb = waiting.begin(); urb != waiting.end();) {
    UsbAnswer answer = poll_in(*urb);
    if (answer.outcome == UsbOutcome::NotReady) {
      ++urb;
      continue;
    }
    const bool is_too_much = answer.bytes.size() > urb->length;
    urb->bytes = is_too_much ? std::vector<std::uint8_t>() : std::move(answer.bytes);
    urb->actual = urb->bytes.size();
    Urb done = std::move(*urb);
    urb = waiting.erase(urb);
    finish(std::move(done), is_too_much ? -EOVERFLOW : status_of(answer.outcome));
  }
  // What ended since the first line is due in the past, and comes with the next round.
  const auto next = radiometer.with([](const UsbtmcFunction& f, Instant) { return f.due(); });
  if (std::exchange(due, next) != next && next) something_due.notify_one();
  const bool is_out = radiometer.with([](const UsbtmcFunction& f, Instant now) { return f.is_unplugged(now); });
  if (is_out == is_pulled) return;
  looks_at_faults = true;
  something_due.notify_one();
}

void UsbBus::Port::finish(Urb urb, int status) {
  urb.status = status;
  finished.push_back(std::move(urb));
  node.set_ready(true);
}

gboolean UsbBus::Port::discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  gulong address_of_urb = 0;
  std::memcpy(&address_of_urb, argument->data, sizeof address_of_urb);
  const auto found = std::ranges::find_if(
      waiting, [&](const Urb& urb) { return urb.address == address_of_urb && urb.owner.get() == client; });
  if (found == waiting.end()) return complete(client, -1, EINVAL);  // already finished
  Urb urb = std::move(*found);
  waiting.erase(found);
  finish(std::move(urb), -ENOENT);
  return complete(client, 0);
}

gboolean UsbBus::Port::reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  const auto found = std::ranges::find_if(finished, [&](const Urb& urb) { return urb.owner.get() == client; });
  if (found == finished.end()) return complete(client, -1, is_there ? EAGAIN : ENODEV);
  const Urb urb = std::move(*found);
  finished.erase(found);
  if (finished.empty()) node.set_ready(false);
  const auto actual = static_cast<int>(urb.actual);
  std::memcpy(urb.urb->data + offsetof(usbdevfs_urb, status), &urb.status, sizeof urb.status);
  std::memcpy(urb.urb->data + offsetof(usbdevfs_urb, actual_length), &actual, sizeof actual);
  const std::size_t at = urb.type == USBDEVFS_URB_TYPE_CONTROL ? kSetupBytes : 0;
  if (!urb.bytes.empty() && at + urb.bytes.size() <= urb.length) {
    std::memcpy(urb.buffer->data + at, urb.bytes.data(), urb.bytes.size());
  }
  const Data pointer = resolved(argument, 0, sizeof(void*));
  if (pointer == nullptr) return complete(client, -1, EFAULT);
  // The client gets its own URB's address back; with it go the results in URB and buffer.
  umockdev_ioctl_data_set_ptr(pointer.get(), 0, urb.urb.get());
  return complete(client, 0);
}

// The kernel drops claims and URBs when a descriptor is closed. umockdev 0.17 says nothing then: look when another
// comes.
void UsbBus::Port::forget_the_dead() {
  const auto is_dead = [](const Client& client) { return umockdev_ioctl_client_get_connected(client.get()) == FALSE; };
  std::erase_if(claims, [&](const auto& claim) { return is_dead(claim.second); });
  for (auto* urbs : {&waiting, &finished}) urbs->remove_if([&](const Urb& urb) { return is_dead(urb.owner); });
  if (finished.empty()) node.set_ready(false);
}

void UsbBus::Port::look_at_faults() {
  const std::lock_guard lock(mutex);
  looks_at_faults = true;
  something_due.notify_one();
}

bool UsbBus::Port::has_to_follow_faults() {
  return radiometer.with_instrument([](const Instrument& instrument, Instant now) {
    const FaultCount count = instrument.faults().count(FaultKind::RadiometerUnplugged, now);
    return count.armed > 0 || count.is_active;
  });
}

// Pulls the cable or puts it back, as the faults have it. What cannot be put back is tried again with the next look.
void UsbBus::Port::follow_faults(std::unique_lock<std::mutex>& lock) {
  looks_at_faults = false;
  has_faults_to_follow = has_to_follow_faults() || is_pulled;
  const bool is_out = radiometer.with([](const UsbtmcFunction& f, Instant now) { return f.is_unplugged(now); });
  if (is_out == is_pulled || (is_out && !is_there)) return;
  lock.unlock();
  bool is_done = true;
  if (is_out) {
    unplug();
  } else {
    is_done = plug().has_value();
  }
  lock.lock();
  if (is_done) is_pulled = is_out;
}

Duration UsbBus::Port::patience() const {
  Duration most = has_faults_to_follow ? kFaultLook : kNothingToDo;
  if (due) most = std::min(most, *due - radiometer.clock().now());
  return most;
}

void UsbBus::Port::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    const std::optional<Instant> until = due;
    const bool is_woken =
        something_due.wait_for(lock, stop, patience(), [&] { return due != until || looks_at_faults; });
    if (!is_woken && due && due == until && radiometer.clock().now() >= *due) pump();
    if (looks_at_faults || has_faults_to_follow) follow_faults(lock);
  }
}

UsbBus::UsbBus(const std::vector<LiveRadiometer*>& radiometers) : system_(std::make_unique<System>()) {
  for (LiveRadiometer* radiometer : radiometers) {
    ports_.push_back(std::make_unique<Port>(*system_, *radiometer, ports_.size() + 1));
  }
}
UsbBus::~UsbBus() = default;

Result<void> UsbBus::plug(std::size_t port) {
  return ports_.at(port)->plug();
}
void UsbBus::unplug(std::size_t port) {
  ports_.at(port)->unplug();
}
void UsbBus::look_at_faults() {
  for (const auto& port : ports_) port->look_at_faults();
}

std::map<std::string, std::string> UsbBus::environment() const {
  return {{"LD_PRELOAD", kPreload}, {"UMOCKDEV_DIR", system_->root()}};
}

}  // namespace gonio::sim
