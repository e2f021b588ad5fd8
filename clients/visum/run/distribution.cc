#include "clients/visum/run/distribution.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "clients/visum/common/format.h"
#include "protocol/config/exp_log.h"

namespace visum::run {
namespace {

using config::Node;

constexpr double kMostWhole = 9007199254740992.0;  // 2^53: up to here every whole number is a double

// The polynomials of AS 241, lowest power first: in the middle, in the tails, far out.
constexpr double kA[] = {3.3871328727963666080e0,  1.3314166789178437745e+2, 1.9715909503065514427e+3,
                         1.3731693765509461125e+4, 4.5921953931549871457e+4, 6.7265770927008700853e+4,
                         3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr double kB[] = {1.0,
                         4.2313330701600911252e+1,
                         6.8718700749205790830e+2,
                         5.3941960214247511077e+3,
                         2.1213794301586595867e+4,
                         3.9307895800092710610e+4,
                         2.8729085735721942674e+4,
                         5.2264952788528545610e+3};
constexpr double kC[] = {1.42343711074968357734e0,  4.63033784615654529590e0, 5.76949722146069140550e0,
                         3.64784832476320460504e0,  1.27045825245236838258e0, 2.41780725177450611770e-1,
                         2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr double kD[] = {1.0,
                         2.05319162663775882187e0,
                         1.67638483018380384940e0,
                         6.89767334985100004550e-1,
                         1.48103976427480074590e-1,
                         1.51986665636164571966e-2,
                         5.47593808499534494600e-4,
                         1.05075007164441684324e-9};
constexpr double kE[] = {6.65790464350110377720e0,  5.46378491116411436990e0,  1.78482653991729133580e0,
                         2.96560571828504891230e-1, 2.65321895265761230930e-2, 1.24266094738807843860e-3,
                         2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr double kF[] = {1.0,
                         5.99832206555887937690e-1,
                         1.36929880922735805310e-1,
                         1.48753612908506148525e-2,
                         7.86869131145613259100e-4,
                         1.84631831751005468180e-5,
                         1.42151175831644588870e-7,
                         2.04426310338993978564e-15};

double polynomial(std::span<const double> terms, double x) {
  double sum = 0.0;
  for (std::size_t i = terms.size(); i-- > 0;) sum = sum * x + terms[i];
  return sum;
}

// The share of a standard normal distribution below z: the quantile turned round. normal_quantile() grows
// with each bit of the share, so halving finds it to the last bits.
double normal_share(double z) {
  double low = 1e-300, high = 1.0 - 0x1p-53;
  for (int i = 0; i < 1100 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (normal_quantile(middle) < z ? low : high) = middle;
  }
  return high;
}

std::pair<double, double> read_ends(const Node& node) {
  const auto ends = node.numbers(2);
  if (ends[0] >= ends[1]) node.fail("the first must be less than the second");
  return {ends[0], ends[1]};
}

}  // namespace

double normal_quantile(double share) {
  const double q = share - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(kA, r) / polynomial(kB, r);
  }
  const double r = std::sqrt(-config::logarithm(q < 0.0 ? share : 1.0 - share));
  const double size = r <= 5.0 ? polynomial(kC, r - 1.6) / polynomial(kD, r - 1.6)
                               : polynomial(kE, r - 5.0) / polynomial(kF, r - 5.0);
  return q < 0.0 ? -size : size;
}

std::optional<Distribution> Distribution::read(const Node& node) {
  Distribution result;
  if (const auto uniform = node.find("uniform")) {
    node.allow_only({"uniform"});
    std::tie(result.first_, result.second_) = read_ends(*uniform);
  } else if (const auto log_uniform = node.find("log_uniform")) {
    node.allow_only({"log_uniform"});
    const auto [least, most] = read_ends(*log_uniform);
    if (least < 1e-300) log_uniform->fail("both must be greater than 0");
    result.kind_ = Kind::kLogUniform;
    result.first_ = config::logarithm(least);
    result.second_ = config::logarithm(most);
  } else if (const auto normal = node.find("normal")) {
    node.allow_only({"normal", "between"});
    const auto given = normal->numbers(2);
    if (given[1] <= 0.0) normal->fail("the second is the standard deviation, and must be greater than 0");
    result.kind_ = Kind::kNormal;
    result.first_ = given[0];
    result.second_ = given[1];
    if (const auto between = node.find("between")) {
      const auto [least, most] = read_ends(*between);
      result.lowest_ = normal_share((least - given[0]) / given[1]);
      result.highest_ = normal_share((most - given[0]) / given[1]);
      if (!(result.highest_ - result.lowest_ > 1e-9))
        between->fail("less than a billionth of the distribution lies there");
    }
  } else if (const auto integers = node.find("integers")) {
    node.allow_only({"integers"});
    const auto [least, most] = read_ends(*integers);
    if (least != std::floor(least) || most != std::floor(most) || std::abs(least) > kMostWhole ||
        std::abs(most) > kMostWhole)
      integers->fail("must be whole numbers of at most 2^53");
    result.kind_ = Kind::kIntegers;
    result.first_ = least;
    result.second_ = most;
  } else {
    return std::nullopt;
  }
  return result;
}

std::string Distribution::value(double share) const {
  switch (kind_) {
    case Kind::kUniform:
      return cli::exact(first_ + share * (second_ - first_));
    case Kind::kLogUniform:
      return cli::exact(config::exponential(first_ + share * (second_ - first_)));
    case Kind::kNormal:
      return cli::exact(first_ + second_ * normal_quantile(lowest_ + share * (highest_ - lowest_)));
    case Kind::kIntegers:
      break;
  }
  return cli::exact(std::min(first_ + std::floor(share * (second_ - first_ + 1.0)), second_));
}

}  // namespace visum::run
