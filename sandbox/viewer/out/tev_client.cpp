#include "sandbox/viewer/out/tev_client.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sandbox {
namespace {

static_assert(std::endian::native == std::endian::little, "the packets are little-endian");

enum Kind : std::uint8_t { kCreateImage = 4, kUpdateImage = 6 };

class Packet {
 public:
  explicit Packet(Kind kind) {
    put(std::uint32_t{0});  // the length, known at the end
    put(static_cast<std::uint8_t>(kind));
  }
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void text(std::string_view words) {
    bytes_.insert(bytes_.end(), words.begin(), words.end());
    bytes_.push_back(0);
  }
  void floats(const std::vector<float>& values) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(values.data());
    bytes_.insert(bytes_.end(), from, from + values.size() * sizeof(float));
  }
  std::vector<std::uint8_t> finish() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

void put_channels(Packet& packet, const Image& image) {
  packet.put(static_cast<std::int32_t>(image.channels));
  constexpr const char* names[] = {"R", "G", "B", "A"};
  for (int c = 0; c < image.channels; ++c)
    packet.text(image.channels == 1 ? "Y" : names[c]);
}

}  // namespace

std::vector<std::uint8_t> tev_create_packet(std::string_view name, const Image& image) {
  Packet packet(kCreateImage);
  packet.put(std::uint8_t{1});  // comes to the front
  packet.text(name);
  packet.put(static_cast<std::int32_t>(image.width));
  packet.put(static_cast<std::int32_t>(image.height));
  put_channels(packet, image);
  return packet.finish();
}

std::vector<std::uint8_t> tev_update_packet(std::string_view name, const Image& image) {
  Packet packet(kUpdateImage);
  packet.put(std::uint8_t{0});
  packet.text(name);
  put_channels(packet, image);
  for (const int value : {0, 0, image.width, image.height})
    packet.put(static_cast<std::int32_t>(value));
  for (int c = 0; c < image.channels; ++c)
    packet.put(static_cast<std::int64_t>(c));
  for (int c = 0; c < image.channels; ++c)
    packet.put(static_cast<std::int64_t>(image.channels));
  packet.floats(image.pixels);
  return packet.finish();
}

TevClient::TevClient(const std::string& address) : address_(address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size())
    throw InputError(fmt::format("--tev {} is not HOST:PORT, for example 127.0.0.1:14158", address));
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const std::string host = address.substr(0, colon), port = address.substr(colon + 1);
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &wanted, &found); error != 0)
    throw InputError(fmt::format("--tev {}: {}", address, ::gai_strerror(error)));
  int reason = 0;
  for (const addrinfo* one = found; one != nullptr && socket_ < 0; one = one->ai_next) {
    socket_ = ::socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol);
    // A viewer that stopped reading must not hold us up for long.
    const timeval patience{5, 0};
    if (socket_ >= 0) ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (socket_ >= 0 && ::connect(socket_, one->ai_addr, one->ai_addrlen) != 0) {
      reason = errno;
      ::close(socket_);
      socket_ = -1;
    }
  }
  ::freeaddrinfo(found);
  if (socket_ < 0)
    throw RuntimeError(fmt::format("--tev {}: nobody answers there ({})", address, std::strerror(reason)));
}

TevClient::~TevClient() {
  ::close(socket_);
}

void TevClient::write(const std::vector<std::uint8_t>& packet) {
  for (std::size_t done = 0; done < packet.size();) {
    const ssize_t n = ::send(socket_, packet.data() + done, packet.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw RuntimeError(fmt::format("--tev {}: {}", address_, std::strerror(errno)));
    done += static_cast<std::size_t>(n);
  }
}

void TevClient::send(const std::string& name, const Image& image) {
  if (name != name_ || image.width != width_ || image.height != height_) write(tev_create_packet(name, image));
  name_ = name;
  width_ = image.width;
  height_ = image.height;
  write(tev_update_packet(name, image));
}

}  // namespace pellucid::sandbox
