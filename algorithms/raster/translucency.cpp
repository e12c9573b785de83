#include "algorithms/raster/translucency.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "algorithms/key_maps/key_atlas.hpp"
#include "algorithms/progress.hpp"
#include "algorithms/raster/transfer_cache.hpp"
#include "algorithms/scene/files/cache_file.hpp"

namespace pellucid {
namespace {

using namespace scattering;

bool grey(const Material& m) {
  const auto same = [](const glm::vec3& v) { return v.x == v.y && v.y == v.z; };
  return same(m.scattering) && same(m.absorption);
}

bool same_gradient(const Environment& a, const Environment& b) {
  return a.zenith == b.zenith && a.horizon == b.horizon && a.ground == b.ground;
}

glm::vec3 albedo_of(const Material& m) {
  const glm::vec3 extinction = m.scattering + m.absorption;
  glm::vec3 albedo(0.0F);
  for (int c = 0; c < 3; ++c)
    albedo[c] = extinction[c] > 0 ? m.scattering[c] / extinction[c] : 0;
  return albedo;
}

constexpr int kTables = 8;  // media that are kept, as a slider passes them

}  // namespace

bool scatters(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.scatters(); });
}

std::optional<TranslucencySettings> translucency_settings(Transfer transfer, const KeyChainOptions& chain,
                                                          float widening) {
  if (transfer == Transfer::none) return std::nullopt;
  return TranslucencySettings{static_cast<TransferModel>(static_cast<int>(transfer) - 1), chain,
                              static_cast<double>(widening)};
}

void Translucency::prepare(const Scene& scene, const TranslucencySettings& settings) {
  settings_ = settings;
  chain_ = {};
  tables_.clear();
  if (scatters(scene)) refresh(scene);
}

gl::Defines Translucency::defines(const Scene& scene, TransferModel model) {
  if (!scatters(scene)) return {};
  gl::Defines defines;
  defines.emplace_back("SCATTERING", "1");
  if (std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& m) { return m.scatters() && !grey(m); }))
    defines.emplace_back("COLOURED_MEDIUM", "1");
  if (model == TransferModel::unscattered) defines.emplace_back("UNSCATTERED_APART", "1");
  if (model == TransferModel::two_gaussians) defines.emplace_back("TWO_GAUSSIANS", "1");
  return defines;
}

// A gradient's colours may change without a call of prepare(), and a material may begin to scatter.
void Translucency::refresh(const Scene& scene) {
  const Environment& environment = scene.environment;
  if (chain_ && (environment.image || same_gradient(environment, filtered_))) return;
  KeyChainOptions options = settings_.chain;
  if (!environment.image) options.face_size = kLeastFace;  // a gradient has no details
  const KeyChain chain = key_chain(environment, options, environment.image ? cache_folder("key_maps") : "",
                                   [](double share) { tell_progress("filtering the environment", share); });
  const KeyAtlas atlas = key_atlas(chain);
  chain_ = gl::Texture::make_2d("key maps", gl::Format::rgba16f, atlas.width, atlas.height);
  chain_.upload_halves(atlas.half_rgba);
  chain_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  map_size_ = atlas.map_size;
  face_rows_ = atlas.face_rows;
  widths_ = chain.widths;
  chain_scale_ = chain.scale;
  mean_ = chain.mean;
  full_bytes_ = chain.full_resolution_bytes();
  filter_s_ = chain.filter_s;
  filtered_ = environment;
  filtered_.image.reset();
  tables_.clear();  // they hold levels of the chain
}

const gl::Texture& Translucency::table_of(const Material& material) {
  const glm::vec3 albedo = albedo_of(material);
  const MediumKey key(material.anisotropy, albedo.x, albedo.y, albedo.z);
  if (const auto found = tables_.find(key); found != tables_.end()) return found->second;
  if (tables_.size() >= kTables) tables_.clear();
  constexpr int kEntries = TransferTable::kEntries, kRows = 6;
  std::vector<float> texels(static_cast<std::size_t>(4 * kEntries * kRows));
  for (int c = 0; c < 3; ++c) {
    const bool repeated = c > 0 && albedo[c] == albedo[0];
    if (repeated) {
      for (const int row : {0, 3}) {
        const auto from = texels.begin() + 4 * kEntries * row;
        std::copy(from, from + 4 * kEntries, texels.begin() + 4 * kEntries * (row + c));
      }
      continue;
    }
    const TransferTable table =
        transfer_table({static_cast<double>(material.anisotropy), static_cast<double>(albedo[c])}, settings_.model,
                       cache_folder("transfer_functions"));
    for (int i = 0; i < kEntries; ++i) {
      const TransferFit& fit = table.entries[static_cast<std::size_t>(i)];
      const double one[] = {widths_.level(settings_.widening * fit.theta_bar), fit.f_t, fit.c_t, fit.c_r};
      const double two[] = {widths_.level(settings_.widening * fit.theta_2), fit.f_2, 0, 0};
      for (int k = 0; k < 4; ++k) {
        texels[static_cast<std::size_t>(4 * (kEntries * c + i) + k)] = static_cast<float>(one[k]);
        texels[static_cast<std::size_t>(4 * (kEntries * (c + 3) + i) + k)] = static_cast<float>(two[k]);
      }
    }
  }
  gl::Texture texture = gl::Texture::make_2d("transfer functions", gl::Format::rgba32f, kEntries, kRows);
  texture.upload(texels);
  texture.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return tables_.emplace(key, std::move(texture)).first->second;
}

void Translucency::bind(const gl::Program& program, const Scene& scene, const Material& material) {
  if (!scatters(scene)) return;
  refresh(scene);
  chain_.bind(11);
  table_of(material).bind(12);
  program.set("extinction", material.scattering + material.absorption);
  program.set("key_map_size", map_size_);
  program.set("key_face_rows", face_rows_);
  program.set("key_scale", chain_scale_ * scene.environment.scale);
  program.set("mean_radiance", mean_ * scene.environment.scale);
}

std::size_t Translucency::bytes() const {
  return chain_ ? chain_.bytes() : 0;
}

}  // namespace pellucid
