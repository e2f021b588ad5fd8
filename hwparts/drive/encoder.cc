#include "hwparts/drive/encoder.h"

#include <cmath>

namespace visum::drive {

double quantised(const DriveData& data, double position) {
  const double increment = data.increment();
  return std::floor(position / increment + 0.5) * increment;
}

double filtered_speed(const LoopData& loop, double speed, double difference, double tick_s) {
  return speed + tick_s / (tick_s + loop.speed_filter) * (difference / tick_s - speed);
}

}  // namespace visum::drive
