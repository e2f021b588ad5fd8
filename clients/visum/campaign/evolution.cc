#include "clients/visum/campaign/evolution.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "clients/visum/run/distribution.h"
#include "clients/visum/run/sampling.h"
#include "protocol/config/exp_log.h"

namespace visum::campaign {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLargestStep = 1.0;  // the whole range
constexpr double kClose = 1e-7;       // of the range: nearer points are the same for all practical purposes

std::size_t population_of(std::size_t wanted, std::size_t n) {
  if (wanted != 0) return std::max<std::size_t>(wanted, 4);
  return 4 + static_cast<std::size_t>(3.0 * config::logarithm(static_cast<double>(n)));
}

// Reflected at the ends, so that a point outside stands for one inside.
double inside(double x) {
  constexpr double kEnd = 0x1p-40;
  x = std::abs(std::fmod(x, 2.0));
  return std::clamp(x > 1.0 ? 2.0 - x : x, kEnd, 1.0 - kEnd);
}

// The expected length of a standard normal vector: tutorial, section 4.
double expected_length(Eigen::Index dimensions) {
  const auto n = static_cast<double>(dimensions);
  return std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
}

}  // namespace

// The constants are those of the tutorial's table 1, with positive weights only.
Evolution::Evolution(const Point& start, double step, std::size_t population, std::uint64_t seed)
    : n_(static_cast<Eigen::Index>(start.size())),
      population_(population_of(population, start.size())),
      seed_(seed),
      mean_(Eigen::Map<const VectorXd>(start.data(), n_)),
      path_sigma_(VectorXd::Zero(n_)),
      path_c_(VectorXd::Zero(n_)),
      covariance_(MatrixXd::Identity(n_, n_)),
      factor_(MatrixXd::Identity(n_, n_)),
      sigma_(step),
      best_(std::numeric_limits<double>::infinity()) {
  weights_.resize(static_cast<Eigen::Index>(population_ / 2));
  for (Eigen::Index i = 0; i < weights_.size(); ++i)
    weights_[i] = config::logarithm((static_cast<double>(population_) + 1.0) / 2.0) -
                  config::logarithm(static_cast<double>(i + 1));
  weights_ /= weights_.sum();
  mu_eff_ = 1.0 / weights_.squaredNorm();
  const auto n = static_cast<double>(n_);
  c_sigma_ = (mu_eff_ + 2.0) / (n + mu_eff_ + 5.0);
  c_c_ = (4.0 + mu_eff_ / n) / (n + 4.0 + 2.0 * mu_eff_ / n);
  c_1_ = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff_);
  c_mu_ = std::min(1.0 - c_1_, 2.0 * (mu_eff_ - 2.0 + 1.0 / mu_eff_) / ((n + 2.0) * (n + 2.0) + mu_eff_));
}

double Evolution::damping() const {
  return 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff_ - 1.0) / (static_cast<double>(n_) + 1.0)) - 1.0) +
         c_sigma_;
}

std::vector<Evolution::Point> Evolution::ask() {
  drawn_.resize(n_, static_cast<Eigen::Index>(population_));
  std::vector<Point> points(population_, Point(static_cast<std::size_t>(n_)));
  for (std::size_t i = 0; i < population_; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    for (Eigen::Index axis = 0; axis < n_; ++axis)
      drawn_(axis, column) = run::normal_quantile(
          run::random_share(seed_, static_cast<std::size_t>(axis), generation_ * population_ + i));
    const VectorXd x = mean_ + sigma_ * (factor_ * drawn_.col(column));
    std::transform(x.begin(), x.end(), points[i].begin(), inside);
  }
  return points;
}

void Evolution::tell(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  ++generation_;
  if (values[order[0]] < best_) {
    best_ = values[order[0]];
    best_at_ = generation_;
  }
  // Nothing to learn from a plateau, but that the steps are too short for it (tutorial, appendix B.3).
  if (values[order[0]] == values[order[order.size() * 7 / 10]])
    sigma_ = std::min(kLargestStep, sigma_ * config::exponential(0.2 + c_sigma_ / damping()));
  else
    adapt(order);
}

// Equations 38 to 47 of the tutorial; z replaces C^(-1/2) y.
void Evolution::adapt(const std::vector<std::size_t>& best) {
  VectorXd z = VectorXd::Zero(n_);
  MatrixXd rank_mu = MatrixXd::Zero(n_, n_);
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const VectorXd drawn = drawn_.col(static_cast<Eigen::Index>(best[static_cast<std::size_t>(i)]));
    const VectorXd y = factor_ * drawn;
    z += weights_[i] * drawn;
    rank_mu += weights_[i] * y * y.transpose();
  }
  const VectorXd y = factor_ * z;
  mean_ += sigma_ * y;
  path_sigma_ = (1.0 - c_sigma_) * path_sigma_ + std::sqrt(c_sigma_ * (2.0 - c_sigma_) * mu_eff_) * z;
  const double length = path_sigma_.norm(), expected = expected_length(n_);
  forgotten_ *= (1.0 - c_sigma_) * (1.0 - c_sigma_);
  const bool stalls =
      length / std::sqrt(1.0 - forgotten_) >= (1.4 + 2.0 / (static_cast<double>(n_) + 1.0)) * expected;
  path_c_ *= 1.0 - c_c_;
  if (!stalls) path_c_ += std::sqrt(c_c_ * (2.0 - c_c_) * mu_eff_) * y;
  const double lost = stalls ? c_1_ * c_c_ * (2.0 - c_c_) : 0.0;
  covariance_ =
      (1.0 - c_1_ - c_mu_ + lost) * covariance_ + c_1_ * path_c_ * path_c_.transpose() + c_mu_ * rank_mu;
  sigma_ =
      std::min(kLargestStep, sigma_ * config::exponential(c_sigma_ / damping() * (length / expected - 1.0)));
  const Eigen::LLT<MatrixXd> cholesky(covariance_);
  if (cholesky.info() == Eigen::Success) factor_ = cholesky.matrixL();
}

bool Evolution::has_converged() const {
  if (sigma_ * std::sqrt(covariance_.diagonal().maxCoeff()) < kClose) return true;
  const std::size_t patience = 10 + 30 * static_cast<std::size_t>(n_) / population_;
  return generation_ - best_at_ > patience;
}

}  // namespace visum::campaign
