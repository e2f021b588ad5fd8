// Forged recordings: they say something else than what happened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string_view>
#include <vector>

#include "protocol/recording/mcap_reader.h"
#include "protocol/recording/mcap_writer.h"

namespace visum::recording {

// Copies a file: changes one message of a topic by `change`, keeps only the topics that `keeps` accepts, and
// makes all CRCs right.
inline void forge(
    const std::filesystem::path& from, const std::filesystem::path& to, std::string_view topic,
    std::uint32_t number, const std::function<void(std::vector<std::byte>&)>& change,
    const std::function<bool(std::string_view)>& keeps = [](std::string_view) { return true; }) {
  std::ifstream in(from, std::ios::binary);
  std::ofstream out(to, std::ios::binary);
  McapReader reader(in);
  McapWriter writer(
      [&](Bytes bytes) {
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      },
      "forger");
  std::map<std::uint16_t, std::uint16_t> channels;
  for (auto item = reader.next(); !std::holds_alternative<McapReader::End>(item); item = reader.next()) {
    if (const auto* attachment = std::get_if<Attachment>(&item)) writer.attach(*attachment);
    const auto* message = std::get_if<Message>(&item);
    if (!message) continue;
    const auto& channel = reader.channel(message->channel);
    if (!keeps(channel.topic)) continue;
    if (!channels.contains(channel.id))
      channels[channel.id] = writer.add_channel(channel.topic, 0, channel.encoding);
    std::vector<std::byte> data(message->data.begin(), message->data.end());
    if (channel.topic == topic && message->sequence == number) change(data);
    writer.write(channels[channel.id], message->log_time_ns, message->publish_time_ns, data);
  }
  writer.close();
}

}  // namespace visum::recording
