// SPDX-License-Identifier: Apache-2.0
//
// All three searches walk over [0, end] from left to right and halve a cell until the enclosures over it decide.
#include "domewarp/profile/analysis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "domewarp/profile/refuse.h"
#include "domewarp/profile/root.h"

namespace domewarp {

namespace {

constexpr std::size_t feature_limit = 1024;

[[noreturn]] void refuse_irregular(const Curve& curve) {
  refuse(curve.measured ? "--profile" : "--curve",
         "too irregular to be analysed: it wiggles too fast or runs along a view ray");
}

// Cells still to be looked at, leftmost on top. Counts them, so that no curve takes for ever.
class Cells {
public:
  Cells(const Curve& curve, double end) : curve_(curve) {
    const std::size_t operations = std::max<std::size_t>(curve.expression.code.size(), 1);
    budget_ = 1000 + 4 * curve.joints.size() + 4000000 / (operations + 20);
    double high = end;
    for (auto joint = curve.joints.rbegin(); joint != curve.joints.rend(); ++joint) {
      if (*joint >= end) continue;
      cells_.push_back({*joint, high});
      high = *joint;
    }
    cells_.push_back({0, high});
  }

  bool empty() const { return cells_.empty(); }

  Interval take() {
    if (budget_-- == 0) refuse_irregular(curve_);
    const Interval cell = cells_.back();
    cells_.pop_back();
    return cell;
  }

  void split(const Interval& cell) {
    const double middle = cell.lo + 0.5 * (cell.hi - cell.lo);
    cells_.push_back({middle, cell.hi});
    cells_.push_back({cell.lo, middle});
  }

private:
  const Curve& curve_;
  std::vector<Interval> cells_;
  std::size_t budget_ = 0;
};

bool is_narrow(const Interval& cell, double end) { return cell.hi - cell.lo <= 4e-16 * std::max(cell.hi, 1e-3 * end); }

// Whether single values say that f runs on through a cell of a few ulp that enclosures cannot decide.
bool runs_through(const Curve& curve, const Interval& cell) {
  const double lo = evaluate(curve, cell.lo), hi = evaluate(curve, cell.hi);
  return std::abs(hi - lo) <= 1e-6 * (1 + std::abs(lo));
}

// The last point of a narrow cell at which f is finite and near its value at the cell's start.
double last_defined(const Curve& curve, const Interval& cell) {
  double good = cell.lo, bad = cell.hi;
  for (double r = middle_of(good, bad); r > good && r < bad; r = middle_of(good, bad))
    (runs_through(curve, {cell.lo, r}) ? good : bad) = r;
  return good;
}

double fold_function(const Curve& curve, double r, double offset) {
  const Jet<double> f = differentiate(curve, r);
  return f.v - jet_rules::times(r, f.d) + offset;
}

Interval enclose_fold_function(const Jet<Interval>& f, const Interval& cell, double offset) {
  return f.v - cell * f.d + Interval(offset);
}

// -1, +1, or 0 when the sign of h + offset over the cell is not certain. The mean value form is sharp on small cells.
int certain_sign(const Curve& curve, const Interval& cell, const Jet<Interval>& f, double offset) {
  Interval h = enclose_fold_function(f, cell, offset);
  if (contains(h, 0) && is_bounded(f.dd)) {
    const Interval middle(cell.lo + 0.5 * (cell.hi - cell.lo));
    const Interval at_middle = enclose_fold_function(enclose_jet(curve, middle), middle, offset);
    h = intersect(h, at_middle - cell * f.dd * (cell - middle));
  }
  return h.lo > 0 ? 1 : h.hi < 0 ? -1 : 0;
}

struct SignedCell {
  Interval cell;
  int sign;
};

// A cell on which h is certainly monotone need not be split: its neighbours' signs tell whether it holds a fold.
bool is_monotone(const Jet<Interval>& f) { return is_bounded(f.dd) && !contains(f.dd, 0); }

std::vector<SignedCell> collect_signs(const Curve& curve, double end, double offset) {
  std::vector<SignedCell> known;
  Cells cells(curve, end);
  const auto record = [&](const Interval& cell, int sign) {
    if (!known.empty() && known.back().sign == sign)
      known.back().cell.hi = cell.hi;
    else
      known.push_back({cell, sign});
  };
  while (!cells.empty()) {
    const Interval cell = cells.take();
    const Jet<Interval> f = enclose_jet(curve, cell);
    const int sign = certain_sign(curve, cell, f, offset);
    if (sign != 0) {
      record(cell, sign);
    } else if (is_monotone(f) && is_bounded(f.d)) {
      const double low = fold_function(curve, cell.lo, offset), high = fold_function(curve, cell.hi, offset);
      if (low != 0) record({cell.lo, cell.lo}, low > 0 ? 1 : -1);
      if (high != 0) record({cell.hi, cell.hi}, high > 0 ? 1 : -1);
    } else if (cell.hi - cell.lo > 1e-9 * end) {
      cells.split(cell);
    }
    if (known.size() > feature_limit) refuse_irregular(curve);
  }
  return known;
}

double bisect_sign(const Curve& curve, double lo, double hi, int sign_at_lo, double offset) {
  for (;;) {
    const double middle = lo + 0.5 * (hi - lo);
    if (middle <= lo || middle >= hi) return lo;
    const double value = fold_function(curve, middle, offset);
    (sign_at_lo > 0 ? value > 0 : value < 0) ? lo = middle : hi = middle;
  }
}

} // namespace

double fold_function(const Curve& curve, double r) { return fold_function(curve, r, 0); }

double find_domain_end(const Curve& curve, double limit) {
  const double end = curve.measured ? std::min(limit, curve.measured->r.back()) : limit;
  Cells cells(curve, end);
  while (!cells.empty()) {
    const Interval cell = cells.take();
    const Interval f = enclose_jet(curve, cell).v;
    if (f.regularity != Regularity::unknown && is_bounded(f)) continue;
    if (!is_narrow(cell, end)) {
      cells.split(cell);
    } else if (!runs_through(curve, cell)) {
      return last_defined(curve, cell);
    }
  }
  return end;
}

std::vector<double> find_kinks(const Curve& curve, double end) {
  const double same = 1e-12 * end;
  std::vector<double> kinks;
  double last_high = -1;
  Cells cells(curve, end);
  while (!cells.empty()) {
    const Interval cell = cells.take();
    if (enclose_jet(curve, cell).v.regularity == Regularity::smooth) continue;
    if (!is_narrow(cell, end)) {
      cells.split(cell);
      continue;
    }
    if (last_high < 0 || cell.lo - last_high > same) kinks.push_back(cell.hi);
    last_high = cell.hi;
    if (kinks.size() > feature_limit) refuse_irregular(curve);
  }
  if (curve.measured) kinks.insert(kinks.end(), curve.joints.begin(), curve.joints.end());
  std::sort(kinks.begin(), kinks.end());
  std::erase_if(kinks, [&](double r) { return r <= same || r >= end - same; });
  return kinks;
}

std::vector<double> find_folds(const Curve& curve, double end, double offset) {
  const std::vector<SignedCell> known = collect_signs(curve, end, offset);
  std::vector<double> folds;
  for (std::size_t i = 1; i < known.size(); ++i)
    folds.push_back(bisect_sign(curve, known[i - 1].cell.hi, known[i].cell.lo, known[i - 1].sign, offset));
  return folds;
}

} // namespace domewarp
