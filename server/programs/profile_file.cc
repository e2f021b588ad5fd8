#include "server/programs/profile_file.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "protocol/json_text.h"

namespace visum::programs {
namespace {

std::string as_json(const std::vector<config::Profile::Time>& times) {
  std::string list;
  for (const auto& time : times)
    list += (list.empty() ? "" : ",") + ("{\"name\":" + protocol::json_quoted(time.name)) +
            ",\"ns\":" + std::to_string(time.ns) + ",\"times\":" + std::to_string(time.times) + "}";
  return "[" + list + "]";
}

std::int64_t processor_time_us() {
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return (usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * std::int64_t{1'000'000} + usage.ru_utime.tv_usec +
         usage.ru_stime.tv_usec;
}

}  // namespace

void write_profile(const config::Profile& profile, const std::string& file) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  const auto process = static_cast<std::int64_t>(::getpid());
  // Without "ns", Chrome's trace viewer rounds to microseconds, and shows short spans within the one before.
  out << "{\"visum\":{\"ticks\":" << profile.ticks() << ",\"began_ns\":" << profile.began_ns()
      << ",\"first_tick_ns\":" << profile.first_tick_ns() << ",\"last_tick_ns\":" << profile.last_tick_ns()
      << ",\"cpu_us\":" << processor_time_us() << ",\"left_out\":" << profile.left_out()
      << ",\"run\":" << as_json(profile.run()) << ",\"whole\":" << as_json(profile.whole())
      << "},\"displayTimeUnit\":\"ns\",\"traceEvents\":[\n";
  const auto began = config::Profile::Clock::now();
  const auto began_us = processor_time_us();
  profile.write_spans(out, process);
  auto last = config::name_events(process, "visumd", "tick");
  last.resize(last.size() - 2);  // no comma behind the last one
  out << last << "\n]";
  out.flush();
  const auto took =
      std::chrono::duration_cast<std::chrono::nanoseconds>(config::Profile::Clock::now() - began).count();
  if (profile.keeps_spans())
    out << ",\"written\":{\"ns\":" << took << ",\"cpu_us\":" << processor_time_us() - began_us << "}";
  out << "}\n";
  if (!out.flush())
    throw std::runtime_error("--profile " + file + ": cannot be written: " + std::strerror(errno));
}

}  // namespace visum::programs
