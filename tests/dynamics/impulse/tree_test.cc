// A tree with all kinds of joints. Its answer is checked by the equations of mechanics (tree.h has the
// symbols), and both builds of the kernels must give the same bits.
#include "server/dynamics/impulse/tree.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

namespace visum::dynamics::impulse {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

struct Branch {
  int parent;
  std::vector<Vector6> free;  // angular, linear
};

constexpr int kGround = -1, kRoot = -2;

class Grove {
 public:
  explicit Grove(const Kernels& by = kernels()) : tree(by), bodies_(make_model(), 0) {
    for (const Branch& branch : branches_) add(branch);
    std::vector<TreeNode> nodes = nodes_;
    tree.assign(std::move(nodes));
    axes_[1] = {true, 0.3};
    axes_[7] = {true, 0.0};
    tree.factor(bodies_, poses_, motions_, axes_);
  }

  std::size_t size() const { return branches_.size(); }
  void ask() {
    tree.clear();
    for (std::size_t i = 0; i < size(); ++i) {
      pushed_[i] << vector(), vector();
      tree.push_body(i, pushed_[i].head<3>(), pushed_[i].tail<3>());
      if (nodes_[i].joint < 0) continue;
      asked_[i] << vector(), vector();
      tree.ask(i, asked_[i].head<3>(), asked_[i].tail<3>());
      if (nodes_[i].freedoms == 1) tree.push_axis(i, along_[i] = number());
      if (axes_[i].implicit) tree.ask_axis(i, target_[i] = number());
    }
  }
  // Relative velocity of the child against the parent, at P, less what was asked.
  Vector6 missed(std::size_t i) const {
    Vector6 result = at(i, poses_[i].pb) - asked_[i];
    if (nodes_[i].parent >= 0) result -= at(static_cast<std::size_t>(nodes_[i].parent), poses_[i].pb);
    return result;
  }
  Eigen::Matrix<double, 6, Eigen::Dynamic> free(std::size_t i) const {
    Eigen::Matrix<double, 6, Eigen::Dynamic> result(6, nodes_[i].freedoms);
    for (int k = 0; k < nodes_[i].freedoms; ++k)
      result.col(k) = branches_[i].free[static_cast<std::size_t>(k)];
    return result;
  }
  // The impulses that all bodies beyond joint i got and were not pushed with, about its P.
  Vector6 given(std::size_t i) const {
    Vector6 sum = Vector6::Zero();
    for (std::size_t j = i; j < size(); ++j) {
      if (!hangs_on(j, i)) continue;
      const Vector3d linear = nodes_[j].mass * tree.dv(j) - pushed_[j].tail<3>();
      const Vector3d angular = bodies_.inertia[j] * tree.dw(j) - pushed_[j].head<3>();
      sum.head<3>() += angular + (bodies_.x[j] - point(i)).cross(linear);
      sum.tail<3>() += linear;
    }
    return sum;
  }
  std::vector<JointImpulse> apply() {
    std::vector<JointImpulse> result(size());
    tree.apply_and_note(bodies_, result);
    return result;
  }
  // By the law of its axis, without the impulse that is pushed on it: lambda = (b - q') / k.
  void expect_drives_to_act() const {
    EXPECT_NEAR(tree.axis_rate(1) + 0.3 * tree.axis_impulse(1), target_[1], 1e-12);
    EXPECT_NEAR(tree.axis_rate(7), target_[7], 1e-12);
  }
  double along(std::size_t i) const { return along_[i] + tree.axis_impulse(i); }
  const TreeNode& node(std::size_t i) const { return nodes_[i]; }
  const Bodies& bodies() const { return bodies_; }

  Tree tree;

 private:
  double number() { return uniform_(generator_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Vector6 turn() { return (Vector6() << vector(), Vector3d::Zero()).finished(); }
  Vector6 slide() { return (Vector6() << Vector3d::Zero(), vector()).finished(); }
  Vector6 both() { return (Vector6() << vector(), vector()).finished(); }
  world::WorldModel make_model() {
    branches_ = {{kRoot, {}},                    // 0
                 {0, {turn()}},                  // 1: a chain, a drive in it
                 {1, {turn(), turn(), turn()}},  //
                 {2, {slide()}},                 // 3
                 {1, {turn(), turn()}},          // 4: a branch
                 {4, {}},                        // 5: fixed
                 {1, {slide(), turn()}},         // 6: another
                 {kGround, {turn()}},            // 7: a part of its own, locked by its drive
                 {5, {both()}},                  // 8: of the first part again
                 {7, {turn()}},                  // 9
                 {9, {turn()}},                  // 10
                 {kRoot, {}},                    // 11: another free root
                 {11, {turn()}}};                // 12
    world::WorldModel model;
    model.engines.emplace_back();
    for (std::size_t i = 0; i < branches_.size(); ++i) {
      world::Body body;
      body.mass_kg = 1.5 + number();
      body.inertia_C.setIdentity();
      model.bodies.push_back(body);
    }
    return model;
  }
  void add(const Branch& branch) {
    const std::size_t i = nodes_.size();
    const bool root = branch.parent == kRoot;
    nodes_.push_back({.body = static_cast<int>(i),
                      .parent = std::max(branch.parent, -1),
                      .joint = root ? -1 : static_cast<int>(i),
                      .freedoms = static_cast<int>(branch.free.size()),
                      .mass = bodies_.constants[i].mass});
    bodies_.x[i] = vector();
    const Matrix3d half = Matrix3d::NullaryExpr([&] { return number(); });
    bodies_.inertia[i] = half * half.transpose() + 0.1 * Matrix3d::Identity();
    poses_.emplace_back().pb = vector();
    motions_.emplace_back();
    for (const Vector6& direction : branch.free) motions_[i].add(direction.head<3>(), direction.tail<3>());
    for (auto* list : {&pushed_, &asked_}) list->push_back(Vector6::Zero());
    for (auto* list : {&along_, &target_}) list->push_back(0.0);
    axes_.emplace_back();
  }
  bool hangs_on(std::size_t j, std::size_t i) const {
    for (int k = static_cast<int>(j); k >= 0; k = nodes_[static_cast<std::size_t>(k)].parent)
      if (k == static_cast<int>(i)) return true;
    return false;
  }
  const Vector3d& point(std::size_t i) const { return nodes_[i].joint < 0 ? bodies_.x[i] : poses_[i].pb; }
  Vector6 at(std::size_t i, const Vector3d& p) const {
    const Vector3d w = tree.dw(i);
    return (Vector6() << w, tree.dv(i) + w.cross(p - bodies_.x[i])).finished();
  }

  std::mt19937 generator_{7};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
  std::vector<Branch> branches_;
  Bodies bodies_;
  std::vector<TreeNode> nodes_;
  std::vector<JointPose> poses_;
  std::vector<Motion> motions_;
  std::vector<TreeAxis> axes_;
  std::vector<Vector6> pushed_, asked_;
  std::vector<double> along_, target_;
};

TEST(Tree, MovesAsAskedAndGivesNothingAlongWhatIsFree) {
  Grove grove;
  grove.ask();
  grove.tree.solve();
  for (std::size_t i = 0; i < grove.size(); ++i) {
    if (grove.node(i).joint < 0) {
      EXPECT_LT(grove.given(i).norm(), 1e-11) << "nothing holds a free root";
      continue;
    }
    const auto free = grove.free(i);
    const Vector6 missed = grove.missed(i);
    Vector6 left = missed;
    if (free.cols() > 0) left -= free * free.colPivHouseholderQr().solve(missed);
    EXPECT_LT(left.norm(), 1e-11) << i;
    if (free.cols() == 1) {
      EXPECT_LT((missed - grove.tree.axis_rate(i) * free).norm(), 1e-11) << i;
      EXPECT_NEAR(free.col(0).dot(grove.given(i)), grove.along(i), 1e-11) << i;
    } else if (free.cols() > 0) {
      EXPECT_LT((free.transpose() * grove.given(i)).norm(), 1e-11) << i;
    }
  }
  grove.expect_drives_to_act();
}

TEST(Tree, NotesWhatItsJointsGive) {
  Grove grove;
  grove.ask();
  grove.tree.solve();
  const std::vector<JointImpulse> noted = grove.apply();
  double largest = 0.0;
  for (std::size_t i = 0; i < grove.size(); ++i) {
    const Vector6 given = grove.given(i);
    EXPECT_LT((noted[i].w - given.head<3>()).norm() + (noted[i].v - given.tail<3>()).norm(), 1e-12) << i;
    EXPECT_EQ(grove.bodies().v[i], Vector3d(grove.tree.dv(i)));
    EXPECT_EQ(grove.bodies().w[i], Vector3d(grove.tree.dw(i)));
    largest =
        std::max({largest, grove.tree.dv(i).cwiseAbs().maxCoeff(), grove.tree.dw(i).cwiseAbs().maxCoeff()});
  }
  EXPECT_EQ(grove.tree.largest_answer(), largest);
}

// A unit impulse: on one or two bodies, or on the axis of `a` (if it has no directions).
struct Impulse {
  int a, b = -1;
  Vector6 on_a = Vector6::Zero(), on_b = Vector6::Zero();
  bool is_on_axis() const { return on_a.isZero(0.0); }
};

// Impulses on bodies of one chain, of two branches, of two parts, on the roots and against what does not
// move.
std::vector<Impulse> make_impulses() {
  std::mt19937 generator{3};
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
  const auto direction = [&] { return Vector6(Vector6::NullaryExpr([&] { return uniform(generator); })); };
  std::vector<Impulse> impulses{{1}, {3}, {7}, {9}};
  const std::vector<std::pair<int, int>> ends{{0, -1}, {3, -1}, {8, -1}, {3, 8},  {8, 3},  {6, 0},  {1, 3},
                                              {10, 2}, {-1, 9}, {5, 5},  {12, 3}, {0, 12}, {11, -1}};
  // One, two, three and four impulses that are followed together.
  std::size_t together = 0;
  for (const auto& [a, b] : ends) {
    for (std::size_t i = 0; i <= together % 4; ++i) impulses.push_back({a, b, direction(), direction()});
    ++together;
  }
  return impulses;
}

// Impulses that may be followed together, both ends of each.
struct Together {
  std::size_t first = 0;  // its number
  std::vector<TreePush> a, b;
};

std::vector<Together> put_together(const Tree& tree, const std::vector<Impulse>& impulses) {
  std::vector<Together> all;
  for (std::size_t i = 0; i < impulses.size();) {
    Together& one = all.emplace_back();
    one.first = i;
    const Impulse& first = impulses[i];
    do {
      const Impulse& impulse = impulses[i++];
      one.a.push_back(impulse.is_on_axis()
                          ? tree.push_on_axis(static_cast<std::size_t>(impulse.a))
                          : tree.push_at(impulse.a, impulse.on_a.head<3>(), impulse.on_a.tail<3>()));
      one.b.push_back(tree.push_at(impulse.b, impulse.on_b.head<3>(), impulse.on_b.tail<3>()));
    } while (i < impulses.size() && one.a.size() < Tree::kMostTogether && impulses[i].a == first.a &&
             impulses[i].b == first.b);
  }
  return all;
}

std::vector<double> find_response(Grove& grove, const std::vector<Impulse>& impulses) {
  Tree& tree = grove.tree;
  tree.begin_traces(impulses.size());
  for (const Together& one : put_together(tree, impulses)) tree.trace(one.a, one.b);
  std::vector<double> W(impulses.size() * impulses.size());
  tree.find_response(W.data());
  return W;
}

TEST(Tree, FindsTheResponseThatItsAnswersHave) {
  Grove grove;
  const std::vector<Impulse> impulses = make_impulses();
  const std::vector<double> W = find_response(grove, impulses);
  Tree& tree = grove.tree;
  const auto rate_on = [&](int node, const Vector6& on) {
    const auto i = static_cast<std::size_t>(node);
    return node < 0 ? 0.0 : on.head<3>().dot(tree.dw(i)) + on.tail<3>().dot(tree.dv(i));
  };
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    const Impulse& pushed = impulses[i];
    tree.clear();
    if (pushed.is_on_axis()) tree.push_axis(static_cast<std::size_t>(pushed.a), 1.0);
    for (const auto& [node, on] : {std::pair(pushed.a, pushed.on_a), std::pair(pushed.b, pushed.on_b)})
      if (node >= 0) tree.push_body(static_cast<std::size_t>(node), on.head<3>(), on.tail<3>());
    tree.solve();
    for (std::size_t j = 0; j < impulses.size(); ++j) {
      const Impulse& seen = impulses[j];
      const double rate = seen.is_on_axis() ? tree.axis_rate(static_cast<std::size_t>(seen.a))
                                            : rate_on(seen.a, seen.on_a) + rate_on(seen.b, seen.on_b);
      EXPECT_NEAR(W[i * impulses.size() + j], rate, 1e-11 * (1.0 + std::abs(rate))) << i << ' ' << j;
    }
  }
}

TEST(Tree, FindsTheSameResponseFromEachWayByItself) {
  Grove grove;
  const std::vector<Impulse> impulses = make_impulses();
  const std::vector<double> W = find_response(grove, impulses);
  const std::vector<Together> all = put_together(grove.tree, impulses);
  std::vector<std::vector<Tree::WayPoint>> ways(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) grove.tree.trace(all[k].a, all[k].b, ways[k]);
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t l = 0; l < all.size(); ++l) {
      const Eigen::Matrix4d block = Tree::response(ways[k], ways[l]);
      for (std::size_t i = 0; i < all[k].a.size(); ++i)
        for (std::size_t j = 0; j < all[l].a.size(); ++j) {
          const double expected = W[(all[k].first + i) * impulses.size() + all[l].first + j];
          EXPECT_NEAR(block(static_cast<int>(i), static_cast<int>(j)), expected,
                      1e-11 * (1.0 + std::abs(expected)));
        }
    }
}

TEST(Tree, BothBuildsOfItsKernelsGiveTheSameBits) {
  if (kWideKernels == nullptr || &kernels() != kWideKernels) GTEST_SKIP() << "this machine has one of them";
  Grove narrow(kBaselineKernels), wide(*kWideKernels);
  const std::vector<Impulse> impulses = make_impulses();
  ASSERT_EQ(find_response(narrow, impulses), find_response(wide, impulses));
  for (int time = 0; time < 100; ++time) {
    for (Grove* grove : {&narrow, &wide}) {
      grove->ask();
      grove->tree.solve();
    }
    const std::vector<JointImpulse> a = narrow.apply(), b = wide.apply();
    ASSERT_EQ(narrow.tree.largest_answer(), wide.tree.largest_answer());
    for (std::size_t i = 0; i < narrow.size(); ++i) {
      ASSERT_EQ(narrow.tree.dw(i), wide.tree.dw(i)) << i;
      ASSERT_EQ(narrow.tree.dv(i), wide.tree.dv(i)) << i;
      ASSERT_EQ(narrow.tree.axis_rate(i), wide.tree.axis_rate(i)) << i;
      ASSERT_EQ(narrow.tree.axis_impulse(i), wide.tree.axis_impulse(i)) << i;
      ASSERT_EQ(a[i].w, b[i].w) << i;
      ASSERT_EQ(a[i].v, b[i].v) << i;
      ASSERT_EQ(narrow.bodies().v[i], wide.bodies().v[i]) << i;
      ASSERT_EQ(narrow.bodies().w[i], wide.bodies().w[i]) << i;
    }
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
