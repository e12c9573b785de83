#include "tests/sweeps/fake_worker.hpp"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/worker.hpp"
#include "sweeps/workers/worker_protocol.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;

void say(const json& message) {
  std::cout << to_line(message) << std::endl;
}

/// Speaks the protocol without GL and does to each point what its parameter `does` asks for.
int fake_worker(const std::string& log, const std::string& device) {
  say({{"type", "hello"}, {"protocol", kProtocol}, {"device", device}, {"driver", "1.0"}, {"clock", "finish"}});
  for (std::string text; std::getline(std::cin, text);) {
    const json request = json::parse(text);
    const Point point = point_from_json(request.at("point"));
    const bool whole = request.at("type") == "measure";
    std::ofstream(log, std::ios::app) << (whole ? "measure " : "time ") << point.id << std::endl;
    const auto text_of = [&](const char* name) { return to_text(point.parameters.at(name)); };
    const std::string does = text_of("does");
    sleep_ms(std::stoi(text_of("sleep_ms")));
    if (does == "crash") {
      ::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would end it in another way
      ::raise(SIGSEGV);
    }
    if (does == "abort") {
      std::cerr << "first words\nassertion of the fake failed" << std::endl;
      ::raise(SIGABRT);
    }
    if (does == "leave") return 7;
    if (does == "stop") ::raise(SIGSTOP);
    if (does == "killed") ::raise(SIGKILL);
    while (does == "hang")
      sleep_ms(1000);
    if (does == "garbage") {
      std::cout << "Mesa: chatter on standard output\n" << std::flush;
      sleep_ms(2000);
    }
    if (does == "truncate") {
      std::cout << R"({"type": "done", "id": ")" << std::flush;
      return 0;
    }
    if (does == "fail") {
      say({{"type", "failed"}, {"id", point.id}, {"reason", "the scene has no volume"}});
      continue;
    }
    say({{"type", "progress"}, {"phase", "timing"}, {"share", 0.5}});
    const auto frames = static_cast<std::size_t>(std::stoi(text_of("frames")));
    const double n = std::stod(text_of("n"));  // a row of one point is not that of another
    json row{{"frame_ms_median", does == "nan" ? std::nan("") : 10.0},
             {"frames", frames},
             {"timing", does == "unconverged" ? "unconverged" : "converged"},
             {"timed_unix_s", 1000.0},
             {"rmse", 1 / (2 + n)},
             {"psnr", nullptr}};
    say({{"type", "done"}, {"id", point.id}, {"row", row}, {"frame_ms_samples", std::vector<double>(frames, 10 + n)}});
  }
  return 0;
}

/// A whole sweep in a process of its own, for tests that kill it.
int fake_sweep(const std::string& store, const std::string& log, int points, int sleep, int frames) {
  const FakeKnownNames known_names;
  const Spec spec = parse_spec(fake_spec(points, sleep, frames), "fake.toml", known_names);
  RunOptions options;
  options.worker = self({"fake-worker", log, "a device"});
  options.argv = {"fake-sweep"};
  options.quiet = true;
  try {
    const SweepSummary summary = run_sweep(spec, make_plan(spec, known_names), store, options);
    return summary.left == 0 ? 0 : 3;
  } catch (const std::exception& e) {
    std::cerr << e.what() << std::endl;
    return 1;
  }
}

}  // namespace

void sleep_ms(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

std::vector<std::string> self(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), std::filesystem::read_symlink("/proc/self/exe").string());
  return arguments;
}

std::string fake_spec(int points, int sleep, int frames) {
  return fmt::format(
      "name = 'fake'\nmetrics = ['rmse']\n[[run]]\nname = 'r'\ntechniques = ['faulty']\nscenes = ['ball']\nsizes = "
      "['8x8']\n"
      "[run.axes]\nn = {{ from = 1, to = {}, steps = {} }}\n[run.fixed]\nsleep_ms = {}\nframes = {}\n",
      points, points, sleep, frames);
}

int run_role(const std::vector<std::string>& arguments) {
  const std::string& role = arguments.at(0);
  if (role == "fake-worker") return fake_worker(arguments.at(1), arguments.at(2));
  if (role == "real-worker") return run_worker(std::nullopt);
  if (role == "dead-worker") {
    std::cerr << "error: no GL device" << std::endl;
    return std::stoi(arguments.at(1));
  }
  if (role == "chatty-worker") {
    std::cout << "hello" << std::endl;
    sleep_ms(5000);
    return 0;
  }
  if (role == "writer") return run_writer(arguments.at(1), std::stoi(arguments.at(2)));
  if (role == "full-disk-sweep") {
    // The nearest thing to a full disk that needs no disk: no file may grow beyond this.
    ::signal(SIGXFSZ, SIG_IGN);
    const struct rlimit limit { 400'000, 400'000 };
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  return fake_sweep(arguments.at(1), arguments.at(2), std::stoi(arguments.at(3)), std::stoi(arguments.at(4)),
                    std::stoi(arguments.at(5)));
}

}  // namespace pellucid::sweeps::test
