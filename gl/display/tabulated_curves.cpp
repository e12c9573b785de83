#include "gl/display/tabulated_curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace OCIO = OCIO_NAMESPACE;

namespace pellucid::gl {

namespace {

constexpr int kEntries = 8192;
// The curves act on log10 of light: 1e-5 there is 2.3e-5 of it, a hundredth of what 8 bits tell apart.
constexpr float kMost = 1e-5F;

/// Transforms [first, last) of a group are curves that act on each channel alone.
struct Run {
  int first = 0, last = 0;
};

bool is_plain_curve(const OCIO::ConstTransformRcPtr& transform) {
  const auto curve = OCIO::DynamicPtrCast<const OCIO::GradingRGBCurveTransform>(transform);
  // The other styles go from linear to log and back by themselves.
  return curve && curve->getStyle() == OCIO::GRADING_LOG && curve->getDirection() == OCIO::TRANSFORM_DIR_FORWARD &&
         !curve->isDynamic();
}

std::optional<Run> find_curves(const OCIO::GroupTransform& group) {
  const int count = group.getNumTransforms();
  for (int first = 0; first < count; ++first) {
    int last = first;
    while (last < count && is_plain_curve(group.getTransform(last)))
      ++last;
    if (last > first) return Run{first, last};
  }
  return std::nullopt;
}

OCIO::GroupTransformRcPtr part(const OCIO::GroupTransform& group, int first, int last) {
  const OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
  for (int i = first; i < last; ++i)
    out->appendTransform(group.getTransform(i)->createEditableCopy());
  return out;
}

struct Domain {
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
  float at(float share) const { return low + share * (high - low); }
};

/// From the first to the last control point of the run's first curves.
Domain domain_of(const OCIO::ConstTransformRcPtr& transform) {
  const auto values = OCIO::DynamicPtrCast<const OCIO::GradingRGBCurveTransform>(transform)->getValue();
  Domain domain;
  for (const auto which : {OCIO::RGB_RED, OCIO::RGB_GREEN, OCIO::RGB_BLUE, OCIO::RGB_MASTER}) {
    const OCIO::ConstGradingBSplineCurveRcPtr curve = values->getCurve(which);
    for (std::size_t i = 0; i < curve->getNumControlPoints(); ++i) {
      domain.low = std::min(domain.low, curve->getControlPoint(i).m_x);
      domain.high = std::max(domain.high, curve->getControlPoint(i).m_x);
    }
  }
  return domain;
}

using Color = std::array<float, 3>;

Color curved(const OCIO::ConstCPUProcessorRcPtr& curves, float x) {
  Color color{x, x, x};
  curves->applyRGB(color.data());
  return color;
}

float distance(const Color& a, const Color& b) {
  float most = 0;
  for (std::size_t c = 0; c < a.size(); ++c)
    most = std::max(most, std::abs(a[c] - b[c]));
  return most;
}

/// The curves at equal steps over the domain; nothing where a table would tell something else.
std::optional<std::vector<Color>> tabulate(const OCIO::ConstCPUProcessorRcPtr& curves, const Domain& domain) {
  if (!(domain.low < domain.high)) return std::nullopt;
  const auto entry = [&](float index) { return curved(curves, domain.at(index / (kEntries - 1))); };
  std::vector<Color> table;
  for (int i = 0; i < kEntries; ++i)
    table.push_back(entry(static_cast<float>(i)));
  for (int i = 0; i + 1 < kEntries; ++i) {
    const Color &a = table[static_cast<std::size_t>(i)], &b = table[static_cast<std::size_t>(i) + 1];
    const Color middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
    if (!(distance(middle, entry(static_cast<float>(i) + 0.5F)) <= kMost)) return std::nullopt;
  }
  // Beyond its ends a table stays as it is there.
  for (const float beyond : {1.0F, 40.0F}) {
    if (!(distance(table.front(), curved(curves, domain.low - beyond)) <= kMost)) return std::nullopt;
    if (!(distance(table.back(), curved(curves, domain.high + beyond)) <= kMost)) return std::nullopt;
  }
  return table;
}

}  // namespace

OCIO::ConstProcessorRcPtr with_tabulated_curves(const OCIO::ConstConfigRcPtr& config,
                                                const OCIO::ConstProcessorRcPtr& processor) {
  const OCIO::GroupTransformRcPtr all = processor->createGroupTransform();
  const std::optional<Run> run = find_curves(*all);
  if (!run) return processor;
  const Domain domain = domain_of(all->getTransform(run->first));
  const OCIO::ConstCPUProcessorRcPtr curves =
      config->getProcessor(part(*all, run->first, run->last))->getOptimizedCPUProcessor(OCIO::OPTIMIZATION_NONE);
  const std::optional<std::vector<Color>> table = tabulate(curves, domain);
  if (!table) return processor;

  const OCIO::MatrixTransformRcPtr to_share = OCIO::MatrixTransform::Create();
  const double scale = 1 / (static_cast<double>(domain.high) - static_cast<double>(domain.low));
  const double offset = -static_cast<double>(domain.low) * scale;
  const std::array<double, 16> matrix{scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, 1};
  const std::array<double, 4> offsets{offset, offset, offset, 0};
  to_share->setMatrix(matrix.data());
  to_share->setOffset(offsets.data());
  const OCIO::Lut1DTransformRcPtr lut = OCIO::Lut1DTransform::Create(kEntries, false);
  lut->setInterpolation(OCIO::INTERP_LINEAR);
  lut->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
  for (std::size_t i = 0; i < table->size(); ++i)
    lut->setValue(i, (*table)[i][0], (*table)[i][1], (*table)[i][2]);

  const OCIO::GroupTransformRcPtr out = part(*all, 0, run->first);
  out->appendTransform(to_share);
  out->appendTransform(lut);
  for (int i = run->last; i < all->getNumTransforms(); ++i)
    out->appendTransform(all->getTransform(i)->createEditableCopy());
  return config->getProcessor(out);
}

}  // namespace pellucid::gl
