#include "sandbox/viewer/live/render_client.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sandbox/viewer/state/parameter_json.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sandbox {

using nlohmann::json;

namespace {

glm::vec3 triple(const json& in) {
  return {in.at(0).get<float>(), in.at(1).get<float>(), in.at(2).get<float>()};
}

SceneEvent scene_event(const json& message) {
  SceneEvent event;
  event.generation = message.at("generation");
  event.loaded.scene = message.at("scene");
  for (const json& in : message.at("views")) {
    View view;
    view.name = in.at("name");
    view.eye = triple(in.at("eye"));
    view.target = triple(in.at("target"));
    view.up = triple(in.at("up"));
    view.fov_y_deg = in.at("fov_y_deg");
    view.near_m = in.at("near_m");
    view.far_m = in.at("far_m");
    event.loaded.views.push_back(std::move(view));
  }
  event.loaded.parameters = parameters_from_json(message.at("parameters"));
  return event;
}

Picture picture_of(const json& message, const SharedPixels& memory) {
  Picture picture;
  picture.generation = message.at("generation");
  picture.recipe = message.at("recipe");
  picture.state = from_recipe(picture.recipe, "the renderer's picture");
  picture.image = Image(message.at("width"), message.at("height"), message.at("channels"));
  std::size_t floats = picture.image.pixels.size();
  for (const json& map : message.value("maps", json::array())) {
    picture.maps.push_back({map.at("name"), map.at("unit"), map.at("doc"), Image(map.at("width"), map.at("height"), 1),
                            map.at("classes").get<std::vector<std::string>>()});
    floats += picture.maps.back().values.pixels.size();
  }
  if (picture.maps.empty()) {
    memory.copy_to(picture.image.pixels);
  } else {
    std::vector<float> all(floats);
    memory.copy_to(all);
    auto from = all.begin();
    const auto fill = [&](std::vector<float>& out) {
      std::copy_n(from, out.size(), out.begin());
      from += static_cast<std::ptrdiff_t>(out.size());
    };
    fill(picture.image.pixels);
    for (NativeMap& map : picture.maps)
      fill(map.values.pixels);
  }
  picture.frame_ms = message.value("frame_ms", 0.0);
  picture.prepare_s = message.value("prepare_s", 0.0);
  for (const json& pass : message.value("pass_ms", json::array()))
    picture.pass_ms.emplace_back(pass.at(0), pass.at(1));
  picture.clock = message.value("clock", "");
  picture.gpu_bytes = message.at("gpu_bytes");
  picture.native_errors = message.value("native_errors", json::object());
  picture.scene_hash = message.at("scene_hash");
  picture.device = message.at("device");
  picture.driver = message.at("driver");
  picture.quality = message.value("quality", "");
  picture.objects = message.value("objects", gl::LiveObjects{});
  picture.objects_left = message.value("objects_left", "");
  return picture;
}

}  // namespace

RenderClient::RenderClient(std::optional<int> device, std::function<void()> wake)
    : device_(device), wake_(std::move(wake)), bell_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (bell_ < 0) throw RuntimeError(fmt::format("no renderer can be started: {}", std::strerror(errno)));
  thread_ = std::thread([this] { work(); });
}

RenderClient::~RenderClient() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  ring();
  thread_.join();
  ::close(bell_);
}

void RenderClient::ring() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(bell_, &one, sizeof one);
}

void RenderClient::ask(RenderRequest request) {
  {
    const std::scoped_lock lock(mutex_);
    waiting_ = std::move(request);
    overtaken_ = true;
  }
  ring();
}

void RenderClient::reload_shaders() {
  {
    const std::scoped_lock lock(mutex_);
    reload_ = true;
  }
  ring();
}

void RenderClient::cancel() {
  const std::scoped_lock lock(mutex_);
  waiting_.reset();
  reload_ = false;
  cancelled_ = running_;
}

void RenderClient::renew() {
  const std::scoped_lock lock(mutex_);
  renew_ = true;
}

std::vector<RenderEvent> RenderClient::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(events_, {});
}

bool RenderClient::busy() const {
  const std::scoped_lock lock(mutex_);
  return running_ || waiting_ || reload_;
}

void RenderClient::put(RenderEvent event) {
  {
    const std::scoped_lock lock(mutex_);
    events_.push_back(std::move(event));
  }
  wake_();
}

// Sleeps until there is something to do. A renderer that ends meanwhile is told at once, not with the next request.
void RenderClient::rest() {
  for (;;) {
    {
      const std::scoped_lock lock(mutex_);
      if (stop_ || waiting_ || reload_) return;
    }
    std::array<pollfd, 2> files{pollfd{bell_, POLLIN, 0}, pollfd{process_ ? process_->output() : -1, POLLIN, 0}};
    ::poll(files.data(), files.size(), -1);
    if (files[0].revents != 0) {
      std::uint64_t rings = 0;
      [[maybe_unused]] const ssize_t taken = ::read(bell_, &rings, sizeof rings);
    }
    if (files[1].revents == 0) continue;
    const auto received = process_->receive(std::chrono::steady_clock::now(), [] { return true; });
    if (received.event == sweeps::WorkerProcess::Event::ended) end_process(served_);
  }
}

void RenderClient::work() {
  for (;;) {
    std::optional<RenderRequest> request;
    bool reload = false, renew = false;
    {
      const std::scoped_lock lock(mutex_);
      running_ = false;
      cancelled_ = false;
    }
    rest();
    {
      const std::scoped_lock lock(mutex_);
      if (stop_) break;
      reload = std::exchange(reload_, false);
      renew = std::exchange(renew_, false);
      request = std::exchange(waiting_, std::nullopt);
      overtaken_ = false;
      running_ = true;
    }
    if (renew) {
      process_.reset();
      pid_ = 0;
    }
    if (reload && process_ && process_->alive()) exchange(sweeps::to_line({{"type", "reload"}}), 0);
    if (reload && !process_) put(ShadersEvent{});
    if (request && !interrupted()) serve(*request);
  }
  process_.reset();
  pid_ = 0;
}

void RenderClient::serve(const RenderRequest& request) {
  json message{{"type", request.reference.empty() ? "render" : "reference"},
               {"generation", request.generation},
               {"recipe", to_recipe(request.state)},
               {"memory", memory_.path()},
               {"maps", request.maps},
               {"counts", request.counts},
               {"scene", request.scene}};
  served_ = request.generation;
  if (request.reference.empty()) {
    last_stage_ = true;
    exchange(sweeps::to_line(message), request.generation);
    return;
  }
  for (std::size_t i = 0; i < request.reference.size(); ++i) {
    message["samples"] = request.reference[i].samples;
    message["divide"] = request.reference[i].divide;
    last_stage_ = i + 1 == request.reference.size();
    if (!exchange(sweeps::to_line(message), request.generation) || overtaken_ || refused_) return;
  }
}

bool RenderClient::start(std::uint64_t generation) {
  std::vector<std::string> command{"/proc/self/exe", "view-renderer"};
  if (device_) command.push_back(fmt::format("--device={}", *device_));
  try {
    process_ = std::make_unique<sweeps::WorkerProcess>(command);
  } catch (const RuntimeError& e) {
    put(EndedEvent{generation, e.what()});
    return false;
  }
  pid_ = process_->pid();
  return true;
}

bool RenderClient::exchange(const std::string& line, std::uint64_t generation) {
  if ((!process_ || !process_->alive()) && !start(generation)) return false;
  answered_ = refused_ = false;
  bool open = process_->send(line);
  while (open && !answered_) {
    const auto received =
        process_->receive(std::chrono::steady_clock::time_point::max(), [&] { return !interrupted(); });
    if (received.event != sweeps::WorkerProcess::Event::line) {
      open = false;
      break;
    }
    try {
      hear(received.line);
    } catch (const std::exception& e) {
      put(EndedEvent{generation, fmt::format("the renderer talks nonsense: {}", e.what())});
      process_.reset();
      pid_ = 0;
      return false;
    }
  }
  if (open) return true;
  end_process(generation);
  return false;
}

void RenderClient::end_process(std::uint64_t generation) {
  const bool asked_to = interrupted();
  const std::string how = process_->end();
  const std::string words = process_->last_words();
  process_.reset();
  pid_ = 0;
  put(EndedEvent{generation,
                 asked_to ? "" : fmt::format("the renderer {}{}{}", how, words.empty() ? "" : ": ", words)});
}

void RenderClient::hear(const std::string& line) {
  const json message = json::parse(line);
  const std::string type = message.at("type");
  if (type == "phase") {
    put(PhaseEvent{message.at("generation"), message.at("words"), message.value("share", -1.0)});
  } else if (type == "scene") {
    put(scene_event(message));
  } else if (type == "picture") {
    auto picture = std::make_shared<Picture>(picture_of(message, memory_));
    picture->converged = last_stage_;
    put(PictureEvent{std::move(picture)});
    answered_ = true;
  } else if (type == "refused") {
    const bool failed = message.value("failed", false);
    put(RefusedEvent{message.at("generation"), message.at("reason"), failed});
    answered_ = refused_ = true;
    if (failed) {
      // Nothing is known of its context any more: the next request is drawn in another.
      process_.reset();
      pid_ = 0;
    }
  } else if (type == "told") {
    put(ToldEvent{message.at("words")});
  } else if (type == "shaders") {
    put(ShadersEvent{message.at("error")});
    answered_ = true;
  }
}

}  // namespace pellucid::sandbox
