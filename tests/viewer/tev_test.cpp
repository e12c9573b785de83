#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sandbox/viewer/out/tev_client.hpp"
#include "tests/sandbox/program.hpp"
#include "tests/viewer/window.hpp"

namespace pellucid::sandbox {
namespace {

/// Listens as tev does, and keeps all that one sender says.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) throw std::runtime_error("bind");
    socklen_t length = sizeof address;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length);
    ::listen(socket_, 1);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] {
      const int from = ::accept(socket_, nullptr, nullptr);
      std::array<std::uint8_t, 65536> buffer;
      for (ssize_t n = 0; (n = ::read(from, buffer.data(), buffer.size())) > 0;)
        bytes_.insert(bytes_.end(), buffer.begin(), buffer.begin() + n);
      ::close(from);
    });
  }
  ~Listener() { ::close(socket_); }
  const std::string& address() const { return address_; }
  std::vector<std::uint8_t> bytes() {
    thread_.join();
    return bytes_;
  }

 private:
  int socket_;
  std::string address_;
  std::thread thread_;
  std::vector<std::uint8_t> bytes_;
};

/// Reads a packet's fields one after another.
struct Reader {
  const std::vector<std::uint8_t>& bytes;
  std::size_t at = 0;
  template <class T>
  T take() {
    T value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
  }
  std::string text() {
    const std::string words(reinterpret_cast<const char*>(bytes.data() + at));
    at += words.size() + 1;
    return words;
  }
};

TEST(Tev, IsSentAnImageAndItsValues) {
  Image image(3, 2, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(i) * 0.5F;
  Listener listener;
  {
    TevClient client(listener.address());
    client.send("fog", image);
    client.send("fog", image);  // of the same size: values alone
  }
  const std::vector<std::uint8_t> bytes = listener.bytes();
  Reader read{bytes};
  const auto created = read.take<std::uint32_t>();
  EXPECT_EQ(read.take<std::uint8_t>(), 4);
  read.take<std::uint8_t>();
  EXPECT_EQ(read.text(), "fog");
  EXPECT_EQ(read.take<std::int32_t>(), 3);
  EXPECT_EQ(read.take<std::int32_t>(), 2);
  EXPECT_EQ(read.take<std::int32_t>(), 4);
  for (const char* channel : {"R", "G", "B", "A"})
    EXPECT_EQ(read.text(), channel);
  EXPECT_EQ(read.at, created);
  for (int times = 0; times < 2; ++times) {
    const std::size_t start = read.at;
    const auto length = read.take<std::uint32_t>();
    EXPECT_EQ(read.take<std::uint8_t>(), 6);
    read.take<std::uint8_t>();
    EXPECT_EQ(read.text(), "fog");
    EXPECT_EQ(read.take<std::int32_t>(), 4);
    for (int c = 0; c < 4; ++c)
      read.text();
    for (const int expected : {0, 0, 3, 2})
      EXPECT_EQ(read.take<std::int32_t>(), expected);
    for (std::int64_t c = 0; c < 4; ++c)
      EXPECT_EQ(read.take<std::int64_t>(), c);
    for (int c = 0; c < 4; ++c)
      EXPECT_EQ(read.take<std::int64_t>(), 4);
    for (const float value : image.pixels)
      EXPECT_EQ(read.take<float>(), value);
    EXPECT_EQ(read.at - start, length);
  }
  EXPECT_EQ(read.at, bytes.size());
}

TEST(Tev, IsNamedWhenNobodyListens) {
  EXPECT_THROW(TevClient("14158"), InputError);
  try {
    TevClient client("127.0.0.1:1");
    FAIL();
  } catch (const RuntimeError& e) {
    EXPECT_NE(std::string(e.what()).find("127.0.0.1:1"), std::string::npos);
  }
}

TEST(Tev, IsFedByRender) {
  test::TemporaryFolder folder;
  const std::string scene = test::write_small_scene(folder).string();
  Listener listener;
  const test::Outcome outcome = test::pellucid({"render", scene, "-t", "volume_slices", "--size", "32x24", "-o",
                                                (folder / "a.exr").string(), "--tev", listener.address()});
  ASSERT_TRUE(test::succeeded(outcome));
  const std::vector<std::uint8_t> bytes = listener.bytes();
  const Image image = read_image(folder / "a.exr").image;
  ASSERT_GT(bytes.size(), image.pixels.size() * sizeof(float));
  std::vector<float> sent(image.pixels.size());
  std::memcpy(sent.data(), bytes.data() + bytes.size() - sent.size() * sizeof(float), sent.size() * sizeof(float));
  EXPECT_EQ(sent, image.pixels);
}

// Each picture that the window shows, the last one that of the last state.
TEST(Tev, IsFedByTheWindow) {
  std::string why;
  if (test::XServer::get(why) == nullptr) GTEST_SKIP() << why;
  test::TemporaryFolder folder;
  const std::string scene = test::write_small_scene(folder).string();
  Listener listener;
  {
    test::ViewerWindow window(
        {scene, "-t", "volume_slices", "-s", "slices=9", "--size", "32x24", "--tev", listener.address()}, folder);
    window.wait_picture();
    window.tab_to("slices");
    window.key("Right");
    window.wait_picture([](const auto& recipe) { return test::ViewerWindow::value(recipe, "slices") == 10; });
    window.close();
  }
  const std::vector<std::uint8_t> bytes = listener.bytes();
  const std::size_t floats = std::size_t{32} * 24 * 4;
  Reader read{bytes};
  std::vector<int> kinds;
  while (read.at < bytes.size()) {
    const std::size_t start = read.at;
    const auto length = read.take<std::uint32_t>();
    ASSERT_GE(length, 5U);
    kinds.push_back(read.take<std::uint8_t>());
    read.take<std::uint8_t>();
    EXPECT_EQ(read.text(), "volume_slices of " + scene);
    read.at = start + length;
  }
  ASSERT_EQ(read.at, bytes.size());
  ASSERT_GE(kinds.size(), 3U);
  EXPECT_EQ(kinds.front(), 4) << "the image is created once";
  for (std::size_t i = 1; i < kinds.size(); ++i)
    EXPECT_EQ(kinds[i], 6);
  std::vector<float> sent(floats);
  std::memcpy(sent.data(), bytes.data() + bytes.size() - floats * sizeof(float), floats * sizeof(float));
  ASSERT_TRUE(test::succeeded(test::pellucid({"render", scene, "-t", "volume_slices", "-s", "slices=10", "--size",
                                              "32x24", "-o", (folder / "a.exr").string()})));
  EXPECT_EQ(sent, read_image(folder / "a.exr").image.pixels);
}

}  // namespace
}  // namespace pellucid::sandbox
