#include "algorithms/reference/media/medium_path.hpp"

#include <cassert>

namespace pellucid {

TransferFunction::TransferFunction(const Volume& volume) {
  const auto scale = static_cast<double>(volume.extinction);
  const glm::dvec3 albedo(volume.albedo);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const std::vector<TransferPoint>& points = volume.transfer;
  if (points.empty()) {
    pieces_.push_back({kNone, 0.0, scale, albedo, glm::dvec3(0.0)});
    return;
  }
  const auto at = [&](const TransferPoint& point, double end) {
    return Piece{end, scale * static_cast<double>(point.extinction), 0.0, albedo * glm::dvec3(point.albedo),
                 glm::dvec3(0.0)};
  };
  pieces_.push_back(at(points.front(), static_cast<double>(points.front().density)));
  for (std::size_t i = 1; i < points.size(); ++i) {
    const TransferPoint &a = points[i - 1], &b = points[i];
    const double from = static_cast<double>(a.density), to = static_cast<double>(b.density);
    assert(to > from);
    Piece piece = at(a, to);
    piece.per_density = (scale * static_cast<double>(b.extinction) - piece.extinction) / (to - from);
    piece.albedo_slope = (albedo * glm::dvec3(b.albedo) - piece.albedo) / (to - from);
    piece.extinction -= piece.per_density * from;
    piece.albedo -= piece.albedo_slope * from;
    pieces_.push_back(piece);
  }
  pieces_.push_back(at(points.back(), kNone));
}

std::size_t TransferFunction::piece_of(double density) const {
  std::size_t piece = 0;
  while (piece + 1 < pieces_.size() && density >= pieces_[piece].end)
    ++piece;
  return piece;
}

void TransferFunction::find_crossings(const Cubic& density, std::vector<double>& crossings) const {
  double ends[4];
  const int count = monotone_parts(density, ends);
  for (int i = 0; i + 1 < count; ++i) {
    const double a = value(density, ends[i]), b = value(density, ends[i + 1]);
    const std::size_t before = crossings.size();
    for (std::size_t piece = piece_of(std::min(a, b)); piece + 1 < pieces_.size(); ++piece) {
      const double kink = pieces_[piece].end;
      if (!(kink > std::min(a, b))) continue;
      if (!(kink < std::max(a, b))) break;
      crossings.push_back(solve_monotone(density, kink, ends[i], ends[i + 1]));
    }
    if (b < a) std::reverse(crossings.begin() + static_cast<std::ptrdiff_t>(before), crossings.end());
  }
}

MediumGrid::MediumGrid(const Volume& volume)
    : size_(volume.size),
      to_local_(glm::inverse(glm::dmat4(volume.to_world))),
      row_(static_cast<std::size_t>(volume.size.x) + 2),
      slab_(row_ * (static_cast<std::size_t>(volume.size.y) + 2)),
      transfer_(volume),
      density_(pad(volume.density)) {
  if (volume.light >= 0) scattering_ = pad(volume.scattering);
}

std::vector<float> MediumGrid::pad(const std::vector<float>& voxels) const {
  const auto width = static_cast<std::size_t>(size_.x), height = static_cast<std::size_t>(size_.y);
  assert(voxels.size() == width * height * static_cast<std::size_t>(size_.z));
  std::vector<float> padded(slab_ * (static_cast<std::size_t>(size_.z) + 2));
  float* to = padded.data();
  for (int z = -1; z <= size_.z; ++z) {
    for (int y = -1; y <= size_.y; ++y) {
      const auto from_y = static_cast<std::size_t>(std::clamp(y, 0, size_.y - 1));
      const auto from_z = static_cast<std::size_t>(std::clamp(z, 0, size_.z - 1));
      const float* from = voxels.data() + (from_z * height + from_y) * width;
      *to++ = from[0];
      to = std::copy(from, from + width, to);
      *to++ = from[width - 1];
    }
  }
  return padded;
}

Interval MediumGrid::clip(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& limits) const {
  const glm::dvec3 o(to_local_ * glm::dvec4(origin, 1.0)), d(to_local_ * glm::dvec4(direction, 0.0));
  Interval inside = limits;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) {
      if (o[axis] < 0.0 || o[axis] > 1.0) return {0.0, 0.0};
      continue;
    }
    const double a = -o[axis] / d[axis], b = (1.0 - o[axis]) / d[axis];
    inside.begin = std::max(inside.begin, std::min(a, b));
    inside.end = std::min(inside.end, std::max(a, b));
  }
  return inside;
}

double MediumGrid::optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const {
  double depth = 0.0;
  trace(origin, direction, inside, [&](const CellSpan& span) { depth += span.depth(1.0); });
  return depth;
}

}  // namespace pellucid
