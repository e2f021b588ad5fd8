// Minimises a function of numbers from (0, 1) by the CMA evolution strategy, a generation at a time. Hansen,
// The CMA Evolution Strategy: A Tutorial (arXiv:1604.00772), in the form of Krause, Arbones and Igel (CMA-ES
// with Optimal Covariance Update and Storage Complexity, NIPS 2016), which factors the covariance by
// Cholesky. Pure, any one thread; the same bits on every processor. Libraries that we know draw from
// std::normal_distribution and the C library's logarithm, whose bits differ, and try one point at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace visum::campaign {

class Evolution {
 public:
  using Point = std::vector<double>;

  // `step`: how far from `start` the first points lie, as a standard deviation. `population`: of a
  // generation, at least 4; 0: the tutorial's.
  Evolution(const Point& start, double step, std::size_t population, std::uint64_t seed);

  // The points of the next generation.
  std::vector<Point> ask();
  // Takes the function at these points, in their order. Infinite values rank as any other; no NaN.
  void tell(const std::vector<double>& values);
  // Its points lie closer together than matters, or it found nothing better for long.
  bool has_converged() const;
  std::size_t population() const { return population_; }

 private:
  void adapt(const std::vector<std::size_t>& best);
  double damping() const;

  const Eigen::Index n_;
  const std::size_t population_;
  const std::uint64_t seed_;
  Eigen::VectorXd weights_;  // of the better half, the best first; their sum is 1
  double mu_eff_ = 1.0;      // variance effective selection mass
  double c_sigma_ = 0.0, c_c_ = 0.0, c_1_ = 0.0, c_mu_ = 0.0;
  Eigen::VectorXd mean_, path_sigma_, path_c_;
  Eigen::MatrixXd covariance_, factor_;  // C = A A^T
  double sigma_ = 0.1;
  Eigen::MatrixXd drawn_;   // z of each point, a column for each
  double forgotten_ = 1.0;  // (1 - c_sigma)^(2 g)
  std::size_t generation_ = 0;
  double best_ = 0.0;        // of all generations
  std::size_t best_at_ = 0;  // generation
};

}  // namespace visum::campaign
