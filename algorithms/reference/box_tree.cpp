#include "algorithms/reference/box_tree.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace pellucid {
namespace {

constexpr std::size_t kLeafItems = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) : order_(boxes.size()) {
  assert(boxes.size() < std::numeric_limits<std::uint32_t>::max() / 2);
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(boxes.size());
  if (!boxes.empty()) build(boxes, 0, boxes.size());
}

// Halves the items at the median along the longest side of their centres' box.
void BoxTree::build(const std::vector<Box>& boxes, std::size_t begin, std::size_t end) {
  const std::size_t index = nodes_.size();
  Box box, centres;
  for (std::size_t i = begin; i < end; ++i) {
    const Box& item = boxes[order_[i]];
    box.add(item);
    centres.add(0.5F * (item.low + item.high));
  }
  nodes_.push_back({box, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
  if (end - begin <= kLeafItems) return;

  const glm::vec3 side = centres.high - centres.low;
  const int axis = side.x > side.y ? (side.x > side.z ? 0 : 2) : (side.y > side.z ? 1 : 2);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    return boxes[a].low[axis] + boxes[a].high[axis] < boxes[b].low[axis] + boxes[b].high[axis];
  });
  build(boxes, begin, middle);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index].count = 0;
  build(boxes, middle, end);
}

}  // namespace pellucid
