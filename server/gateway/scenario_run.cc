#include "server/gateway/scenario_run.h"

#include <poll.h>

#include <csignal>
#include <exception>
#include <utility>

#include "protocol/config/config.h"
#include "server/cycle/attempt.h"

namespace visum::gateway {
namespace {

using News = ScenarioRun::News;
using protocol::ScenarioVerdict;
using std::chrono::milliseconds;

constexpr milliseconds kLook{100};  // how soon a stop and the end of its time are noticed
constexpr milliseconds kRest{5};    // between two looks: a program that prints without end costs no more
constexpr int kBySignal = 128;      // plus the signal's number: the exit code that shells tell

// The exit codes of `visum run` (clients/visum/common/exit_code.h).
ScenarioVerdict verdict_of(int exit_code) {
  constexpr int kPassed = 0, kFailed = 1, kLost = 4;
  if (exit_code == kPassed) return ScenarioVerdict::kPassed;
  return exit_code == kFailed || exit_code == kLost ? ScenarioVerdict::kFailed : ScenarioVerdict::kInvalid;
}

std::uint64_t hash_of(const std::string& digits) {
  return digits.empty() ? 0 : std::stoull(digits, nullptr, 16);
}

// A line of `visum run --events`. Nothing: it tells nothing that clients hear of. Throws ConfigError or
// std::logic_error where it is no such line.
std::optional<News> news_of(const std::string& line) {
  const auto node = config::load_text(line, "visum run");
  const auto event = node.get("event").text();
  if (event == "line")
    return News{News::Kind::kLine, node.get("source").text() + ": " + node.get("text").text()};
  if (event == "check")
    return News{News::Kind::kCheck,
                {},
                {node.get("check").text(), node.get("passed").boolean(), node.get("text").text()}};
  if (event == "run")
    return News{News::Kind::kCheck,
                {},
                {"run " + node.get("run").text() + ": " + node.get("values").text(),
                 node.get("passed").boolean(), node.get("text").text()}};
  if (event == "end")
    return News{News::Kind::kEnd,
                node.get("text").text(),
                {},
                ScenarioVerdict::kUnspecified,
                0,
                hash_of(node.text_or("state_hash", {}))};
  return {};
}

}  // namespace

ScenarioRun::ScenarioRun(const std::filesystem::path& program, const std::filesystem::path& file,
                         std::chrono::nanoseconds timeout)
    : words_{program.string(), "run", file.string(), "--events", "--recordings", "off"},
      give_up_(Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout)),
      timeout_(timeout),
      thread_([this] { run(); }) {}

ScenarioRun::~ScenarioRun() {
  patience_.store(kShortFarewell);
  thread_.join();
}

std::uint64_t ScenarioRun::take(std::vector<News>& news) {
  const std::lock_guard lock(mutex_);
  news = std::exchange(news_, {});
  return std::exchange(dropped_, 0);
}

// The end always finds its place.
void ScenarioRun::add(News news) {
  const std::lock_guard lock(mutex_);
  const auto most = news.kind == News::Kind::kLine ? kMostLines : kMostNews;
  if (news_.size() >= most && news.kind != News::Kind::kEnd)
    ++dropped_;
  else
    news_.push_back(std::move(news));
}

void ScenarioRun::note(const std::string& line) {
  try {
    auto news = news_of(line);
    if (!news) return;
    if (news->kind == News::Kind::kEnd)
      ended_ = std::move(news);
    else
      add(std::move(*news));
  } catch (const config::ConfigError&) {  // cut, or of another version: the exit code still tells the verdict
  } catch (const std::logic_error&) {
  }
}

void ScenarioRun::end_if_due(const processes::ChildProcess& child) {
  const auto now = Clock::now();
  auto patience = patience_.load();
  if (now >= give_up_ && patience_.compare_exchange_strong(patience, kFarewell)) {
    too_late_ = true;
    patience = kFarewell;
  }
  if (patience == kNoEnd) return;
  if (!ends_since_) {
    ends_since_ = now;
    child.signal(SIGINT);
  }
  if (now >= *ends_since_ + patience) child.signal(SIGKILL);
}

News ScenarioRun::end_of(const processes::ChildProcess& child) const {
  News end = ended_.value_or(News{News::Kind::kEnd});
  const auto exit = *child.exit();
  end.exit_code = exit.by_signal ? kBySignal + exit.number : exit.number;
  end.verdict = verdict_of(end.exit_code);
  if (too_late_)
    end.text = "ended after " + std::to_string(std::chrono::ceil<std::chrono::seconds>(timeout_).count()) +
               " s, the time that it was given";
  else if (ends_since_)
    end.text = "stopped";
  else if (!ended_)
    end.text = "visum run " + child.exit()->text() + (complaint_.empty() ? "" : ": " + complaint_);
  return end;
}

void ScenarioRun::run() {
  News end{News::Kind::kEnd, {}, {}, ScenarioVerdict::kInvalid};
  const auto outcome = cycle::attempt(cycle::Refusal::kWrongState, [&] {
    processes::ChildProcess child(
        "visum run", words_, [this](const std::string& line) { note(line); },
        [this](const std::string& line) { complaint_ = line; });
    while (!child.check_exit()) {
      end_if_due(child);
      std::vector<pollfd> set;
      child.add_to(set);
      if (child.exit_fd() >= 0) set.push_back({child.exit_fd(), POLLIN, 0});
      ::poll(set.data(), set.size(), static_cast<int>(kLook.count()));
      child.drain();
      std::this_thread::sleep_for(kRest);
    }
    end = end_of(child);
  });
  if (!outcome.done()) end.text = outcome.text();
  add(std::move(end));
}

}  // namespace visum::gateway
