// The explorer as a plug-in: an agent that drives the cart over all of the floor that it can reach, and
// touches nothing. It knows only the ports of the wheels and of a scanner. The same library runs inside
// visumd and, with visum-agent, as a client in front of parts anywhere.
// Every turn it adds the scan to its map. A few times per second it looks at a handful of arcs that the scan
// shows to be free, and picks the one that brings it nearest to floor that it has not covered. Before it
// changes direction it stops and steers.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "clients/examples/explorer/cart.h"
#include "clients/examples/explorer/floor_map.h"

namespace visum::explorer {
namespace {

constexpr double kCruise_m_s = 0.35, kAcceleration_m_s2 = 0.6;
constexpr double kChoice_s = 0.25;    // between two choices
constexpr double kSteering_s = 0.5;   // from one side to the other, standing
constexpr double kPatience_s = 15.0;  // without new floor, before it gives a place up
constexpr double kStopShort_m = 0.06, kKeepAway_m = 0.05, kFarSight_m = 0.9, kStep_m = 0.06;
constexpr int kArcs = 9;  // of each direction
constexpr double kPriceOfTurning_m = 0.5, kPriceOfReversing_m = 0.15, kPriceOfSteering_m = 0.08;

struct Point {
  double x, y;  // in the cart's frame
};

struct Arc {
  double direction = 1.0;  // -1: backwards
  double curvature = 0.0;
  bool operator==(const Arc&) const = default;
};

class Eye {
 public:
  explicit Eye(plugin::PartLink& part) : part_(part), changed_(part.output("Changed")) {
    const auto angle = part.output_port(part.output("Nearest Angle"));
    first_ = angle.minimum;
    last_ = angle.maximum;
    reach_m_ = part.output_port(part.output("Nearest Distance")).maximum;
  }

  bool has_seen() const { return part_.value(changed_) > 0.0; }
  double reach_m() const { return reach_m_; }

  // Calls `ray(angle, distance)` for each ray of the last scan.
  template <typename Ray>
  void look(const Ray& ray) {
    const auto bytes = part_.blackboard("scan");
    const std::size_t rays = bytes.size() / sizeof(float);
    for (std::size_t i = 0; i < rays; ++i) {
      float distance = 0.0F;
      std::memcpy(&distance, bytes.data() + i * sizeof distance, sizeof distance);
      const double share = rays > 1 ? static_cast<double>(i) / static_cast<double>(rays - 1) : 0.0;
      ray(first_ + share * (last_ - first_), static_cast<double>(distance));
    }
  }

 private:
  plugin::PartLink& part_;
  std::size_t changed_;
  double first_ = 0.0, last_ = 0.0, reach_m_ = 0.0;
};

class Explorer final : public plugin::Agent {
 public:
  explicit Explorer(plugin::AgentContext& scene)
      : period_s_(scene.period_s()),
        cart_(scene.commanded("wheels")),
        eye_(scene.watched("eye")),
        floor_(scene.settings().number_or("near", 0.4, 0.1, 2.0)),
        way_(scene.add_output({"Way", "m", 0.0, 1e9, 0.0})),
        covered_(scene.add_output({"Covered", "m²", 0.0, 1e9, 0.0})) {}

  void think(const plugin::Turn& turn) override {
    cart_.reckon();
    if (!eye_.has_seen()) return cart_.command(0.0, 0.0);
    look();
    const auto [x, y] = ahead(cart_.place(), kCentreAt_m);
    floor_.cover(x, y);
    turn.outputs[covered_] = floor_.covered_m2();
    since_choice_s_ += period_s_;
    if (since_choice_s_ >= kChoice_s) choose(turn.outputs[covered_]);
    drive();
    turn.outputs[way_] += std::abs(speed_) * period_s_;
  }

  void reset() override {
    cart_.reset();
    floor_.reset();
    arc_ = wanted_ = {};
    speed_ = steering_s_ = since_choice_s_ = since_news_s_ = known_m2_ = 0.0;
    stop_ = true;
  }

  void save(plugin::StateOut& to) const override {
    cart_.save(to);
    floor_.save(to);
    for (const double value : {arc_.direction, arc_.curvature, wanted_.direction, wanted_.curvature, speed_,
                               steering_s_, since_choice_s_, since_news_s_, known_m2_})
      to.put(value);
    to.put(stop_);
  }

  void load(plugin::StateIn& from) override {
    cart_.load(from);
    floor_.load(from);
    for (double* value : {&arc_.direction, &arc_.curvature, &wanted_.direction, &wanted_.curvature, &speed_,
                          &steering_s_, &since_choice_s_, &since_news_s_, &known_m2_})
      from.get(*value);
    from.get(stop_);
  }

 private:
  // Adds the scan to the map, and keeps it as points around the cart.
  void look() {
    const auto from = ahead(cart_.place(), kCentreAt_m);
    points_.clear();
    eye_.look([&](double angle, double distance) {
      const bool met = distance < eye_.reach_m() - 0.05;
      floor_.see(from[0], from[1], cart_.place().heading + angle, distance, met);
      if (met && distance < kFarSight_m + 2 * kCircleRadius_m)
        points_.push_back({kCentreAt_m + distance * std::cos(angle), distance * std::sin(angle)});
    });
  }

  // The distance of the nearest point to the middle of one of the circles that cover the cart at `place`.
  double room(const Place& place) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const double at : kCirclesAt_m) {
      const auto [x, y] = ahead(place, at);
      for (const Point& point : points_)
        nearest = std::min(nearest, (point.x - x) * (point.x - x) + (point.y - y) * (point.y - y));
    }
    return std::sqrt(nearest);
  }

  // How far an arc is free by the scan. If the cart stands nearer to something than it should, it may leave,
  // but come no nearer.
  double free_way(const Arc& arc) const {
    const double least = std::min(kCircleRadius_m + kKeepAway_m, room({}));
    double way = 0.0;
    while (way < kFarSight_m && room(along({}, arc.direction * (way + kStep_m), arc.curvature)) >= least)
      way += kStep_m;
    return way;
  }

  // The distance still to go after the best place on an arc, plus a price for manoeuvres. Infinite if the arc
  // leads nowhere.
  double price(const Arc& arc) const {
    const double free = free_way(arc) - kStopShort_m;
    double best = std::numeric_limits<double>::infinity();
    for (double way = 2 * kStep_m; way <= free; way += kStep_m) {
      const auto [x, y] = ahead(along(cart_.place(), arc.direction * way, arc.curvature), kCentreAt_m);
      best = std::min(best, floor_.way_from(x, y) + 0.1 * way);
    }
    best += kPriceOfSteering_m * std::abs(arc.curvature - arc_.curvature);
    if (arc.direction < 0) best += kPriceOfReversing_m;
    if (arc.direction != arc_.direction) best += kPriceOfTurning_m;
    return best;
  }

  void choose(double covered_m2) {
    since_news_s_ += since_choice_s_;
    since_choice_s_ = 0.0;
    if (covered_m2 > known_m2_) since_news_s_ = 0.0;
    known_m2_ = covered_m2;
    const auto [x, y] = ahead(cart_.place(), kCentreAt_m);
    if (since_news_s_ > kPatience_s) {
      floor_.give_up(x, y);
      since_news_s_ = 0.0;
    }
    stop_ = !floor_.find_ways();
    if (stop_) return;
    double lowest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2 * kArcs; ++i) {
      const Arc arc{i < kArcs ? 1.0 : -1.0, kMaxCurvature * (i % kArcs - kArcs / 2) / (kArcs / 2)};
      if (const double its = price(arc); its < lowest) {
        lowest = its;
        wanted_ = arc;
      }
    }
    // No arc leads anywhere: the longest way back may help.
    if (!std::isfinite(lowest)) wanted_ = {-arc_.direction, 0.0};
  }

  void drive() {
    const bool turns = wanted_.direction != arc_.direction;
    double target = stop_ || turns ? 0.0 : kCruise_m_s;
    if (speed_ == 0.0 && turns) {
      arc_ = wanted_;
      steering_s_ = kSteering_s;
    }
    if (steering_s_ > 0.0) {
      steering_s_ -= period_s_;
      target = 0.0;
    }
    if (!turns) steer();
    const double free = std::max(0.0, free_way(arc_) - kStopShort_m);
    target = std::min(target, std::sqrt(2 * kAcceleration_m_s2 * free));
    const double change = kAcceleration_m_s2 * period_s_;
    // If something is near, it may brake harder than that.
    speed_ = target < speed_ ? std::max(target, speed_ - 3 * change) : std::min(target, speed_ + change);
    cart_.command(arc_.direction * speed_, arc_.curvature);
  }

  // Turns towards the wanted curvature, no faster than the wheels can.
  void steer() {
    const double most = 2 * kMaxCurvature / kSteering_s * period_s_;
    arc_.curvature += std::clamp(wanted_.curvature - arc_.curvature, -most, most);
  }

  const double period_s_;
  Cart cart_;
  Eye eye_;
  FloorMap floor_;
  const std::size_t way_, covered_;  // its outputs
  std::vector<Point> points_;  // of the last scan; computed from the sensor, so it is no state of its own
  Arc arc_, wanted_;
  double speed_ = 0.0;
  double steering_s_ = 0.0;  // still to stand
  double since_choice_s_ = 0.0, since_news_s_ = 0.0;
  double known_m2_ = 0.0;
  bool stop_ = true;
};

constexpr plugin::AgentKind kAgents[] = {
    {"explorer", "drives a cart over all floor that it can reach; parts: wheels, eye",
     plugin::make_agent<Explorer>}};

}  // namespace
}  // namespace visum::explorer

VISUM_PLUGIN({.name = "explorer", .version = "1.0", .agents = visum::explorer::kAgents})
