#include "protocol/recording/recording_file.h"

#include <stdexcept>

#include "protocol/config/config.h"

namespace visum::recording {
namespace {

std::ifstream open(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file)) throw std::runtime_error("cannot be opened");
  return in;
}

// "/parts/arm/description" is the description of the part "arm". But "/parts/description" holds the samples
// of a part that is itself called "description".
bool is_of_description(std::string_view topic) {
  const auto name = topic.substr(kPartTopic.size());
  return name.size() > kDescriptionTopic.size() && name.ends_with(kDescriptionTopic);
}

}  // namespace

RecordingFile::RecordingFile(const std::filesystem::path& file) try : in_(open(file)), reader_(in_) {
  for (auto item = reader_.next();; item = reader_.next()) {
    if (const auto* attachment = std::get_if<Attachment>(&item)) {
      files_[attachment->name].assign(reinterpret_cast<const char*>(attachment->data.data()),
                                      attachment->data.size());
      continue;
    }
    const auto* message = std::get_if<Message>(&item);
    if (!message) throw std::runtime_error("it has no header: " + reader_.damage());
    if (reader_.channel(message->channel).topic != kHeaderTopic || !decode(message->data, header_))
      throw std::runtime_error("this is no recording of visumd");
    break;
  }
  if (header_.format != kFormat)
    throw std::runtime_error("its format is " + std::to_string(header_.format) + ", this program reads " +
                             std::to_string(kFormat));
  check_files();
} catch (const std::runtime_error& error) {
  throw config::ConfigError({file.string()}, error.what());
}

void RecordingFile::check_files() const {
  for (const auto& entry : header_.files) {
    const auto file = files_.find(entry.name);
    if (file == files_.end()) throw std::runtime_error("it lacks the file '" + entry.name + "'");
    if (file->second.size() != entry.size || crc32(bytes_of(file->second)) != entry.crc)
      throw std::runtime_error("the file '" + entry.name + "' in it is not the one that was recorded");
  }
}

RecordingFile::Item RecordingFile::next() {
  while (damage_.empty()) {
    last_ = reader_.place();
    const auto item = reader_.next();
    const auto* message = std::get_if<Message>(&item);
    if (std::holds_alternative<McapReader::End>(item)) break;
    if (!message) continue;
    if (const auto taken = take(*message); !std::holds_alternative<End>(taken)) return taken;
  }
  return End{};
}

RecordingFile::Place RecordingFile::place_of_last() const {
  Place place{last_, sequences_};
  if (const auto last = place.sequences.find(last_channel_); last != place.sequences.end()) --last->second;
  return place;
}

void RecordingFile::go_to(const Place& place) {
  damage_.clear();
  sequences_ = place.sequences;
  reader_.go_to(place.place);
}

bool RecordingFile::in_sequence(const Message& message) {
  last_channel_ = message.channel;
  return sequences_[message.channel]++ == message.sequence;
}

template <typename Kind>
RecordingFile::Item RecordingFile::take_as(Kind& kind, const Message& message) {
  bool right = false;
  if constexpr (requires { kind.decode(message.data); })
    right = kind.decode(message.data);
  else
    right = decode(message.data, kind);
  if (!right) {
    damage_ = "channel " + reader_.channel(message.channel).topic + ": message " +
              std::to_string(message.sequence) + " cannot be decoded";
    return End{};
  }
  if constexpr (std::is_same_v<Kind, InputMessage>)
    return &kind.input;
  else if constexpr (std::is_same_v<Kind, TickMessage>)
    return &kind.tick;
  else
    return &kind;
}

RecordingFile::Item RecordingFile::take(const Message& message) {
  const auto& topic = reader_.channel(message.channel).topic;
  if (topic == kHeaderTopic) return End{};
  // No bit of the world depends on the log: one that is damaged ends nothing
  if (topic == kLogTopic) return log_.decode(message.data) ? Item{&log_.line} : Item{End{}};
  if (!in_sequence(message)) {
    damage_ =
        "channel " + topic + ": messages before number " + std::to_string(message.sequence) + " are missing";
    return End{};
  }
  if (topic == kInputTopic) return take_as(input_, message);
  if (topic == kStateTopic) return take_as(state_, message);
  if (topic == kTickTopic) return take_as(tick_, message);
  if (topic == kSpawnedTopic) return take_as(sample_, message);
  if (topic == kSpawnedDescriptionTopic) return take_as(description_, message);
  if (!topic.starts_with(kPartTopic)) return End{};
  if (is_of_description(topic)) return take_as(description_, message);
  return take_as(sample_, message);
}

}  // namespace visum::recording
