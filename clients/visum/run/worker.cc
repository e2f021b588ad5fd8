#include "clients/visum/run/worker.h"

#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "clients/visum/common/json_writer.h"

namespace visum::run {

std::string as_line(const WorkerTask& task) {
  cli::JsonWriter json;
  json.begin_object().member("run", task.run).member("values", task.values);
  json.member("result", task.result.string()).member("recording", task.recording.string());
  return json.end_object().text();
}

WorkerTask read_task(const std::string& line) {
  const auto task = config::load_text(line, "a worker's task");
  return {static_cast<std::size_t>(task.get("run").integer(0)), task.get("values").text(),
          task.get("result").text(), task.get("recording").text()};
}

Worker::Worker(const std::vector<std::string>& command) {
  const processes::PipeEnds in = processes::make_pipe(command[0]);
  try {
    const auto note = [this](const std::string& line) { done_ = done_ || line == "done"; };
    process_.emplace("worker", command, note, processes::ChildProcess::OnLine{}, in.read);
  } catch (const std::runtime_error&) {
    ::close(in.read);
    ::close(in.write);
    throw;
  }
  ::close(in.read);
  in_fd_ = in.write;
}

Worker::~Worker() {
  give_no_more();
}

void Worker::give(const WorkerTask& task) {
  done_ = false;
  ++tasks_given_;
  process_->forget_lines();
  const std::string line = as_line(task) + "\n";
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t wrote = ::write(in_fd_, line.data() + sent, line.size() - sent);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return;
    sent += static_cast<std::size_t>(wrote);
  }
}

void Worker::give_no_more() {
  if (in_fd_ >= 0) ::close(std::exchange(in_fd_, -1));
}

}  // namespace visum::run
