#include "hwparts/sensors/reading_queue.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

namespace visum::sensors {

ReadingQueue::ReadingQueue(std::size_t slots, std::size_t numbers)
    : numbers_(numbers), due_ns_(slots), values_(slots * numbers) {}

bool ReadingQueue::push(std::int64_t due_ns, std::span<const double> reading) {
  if (count_ == due_ns_.size()) return false;
  const std::size_t at = slot(count_++);
  due_ns_[at] = due_ns;
  std::ranges::copy(reading.first(numbers_), values_.begin() + static_cast<std::ptrdiff_t>(at * numbers_));
  return true;
}

std::span<const double> ReadingQueue::front() const {
  return std::span(values_).subspan(first_ * numbers_, numbers_);
}

void ReadingQueue::pop() {
  assert(count_ > 0);
  first_ = slot(1);
  --count_;
}

std::size_t ReadingQueue::drop_overtaken(std::int64_t now_ns) {
  std::size_t dropped = 0;
  for (; count_ > 1 && due_ns_[slot(1)] <= now_ns; ++dropped) pop();
  return dropped;
}

void ReadingQueue::hasten(std::int64_t late_ns, std::int64_t in_time_ns) {
  std::int64_t behind_ns = 0;  // when the reading behind this one was due
  for (std::size_t place = count_; place-- > 0;) {
    std::int64_t& due_ns = due_ns_[slot(place)];
    // The first late reading is due more than late_ns after the last usual one: the late ones end there.
    if (place + 1 == count_ ? due_ns <= in_time_ns : behind_ns - due_ns > late_ns) return;
    behind_ns = due_ns;
    due_ns -= late_ns;
  }
}

void ReadingQueue::save(hwparts::StateWriter& to) const {
  to.put(static_cast<std::uint64_t>(count_));
  for (std::size_t i = 0; i < count_; ++i) {
    to.put(due_ns_[slot(i)]);
    to.put(std::span(values_).subspan(slot(i) * numbers_, numbers_));
  }
}

void ReadingQueue::load(hwparts::StateReader& from) {
  std::uint64_t count = 0;
  from.get(count);
  if (count > due_ns_.size()) throw std::out_of_range("more readings are under way than there is room for");
  clear();
  for (; count_ < count; ++count_) {
    from.get(due_ns_[count_]);
    from.get(std::span(values_).subspan(count_ * numbers_, numbers_));
  }
}

}  // namespace visum::sensors
