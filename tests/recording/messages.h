// The messages of a recording, as any MCAP tool sees them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/recording/mcap_reader.h"

namespace visum::recording {

struct MessageSeen {
  std::pair<std::uint64_t, std::uint64_t> times_ns;  // log_time, publish_time
  std::vector<std::byte> data;
};

inline std::vector<MessageSeen> messages_of(const std::filesystem::path& file, std::string_view topic) {
  std::ifstream in(file, std::ios::binary);
  McapReader reader(in);
  std::vector<MessageSeen> seen;
  for (auto item = reader.next(); !std::holds_alternative<McapReader::End>(item); item = reader.next())
    if (const auto* message = std::get_if<Message>(&item);
        message && reader.channel(message->channel).topic == topic)
      seen.push_back(
          {{message->log_time_ns, message->publish_time_ns}, {message->data.begin(), message->data.end()}});
  return seen;
}

}  // namespace visum::recording
