#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "gl/program.hpp"

namespace pellucid::test {

/// The outputs of a compute shader for each input: it reads them from buffer 0 and writes as many outputs to buffer 1,
/// with 64 invocations a group. Both types lie in std430 as in C++. `program` has its uniforms, textures are bound.
template <class Output, class Input>
std::vector<Output> compute(const gl::Program& program, const std::vector<Input>& inputs) {
  const gl::Buffer in("inputs", std::span<const Input>(inputs));
  const gl::Buffer out("outputs", inputs.size() * sizeof(Output));
  in.bind_storage(0);
  out.bind_storage(1);
  program.use();
  glDispatchCompute(static_cast<GLuint>((inputs.size() + 63) / 64), 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  std::vector<Output> outputs(inputs.size());
  const auto bytes = out.read();
  std::memcpy(outputs.data(), bytes.data(), bytes.size());
  return outputs;
}

}  // namespace pellucid::test
