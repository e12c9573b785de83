#include "gl/timer.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>

#include <epoxy/gl.h>

#include "gl/context.hpp"
#include "gl/current_context.hpp"

namespace pellucid::gl {

namespace {

// Frames that nobody reads are dropped beyond this number, oldest first, so that a forgotten timer does not grow.
constexpr std::size_t kMostUnreadFrames = 256;

double milliseconds(std::uint64_t begin_ns, std::uint64_t end_ns) {
  return end_ns > begin_ns ? static_cast<double>(end_ns - begin_ns) * 1e-6 : 0.0;
}

// glFinish empties the pipeline; GL_TIMESTAMP then reads the device's clock, which is the one that did the work.
std::uint64_t finished_now_ns() {
  glFinish();
  GLint64 now = 0;
  glGetInteger64v(GL_TIMESTAMP, &now);
  return static_cast<std::uint64_t>(now);
}

void add_pass(FrameTime& frame, const std::string& name, double ms) {
  const auto it =
      std::find_if(frame.pass_ms.begin(), frame.pass_ms.end(), [&](const auto& p) { return p.first == name; });
  if (it != frame.pass_ms.end())
    it->second += ms;
  else
    frame.pass_ms.emplace_back(name, ms);
}

Clock truthful_clock() {
  if (software_renderer()) return Clock::finish;
  GLint bits = 0;
  glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
  return bits > 0 ? Clock::gpu_query : Clock::finish;
}

}  // namespace

const char* name(Clock clock) {
  return clock == Clock::gpu_query ? "gpu_query" : "finish";
}

struct PassTimer::State {
  // A moment is a query's name under `gpu_query` and nanoseconds under `finish`.
  using Moment = std::uint64_t;
  struct Span {
    std::string name;
    Moment begin = 0, end = 0;
  };
  struct Frame {
    Moment begin = 0, end = 0;
    std::vector<Span> passes;
  };

  explicit State(Clock which) : clock(which) {}
  ~State() {
    for (const Frame& frame : pending)
      recycle(frame);
    if (frame_open) recycle(open);
    if (detail::has_current() && !free_queries.empty())
      glDeleteQueries(static_cast<GLsizei>(free_queries.size()), free_queries.data());
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Moment mark() {
    if (clock == Clock::finish) return finished_now_ns();
    if (free_queries.empty()) {
      // The ring grows to the number of frames in flight instead of waiting for the oldest.
      free_queries.resize(16);
      glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(free_queries.size()), free_queries.data());
    }
    const GLuint query = free_queries.back();
    free_queries.pop_back();
    glQueryCounter(query, GL_TIMESTAMP);
    return query;
  }

  void recycle(const Frame& frame) {
    if (clock == Clock::finish) return;
    const auto give_back = [&](Moment query) {
      if (query != 0) free_queries.push_back(static_cast<GLuint>(query));
    };
    give_back(frame.begin);
    give_back(frame.end);
    for (const Span& span : frame.passes) {
      give_back(span.begin);
      give_back(span.end);
    }
  }

  bool known(const Frame& frame) const {
    if (clock == Clock::finish) return true;
    GLint available = GL_FALSE;  // timestamps are taken in order, so the frame's last one suffices
    glGetQueryObjectiv(static_cast<GLuint>(frame.end), GL_QUERY_RESULT_AVAILABLE, &available);
    return available != GL_FALSE;
  }

  std::uint64_t nanoseconds(Moment moment) const {
    if (clock == Clock::finish) return moment;
    GLuint64 value = 0;
    glGetQueryObjectui64v(static_cast<GLuint>(moment), GL_QUERY_RESULT, &value);
    return value;
  }

  FrameTime take_oldest() {
    const Frame frame = std::move(pending.front());
    pending.pop_front();
    FrameTime time;
    time.frame_ms = milliseconds(nanoseconds(frame.begin), nanoseconds(frame.end));
    for (const Span& span : frame.passes)
      add_pass(time, span.name, milliseconds(nanoseconds(span.begin), nanoseconds(span.end)));
    recycle(frame);
    check("read times", "timer");
    return time;
  }

  Clock clock;
  bool frame_open = false, pass_open = false;
  Frame open;
  std::deque<Frame> pending;
  std::vector<GLuint> free_queries;
};

PassTimer::PassTimer(Detail detail) : detail_(detail) {
  if (detail_ == Detail::off) return;
  clock_ = truthful_clock();
  state_ = new State(clock_);
}

PassTimer::PassTimer(Detail detail, Clock clock) : detail_(detail), clock_(clock) {
  if (detail_ != Detail::off) state_ = new State(clock_);
}

PassTimer::~PassTimer() {
  delete state_;
}

PassTimer::PassTimer(PassTimer&& other) noexcept
    : state_(std::exchange(other.state_, nullptr)),
      detail_(std::exchange(other.detail_, Detail::off)),
      clock_(std::exchange(other.clock_, Clock::finish)) {
  assert((state_ == nullptr || !state_->pass_open) && "an open pass points at the timer that began it");
}

PassTimer& PassTimer::operator=(PassTimer&& other) noexcept {
  if (this == &other) return *this;
  assert((state_ == nullptr || !state_->pass_open) && (other.state_ == nullptr || !other.state_->pass_open) &&
         "an open pass points at the timer that began it");
  delete state_;
  state_ = std::exchange(other.state_, nullptr);
  detail_ = std::exchange(other.detail_, Detail::off);
  clock_ = std::exchange(other.clock_, Clock::finish);
  return *this;
}

PassTimer::Pass::~Pass() {
  if (timer_ != nullptr) timer_->end_pass();
}

void PassTimer::begin_frame() {
  if (state_ == nullptr) return;
  // A frame that an exception cut short is dropped.
  if (state_->frame_open) state_->recycle(state_->open);
  state_->pass_open = false;
  if (state_->pending.size() >= kMostUnreadFrames) {
    state_->recycle(state_->pending.front());
    state_->pending.pop_front();
  }
  state_->open = {};
  state_->frame_open = true;
  state_->open.begin = state_->mark();
}

PassTimer::Pass PassTimer::pass(std::string_view name) {
  if (state_ == nullptr || detail_ != Detail::passes) return Pass(nullptr);
  assert(state_->frame_open && "a pass belongs to a frame");
  assert(!state_->pass_open && "passes do not nest");
  state_->pass_open = true;
  state_->open.passes.push_back({.name = std::string(name)});
  state_->open.passes.back().begin = state_->mark();
  return Pass(this);
}

void PassTimer::end_pass() {
  // A frame abandoned by an exception may end before its pass does.
  if (state_ == nullptr || !state_->pass_open) return;
  state_->pass_open = false;
  state_->open.passes.back().end = state_->mark();
}

void PassTimer::end_frame() {
  if (state_ == nullptr) return;
  assert(state_->frame_open && !state_->pass_open && "end_frame without begin_frame, or with a pass still open");
  state_->open.end = state_->mark();
  state_->frame_open = false;
  state_->pending.push_back(std::move(state_->open));
  state_->open = {};
  check("time a frame", "timer");
}

std::optional<FrameTime> PassTimer::poll() {
  if (state_ == nullptr || state_->pending.empty() || !state_->known(state_->pending.front())) return std::nullopt;
  return state_->take_oldest();
}

std::optional<FrameTime> PassTimer::wait() {
  if (state_ == nullptr || state_->pending.empty()) return std::nullopt;
  return state_->take_oldest();  // GL_QUERY_RESULT blocks until the result is there
}

}  // namespace pellucid::gl
