#include "clients/mca/blackboard.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "clients/mca/part.h"
#include "protocol/part_description.h"

namespace visum::mca {

Blackboard::Blackboard(Module& module, std::string name, BlackboardOptions options)
    : name_(std::move(name)), options_(std::move(options)) {
  if (options_.row_bytes == 0)
    throw std::invalid_argument("a row of the blackboard '" + name_ + "' has no bytes");
  if (options_.most_rows > kMostBytes / options_.row_bytes)
    throw std::invalid_argument("the blackboard '" + name_ + "' has more than " + std::to_string(kMostBytes) +
                                " bytes");
  module.part().keep(*this);
}

std::string Blackboard::write(std::span<const std::byte> data, std::uint64_t offset) {
  const std::size_t most = options_.row_bytes * options_.most_rows;
  if (offset > bytes_.size())
    return "'" + name_ + "' has " + std::to_string(bytes_.size()) +
           " bytes, and a write cannot begin behind them";
  if (data.size() > most - offset) return "'" + name_ + "' takes at most " + std::to_string(most) + " bytes";
  const std::size_t size =
      offset == 0 ? data.size() : std::max<std::size_t>(bytes_.size(), offset + data.size());
  if (size % options_.row_bytes != 0)
    return "'" + name_ + "' has rows of " + std::to_string(options_.row_bytes) + " bytes";
  bytes_.resize(size);
  std::ranges::copy(data, bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  ++generation_;
  return {};
}

protocol::Blackboard Blackboard::description() const {
  return {name_,
          options_.content_type,
          options_.row_bytes,
          rows(),
          options_.row_bytes * options_.most_rows,
          options_.writable};
}

}  // namespace visum::mca
