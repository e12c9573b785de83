#include "algorithms/key_maps/key_chain.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "algorithms/scene/files/cache_file.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "gl/error.hpp"

namespace pellucid::scattering {
namespace {

/// Raise it when what is computed or how it is written changes.
constexpr int kVersion = 2;
constexpr float kBrightest = 60000;  // in half precision

std::string key_of(const Environment& e, const KeyChainOptions& o) {
  Sha256 hash;
  hash.add(fmt::format("{} {} {} {}", kVersion, o.face_size, o.omega, static_cast<int>(o.filter)));
  if (e.image) {
    hash.add(fmt::format("{} {} {}", e.image->width, e.image->height, e.image->channels));
    hash.add(std::as_bytes(std::span(e.image->pixels)));
  } else {
    for (const glm::vec3& c : {e.zenith, e.horizon, e.ground})
      hash.add(fmt::format("{} {} {};", c.x, c.y, c.z));
  }
  return hash.hex();
}

}  // namespace

std::size_t KeyChain::bytes() const {
  std::size_t texels = 0;
  for (const auto& map : half_rgb)
    texels += map.size() / 3;
  return 8 * texels;
}

std::size_t KeyChain::full_resolution_bytes() const {
  return half_rgb.empty() ? 0 : 8 * 4 * (half_rgb.front().size() / 3) * half_rgb.size();
}

KeyChain key_chain(const Environment& environment, const KeyChainOptions& o, const std::filesystem::path& folder,
                   const std::function<void(double)>& progress) {
  if (o.face_size < kLeastFace || o.face_size > kMostFace || (o.face_size & (o.face_size - 1)) != 0)
    throw InputError(
        fmt::format("face_size = {} is no power of two from {} to {}", o.face_size, kLeastFace, kMostFace));
  if (!(o.omega > 0 && o.omega <= 0.5)) throw InputError(fmt::format("omega = {} is out of range (0, 0.5]", o.omega));
  KeyChain chain;
  CacheFile file;
  if (!folder.empty()) {
    const std::string key = key_of(environment, o);
    file = {folder / (key + ".keys"), "key maps", key};
    const auto unpack = [&](std::span<const std::byte> bytes) {
      ByteReader in(bytes);
      std::vector<double> widths;
      in.take(widths);
      if (widths.size() < 2 || widths.size() > 32) throw InputError("it has another number of widths");
      chain.widths = KeyWidths(std::move(widths));
      in.take(chain.scale);
      in.take(chain.mean);
      in.take(chain.filter_s);
      chain.half_rgb.assign(static_cast<std::size_t>(chain.widths.levels()), {});
      int size = o.face_size;
      for (auto& map : chain.half_rgb) {
        in.take(map);
        size = std::max(1, size / 2);
        if (map.size() != 18 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size))
          throw InputError("a map has another size");
      }
      if (!in.done()) throw InputError("it is longer than it says");
    };
    if (file.read(unpack)) return chain;
  }

  const auto start = std::chrono::steady_clock::now();
  chain.widths = KeyWidths(o.face_size, o.omega);
  const std::vector<KeyMap> maps = key_maps(environment, chain.widths, o.face_size, o.filter, progress);
  float brightest = 0;
  for (const KeyMap& map : maps)
    brightest = std::max(brightest, *std::max_element(map.rgb.begin(), map.rgb.end()));
  chain.scale = std::max(1.0F, brightest / kBrightest);
  chain.mean = {maps.back().rgb[0], maps.back().rgb[1], maps.back().rgb[2]};
  chain.half_rgb.clear();
  for (const KeyMap& map : maps) {
    std::vector<std::uint16_t>& half = chain.half_rgb.emplace_back();
    half.reserve(map.rgb.size());
    for (const float v : map.rgb)
      half.push_back(glm::packHalf1x16(v / chain.scale));
  }
  chain.filter_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!folder.empty()) {
    ByteWriter out;
    out.add(chain.widths.widths());
    out.add(chain.scale);
    out.add(chain.mean);
    out.add(chain.filter_s);
    for (const auto& map : chain.half_rgb)
      out.add(map);
    file.keep(out.bytes());
  }
  return chain;
}

}  // namespace pellucid::scattering
