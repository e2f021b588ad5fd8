#include "server/recording/export_csv.h"

#include <algorithm>
#include <charconv>
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

// A part of the recording, its newest sample (empty before the first), and the ports that become columns.
struct Source {
  protocol::PartDescription description;
  protocol::PartSample sample;
  std::vector<std::size_t> inputs, outputs;
};

// Reads the recording front to back and writes a row for each wanted tick.
class Exporter {
 public:
  Exporter(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out)
      : file_(file), options_(options), out_(out) {}

  CsvResult run() {
    bool begun = false;
    for (auto item = file_.next(); !std::holds_alternative<RecordingFile::End>(item); item = file_.next()) {
      if (const auto* part = std::get_if<const protocol::PartDescription*>(&item); part && !begun)
        sources_.push_back({**part, {}, {}, {}});
      if (const auto* sample = std::get_if<const protocol::PartSample*>(&item)) keep(**sample);
      const auto* tick = std::get_if<const Tick*>(&item);
      if (!tick) continue;
      if (!std::exchange(begun, true)) begin();
      if (is_wanted(**tick)) put_row(**tick);
    }
    if (!begun) begin();
    result_.damage = file_.damage();
    return std::move(result_);
  }

 private:
  // Writes the head line, once all parts are known: their descriptions stand before the first tick.
  void begin() {
    std::vector<bool> found(options_.ports.size(), options_.ports.empty());
    out_ << "tick,era,time_s";
    for (auto& source : sources_) {
      choose(source, source.description.controller_inputs, source.inputs, found);
      choose(source, source.description.sensor_outputs, source.outputs, found);
    }
    out_ << "\r\n";
    const auto missing = std::ranges::find(found, false);
    if (missing != found.end())
      throw std::runtime_error("the recording has no ports '" +
                               options_.ports[static_cast<std::size_t>(missing - found.begin())] + "'");
  }

  // Adds the wanted ports to `columns` and to the head line, and marks in `found` the names that were used.
  void choose(const Source& source, const std::vector<protocol::Port>& ports,
              std::vector<std::size_t>& columns, std::vector<bool>& found) {
    const auto& part = source.description.name;
    for (std::size_t i = 0; i < ports.size(); ++i) {
      bool wanted = options_.ports.empty();
      for (std::size_t k = 0; k < options_.ports.size(); ++k) {
        const auto& name = options_.ports[k];
        if (name != part && name != part + "/" + ports[i].group && name != part + "/" + ports[i].name)
          continue;
        wanted = found[k] = true;
      }
      if (!wanted) continue;
      columns.push_back(i);
      out_ << "," << quoted(part + "/" + ports[i].name);
    }
  }

  // A damaged file may hold samples of another length: they are cut or filled to the part's ports.
  void keep(const protocol::PartSample& sample) {
    const auto source =
        std::ranges::find(sources_, sample.part, [](const Source& each) { return each.description.name; });
    if (source == sources_.end()) return;
    source->sample = sample;
    source->sample.controller_inputs.resize(source->description.controller_inputs.size());
    source->sample.sensor_outputs.resize(source->description.sensor_outputs.size());
  }

  bool is_wanted(const Tick& tick) const {
    const double time_s = time_s_of(tick);
    return tick.tick % options_.every == 0 && time_s >= options_.from_s && time_s <= options_.to_s;
  }

  void put_row(const Tick& tick) {
    out_ << tick.tick << "," << tick.era << "," << exact(time_s_of(tick), std::chars_format::fixed);
    for (const auto& source : sources_) {
      put_cells(source.inputs, source.sample.controller_inputs);
      put_cells(source.outputs, source.sample.sensor_outputs);
    }
    out_ << "\r\n";
    ++result_.rows;
  }

  void put_cells(const std::vector<std::size_t>& columns, const std::vector<double>& values) {
    for (const auto column : columns) out_ << "," << (values.empty() ? "" : exact(values[column]));
  }

  RecordingFile file_;
  const CsvOptions& options_;
  std::ostream& out_;
  std::vector<Source> sources_;  // in the order of the world's parts
  CsvResult result_;
};

}  // namespace

CsvResult export_csv(const std::filesystem::path& file, const CsvOptions& options, std::ostream& out) {
  return Exporter(file, options, out).run();
}

}  // namespace visum::recording
