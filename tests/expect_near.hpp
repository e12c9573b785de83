#pragma once

#include <glm/glm.hpp>
#include <gtest/gtest.h>

namespace pellucid::test {

/// Two points or colours are no further apart than `tolerance`.
inline void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-5) {
  EXPECT_LT(glm::length(a - b), tolerance)
      << a.x << ", " << a.y << ", " << a.z << " against " << b.x << ", " << b.y << ", " << b.z;
}

}  // namespace pellucid::test
