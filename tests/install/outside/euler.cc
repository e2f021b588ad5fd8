// An engine as an outside project would write it: free bodies, hinges and sliders, in steps of semi-implicit
// Euler. Impulses from one linear system, J M⁻¹ Jᵀ λ = b - J u, make the joints hold at the end of each tick.
// It is of first order in the tick. A drive that reaches its limit stays there for the tick. The engine
// refuses what it has no rows for: other joints, stops, friction, damping, contacts, and joints that form a
// ring.
#include <visum/plugin.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace {

using namespace visum::plugin;

struct Vec {
  double x = 0.0, y = 0.0, z = 0.0;
};
Vec vec(const double from[3]) {
  return {from[0], from[1], from[2]};
}
Vec operator+(Vec a, Vec b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator-(Vec a, Vec b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec operator*(double s, Vec a) {
  return {s * a.x, s * a.y, s * a.z};
}
double dot(Vec a, Vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec unit(Vec a) {
  return 1.0 / std::sqrt(dot(a, a)) * a;
}

struct Quat {
  double w = 1.0;
  Vec v;
};
Quat quat(const double from[4]) {
  return {from[0], vec(from + 1)};
}
Quat operator*(Quat a, Quat b) {
  return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}
Quat conjugate(Quat q) {
  return {q.w, -1.0 * q.v};
}
Vec turned(Quat q, Vec a) {
  return a + 2.0 * cross(q.v, cross(q.v, a) + q.w * a);
}

struct Matrix {
  std::array<Vec, 3> rows;
  Vec operator*(Vec a) const { return {dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)}; }
};
Matrix inverse(const Matrix& m) {  // of a symmetric matrix
  const Vec a = cross(m.rows[1], m.rows[2]), b = cross(m.rows[2], m.rows[0]), c = cross(m.rows[0], m.rows[1]);
  const double s = 1.0 / dot(m.rows[0], a);
  return {{s * a, s * b, s * c}};
}

struct Body {
  bool own = false;
  double inverse_mass = 0.0;
  Matrix inertia, inverse_inertia;  // in the body's axes
  Vec p, v, w;
  Quat q;

  void push(Vec impulse, Vec twist) {
    if (!own) return;
    v = v + inverse_mass * impulse;
    w = w + answer(twist);
  }
  Vec answer(Vec twist) const { return turned(q, inverse_inertia * turned(conjugate(q), twist)); }
};

// One scalar condition: along·(v_b - v_a) + about_b·w_b - about_a·w_a + soft λ = wanted, and |λ| <= most.
struct Row {
  Body *a, *b;
  Vec along, about_a, about_b;
  double wanted = 0.0, soft = 0.0, most = INFINITY, impulse = 0.0;
  bool clamped = false;

  double speed() const { return dot(along, b->v - a->v) + dot(about_b, b->w) - dot(about_a, a->w); }
  void push(double by) const {
    a->push(-by * along, -by * about_a);
    b->push(by * along, by * about_b);
  }
  // The change of this row's speed by a unit impulse of the other row.
  double coupling(const Row& other) const {
    double sum = 0.0;
    for (const auto& [mine, sign, about] : {std::tuple(a, -1.0, about_a), std::tuple(b, 1.0, about_b)})
      for (const auto& [theirs, their_sign, their_about] :
           {std::tuple(other.a, -1.0, other.about_a), std::tuple(other.b, 1.0, other.about_b)})
        if (mine == theirs && mine->own)
          sum += sign * their_sign *
                 (mine->inverse_mass * dot(along, other.along) + dot(about, mine->answer(their_about)));
    return sum;
  }
};

// Gaussian elimination with pivots. Throws if the rows are not independent.
void solve(std::vector<std::vector<double>>& m, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(m[i][k]) > std::abs(m[best][k])) best = i;
    if (!(std::abs(m[best][k]) > 1e-12))
      throw Error("has joints that hold each other: it knows no closed loops");
    std::swap(m[k], m[best]);
    std::swap(b[k], b[best]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double share = m[i][k] / m[k][k];
      for (std::size_t j = k; j < n; ++j) m[i][j] -= share * m[k][j];
      b[i] -= share * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= m[k][j] * b[j];
    b[k] /= m[k][k];
  }
}

class Euler final : public Engine {
 public:
  explicit Euler(EngineContext& scene)
      : joints_(scene.joints().begin(), scene.joints().end()),
        correction_(scene.settings().number_or("correction", 0.2, 0.0, 1.0)) {
    for (const EngineBody& body : scene.bodies()) {
      names_.push_back(body.name);
      Body& own = bodies_.emplace_back();
      if (!(own.own = body.own)) continue;
      own.inverse_mass = 1.0 / body.mass_kg;
      own.inertia = {{vec(body.inertia), vec(body.inertia + 3), vec(body.inertia + 6)}};
      own.inverse_inertia = inverse(own.inertia);
    }
    for (const EngineJoint& joint : joints_) refuse(joint);
  }

  void step(const EngineTick& tick) override {
    for (const EngineContact& contact : tick.contacts)
      throw Error("knows no contacts: body '" + names_[static_cast<std::size_t>(contact.a)] +
                  "' touches body '" + names_[static_cast<std::size_t>(contact.b)] + "'");
    take(tick);
    for (std::size_t i = 0; i < joints_.size(); ++i) add_rows(i, tick);
    find_impulses();
    for (const Row& row : rows_) row.push(row.impulse);
    for (std::size_t i = 0; i < joints_.size(); ++i)
      tick.efforts[i] = rows_[last_row_[i]].impulse / tick.tick_s + tick.drives[i].feedforward;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (bodies_[i].own) move(bodies_[i], tick.tick_s, tick.bodies[i]);
  }

 private:
  static void refuse(const EngineJoint& joint) {
    const std::string whose = "joint '" + joint.name + "' ";
    if (joint.kind != "hinge" && joint.kind != "slider")
      throw Error(whose + "is of kind " + joint.kind + "; this engine holds hinge and slider");
    if (joint.limited) throw Error(whose + "has stops, which this engine does not hold");
    if (joint.friction > 0.0 || joint.damping > 0.0)
      throw Error(whose + "has friction or damping, which this engine does not know");
  }

  // Takes over the bodies' places, and the speeds that they would have without joints.
  void take(const EngineTick& tick) {
    rows_.clear();
    last_row_.clear();
    const double h = tick.tick_s;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Body& body = bodies_[i];
      const Motion& motion = tick.bodies[i];
      body.p = vec(motion.p);
      body.q = quat(motion.q_wxyz);
      body.v = vec(motion.velocity);
      body.w = vec(motion.turn_rate);
      if (!body.own) continue;
      const Vec spin = turned(body.q, body.inertia * turned(conjugate(body.q), body.w));
      body.push({}, h * cross(spin, body.w));  // Euler: I dw/dt = torque - w x I w
      body.v = body.v + h * vec(tick.gravity);
    }
    for (const EnginePush& push : tick.pushes)
      bodies_[static_cast<std::size_t>(push.body)].push(h * vec(push.force_n), h * vec(push.torque_nm));
  }

  void add_rows(std::size_t number, const EngineTick& tick) {
    const EngineJoint& joint = joints_[number];
    Body& a = joint.parent < 0 ? ground_ : bodies_[static_cast<std::size_t>(joint.parent)];
    Body& b = bodies_[static_cast<std::size_t>(joint.child)];
    const Vec at_a = a.p + turned(a.q, vec(joint.in_parent.p)),
              at_b = b.p + turned(b.q, vec(joint.in_child.p));
    const Quat frame_a = a.q * quat(joint.in_parent.q_wxyz), frame_b = b.q * quat(joint.in_child.q_wxyz);
    const Vec axis = turned(frame_a, vec(joint.axis)), axis_b = turned(frame_b, vec(joint.axis));
    const Vec side = unit(cross(axis, std::abs(axis.x) < 0.5 ? Vec{1, 0, 0} : Vec{0, 1, 0}));
    const Vec other = cross(axis, side);
    const double back = -correction_ / tick.tick_s;
    const bool turns = joint.kind == "hinge";
    // A row for the place at_b, which body a carries along; the other kind of row is for turning.
    const auto place = [&](Vec along) {
      rows_.push_back({&a, &b, along, cross(at_b - a.p, along), cross(at_b - b.p, along),
                       back * dot(along, at_b - at_a)});
    };
    const auto turning = [&](Vec about, Vec error) {
      rows_.push_back({&a, &b, {}, about, about, back * dot(about, error)});
    };
    const Quat off = frame_b * conjugate(frame_a);
    const Vec tilt = turns ? cross(axis, axis_b) : (off.w < 0.0 ? -2.0 : 2.0) * off.v;
    place(side);
    place(other);
    turning(side, tilt);
    turning(other, tilt);
    if (turns) {
      place(axis);
      turning(axis, {});
    } else {
      turning(axis, tilt);
      place(axis);
    }
    // The last row is the joint's free direction, which the drive acts on.
    const JointDrive& drive = tick.drives[number];
    Row& free = rows_.back();
    free.wanted = drive.target_velocity;
    free.soft = drive.compliance / tick.tick_s;
    free.most = drive.max_effort * tick.tick_s;
    free.clamped = drive.max_effort == 0.0;
    free.push(drive.feedforward * tick.tick_s);
    last_row_.push_back(rows_.size() - 1);
  }

  // Solves all rows at once. Rows beyond their limits are fixed there, and the others are solved again.
  void find_impulses() {
    for (bool again = true; again;) {
      again = false;
      for (const Row& row : rows_) row.push(row.clamped ? row.impulse : 0.0);
      std::vector<Row*> open;
      for (Row& row : rows_)
        if (!row.clamped) open.push_back(&row);
      std::vector<std::vector<double>> matrix(open.size(), std::vector<double>(open.size()));
      std::vector<double> impulses(open.size());
      for (std::size_t i = 0; i < open.size(); ++i) {
        for (std::size_t j = 0; j < open.size(); ++j) matrix[i][j] = open[i]->coupling(*open[j]);
        matrix[i][i] += open[i]->soft;
        impulses[i] = open[i]->wanted - open[i]->speed();
      }
      for (const Row& row : rows_) row.push(row.clamped ? -row.impulse : 0.0);
      solve(matrix, impulses);
      for (std::size_t i = 0; i < open.size(); ++i) {
        open[i]->impulse = std::clamp(impulses[i], -open[i]->most, open[i]->most);
        open[i]->clamped = open[i]->impulse != impulses[i];
        again = again || open[i]->clamped;
      }
    }
  }

  static void move(Body& body, double h, Motion& to) {
    body.p = body.p + h * body.v;
    const double rate = std::sqrt(dot(body.w, body.w)), half = 0.5 * h * rate;
    if (rate > 0.0) body.q = Quat{std::cos(half), std::sin(half) / rate * body.w} * body.q;
    const double size = std::sqrt(body.q.w * body.q.w + dot(body.q.v, body.q.v));
    const Quat q{body.q.w / size, 1.0 / size * body.q.v};
    to = {{body.p.x, body.p.y, body.p.z},
          {q.w, q.v.x, q.v.y, q.v.z},
          {body.v.x, body.v.y, body.v.z},
          {body.w.x, body.w.y, body.w.z}};
  }

  const std::vector<EngineJoint> joints_;
  const double correction_;  // share of a joint's gap that one tick closes
  std::vector<std::string> names_;
  std::vector<Body> bodies_;
  Body ground_;
  std::vector<Row> rows_;
  std::vector<std::size_t> last_row_;  // by joint
};

constexpr EngineKind kEngines[] = {
    {"euler", "free bodies, hinges and sliders; correction: share of a gap closed per tick",
     make_engine<Euler>}};

}  // namespace

VISUM_PLUGIN({.name = "euler", .version = "1.0", .engines = kEngines})
