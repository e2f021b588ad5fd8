#include "server/recording/export_csv.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "protocol/recording/recording_file.h"

namespace visum::recording {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

// As few digits as are needed to read the same bits again.
template <typename... Format>
std::string exact(double number, Format... format) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number, format...).ptr};
}

// Divides by 1e9: multiplying by 1e-9 can miss the double that a user's "0.003" means.
double time_s_of(const Tick& tick) {
  return static_cast<double>(tick.sim_time_ns) / 1e9;
}

constexpr std::size_t kMostColumns = 100'000;

const std::vector<protocol::Port>& ports_of(const protocol::PartDescription& part, bool inputs) {
  return inputs ? part.controller_inputs : part.sensor_outputs;
}

// A part of the recording. Parts that were spawned may come, go, and come again with other ports.
struct Source {
  std::string part;
  std::size_t inputs = 0, outputs = 0;  // ports, as it was described last
  protocol::PartSample sample;          // the newest
  std::vector<std::size_t> columns;     // its own
};

struct Column {
  std::size_t source;
  bool is_input;
  std::string port;
  std::optional<std::size_t> index{};  // among the part's ports, as it was described last
};

// Reads the recording twice: once for the ports that it has at any time, and once for the rows.
class Exporter {
 public:
  Exporter(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out)
      : file_(file), options_(options), out_(out), found_(options.ports.size()) {}

  CsvResult run() {
    const auto begin = file_.place();
    for_each_item([this](const auto& part) { add_columns(part); }, [](const auto&) {}, [](const auto&) {});
    put_head();
    file_.go_to(begin);
    for_each_item([this](const auto& part) { follow(part); }, [this](const auto& sample) { keep(sample); },
                  [this](const auto& tick) {
                    if (is_wanted(tick)) put_row(tick);
                  });
    result_.damage = file_.damage();
    return std::move(result_);
  }

 private:
  void for_each_item(const auto& on_part, const auto& on_sample, const auto& on_tick) {
    for (auto item = file_.next(); !std::holds_alternative<RecordingFile::End>(item); item = file_.next()) {
      if (const auto* part = std::get_if<const protocol::PartDescription*>(&item)) on_part(**part);
      if (const auto* sample = std::get_if<const protocol::PartSample*>(&item)) on_sample(**sample);
      if (const auto* tick = std::get_if<const Tick*>(&item)) on_tick(**tick);
    }
  }

  // Null: no such part has been described.
  Source* find(const std::string& part) {
    const auto found = numbers_.find(part);
    return found == numbers_.end() ? nullptr : &sources_[found->second];
  }

  // The first time: adds the wanted ports that are not known yet.
  void add_columns(const protocol::PartDescription& part) {
    const auto [known, is_new] = numbers_.emplace(part.name, sources_.size());
    if (is_new) sources_.push_back({part.name, 0, 0, {}, {}});
    for (const bool is_input : {true, false})
      for (const auto& port : ports_of(part, is_input)) {
        if (!is_wanted(part.name, port) || has_column(sources_[known->second], is_input, port.name)) continue;
        sources_[known->second].columns.push_back(columns_.size());
        columns_.push_back({known->second, is_input, port.name});
      }
    if (columns_.size() > kMostColumns)
      throw std::runtime_error("the recording has more than " + std::to_string(kMostColumns) +
                               " ports: choose some with --ports");
  }

  bool has_column(const Source& source, bool is_input, const std::string& port) const {
    return std::ranges::any_of(source.columns, [&](std::size_t column) {
      return columns_[column].is_input == is_input && columns_[column].port == port;
    });
  }

  // Marks the names of `options` that were used.
  bool is_wanted(const std::string& part, const protocol::Port& port) {
    bool wanted = options_.ports.empty();
    for (std::size_t k = 0; k < options_.ports.size(); ++k) {
      const auto& name = options_.ports[k];
      if (name == part || name == part + "/" + port.group || name == part + "/" + port.name)
        wanted = found_[k] = true;
    }
    return wanted;
  }

  void put_head() {
    const auto missing = std::ranges::find(found_, false);
    if (missing != found_.end())
      throw std::runtime_error("the recording has no ports '" +
                               options_.ports[static_cast<std::size_t>(missing - found_.begin())] + "'");
    out_ << "tick,era,time_s";
    for (const auto& column : columns_)
      out_ << "," << quoted(sources_[column.source].part + "/" + column.port);
    out_ << "\r\n";
  }

  // The second time: the part has these ports from now on.
  void follow(const protocol::PartDescription& part) {
    auto* const source = find(part.name);
    if (!source) return;  // the file has grown meanwhile
    source->inputs = part.controller_inputs.size();
    source->outputs = part.sensor_outputs.size();
    source->sample = {};
    for (const auto number : source->columns) {
      auto& column = columns_[number];
      const auto& ports = ports_of(part, column.is_input);
      const auto port = std::ranges::find(ports, column.port, &protocol::Port::name);
      column.index.reset();
      if (port != ports.end()) column.index = static_cast<std::size_t>(port - ports.begin());
    }
  }

  // A damaged file may hold samples of another length: they are cut or filled to the part's ports.
  void keep(const protocol::PartSample& sample) {
    auto* const source = find(sample.part);
    if (!source) return;
    source->sample = sample;
    source->sample.controller_inputs.resize(source->inputs);
    source->sample.sensor_outputs.resize(source->outputs);
  }

  bool is_wanted(const Tick& tick) const {
    const double time_s = time_s_of(tick);
    return tick.tick % options_.every == 0 && time_s >= options_.from_s && time_s <= options_.to_s;
  }

  // Each part that is there has a sample of this very tick.
  void put_row(const Tick& tick) {
    out_ << tick.tick << "," << tick.era << "," << exact(time_s_of(tick), std::chars_format::fixed);
    for (const auto& column : columns_) {
      const auto& sample = sources_[column.source].sample;
      out_ << ",";
      if (!column.index || sample.tick != tick.tick || sample.era != tick.era) continue;
      out_ << exact((column.is_input ? sample.controller_inputs : sample.sensor_outputs)[*column.index]);
    }
    out_ << "\r\n";
    ++result_.rows;
  }

  RecordingFile file_;
  const CsvOptions& options_;
  std::ostream& out_;
  std::vector<bool> found_;                     // by the names of `options`
  std::vector<Source> sources_;                 // in the order in which they are described first
  std::map<std::string, std::size_t> numbers_;  // of the sources, by part
  std::vector<Column> columns_;
  CsvResult result_;
};

}  // namespace

CsvResult export_csv(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out) {
  return Exporter(file, options, out).run();
}

}  // namespace visum::recording
