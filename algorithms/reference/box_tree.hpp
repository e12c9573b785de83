#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

/// A bounding-volume hierarchy over boxes, to be asked with any convex region. Embree answers rays and points only.
namespace pellucid {

struct Box {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& point) { low = glm::min(low, point), high = glm::max(high, point); }
  void add(const Box& box) { low = glm::min(low, box.low), high = glm::max(high, box.high); }
};

class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Box>& boxes);

  /// The index in `boxes` of each item, in the order that visit() sees: neighbours in space are neighbours there.
  const std::vector<std::uint32_t>& order() const { return order_; }
  Box bounds() const { return nodes_.empty() ? Box{} : nodes_.front().box; }

  /// Calls visit(first, last) with ranges of order() for the leaves all of whose ancestors' boxes `touches(box)`.
  template <class Touches, class Visit>
  void traverse(Touches touches, Visit visit) const;

 private:
  struct Node {
    Box box;
    std::uint32_t first = 0;  // of a leaf: its items; else the right child, the left one being next
    std::uint32_t count = 0;  // 0: not a leaf
  };
  void build(const std::vector<Box>& boxes, std::size_t begin, std::size_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class Touches, class Visit>
void BoxTree::traverse(Touches touches, Visit visit) const {
  if (nodes_.empty()) return;
  // Halving 2³² items ends after 32 levels.
  std::array<std::uint32_t, 64> waiting;
  std::size_t depth = 0;
  waiting[depth++] = 0;
  while (depth > 0) {
    std::uint32_t index = waiting[--depth];
    while (touches(nodes_[index].box)) {
      const Node& node = nodes_[index];
      if (node.count > 0) {
        visit(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.first) + node.count);
        break;
      }
      waiting[depth++] = node.first;
      ++index;
    }
  }
}

}  // namespace pellucid
