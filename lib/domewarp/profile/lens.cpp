// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "domewarp/profile/refuse.h"

namespace domewarp {

namespace {

// Half angles without cancellation on either side of 90 degrees.
double sin_half(double s, double c) { return c >= 0 ? s / std::sqrt(2 * (1 + c)) : std::sqrt(0.5 * (1 - c)); }
double tan_half(double s, double c) { return c >= 0 ? s / (1 + c) : (1 - c) / s; }

// theta cot(theta) is 0/0 on the axis; its series is exact to rounding where the quotients would cancel.
RadialJet equidistant_depth(double a, double theta, double s, double c) {
  const double x = theta * theta;
  if (x < 1e-4) {
    return {a * (1 - x / 3 - x * x / 45 - 2 * x * x * x / 945), -a * theta * (2.0 / 3 + 4 * x / 45 + 4 * x * x / 315),
            -a * (2.0 / 3 + 4 * x / 15 + 4 * x * x / 63)};
  }
  const double dz = (s * c - theta) / (s * s);
  return {a * theta * c / s, a * dz, 2 * a * (theta * c / s - 1) / (s * s)};
}

void check_fov(Lens lens, double fov_deg) {
  const double most = lens == Lens::orthographic ? 180 : 360;
  const bool open = lens == Lens::stereographic;
  if (fov_deg > 0 && (open ? fov_deg < most : fov_deg <= most)) return;
  const char* reason = open                         ? " (its radius is infinite straight behind)"
                       : lens == Lens::orthographic ? " (its radius falls again beyond 90 degrees off the axis)"
                                                    : "";
  refuse("--fov", std::string("the ") + to_string(lens) + " lens takes more than 0 and " +
                      (open ? "less than " : "at most ") + to_text(most) + " degrees" + reason + ", got " +
                      to_text(fov_deg));
}

} // namespace

const char* to_string(Lens lens) {
  switch (lens) {
  case Lens::equidistant: return "equidistant";
  case Lens::equisolid: return "equisolid";
  case Lens::stereographic: return "stereographic";
  default: return "orthographic";
  }
}

LensForm make_lens(Lens lens, double fov_deg) {
  check_fov(lens, fov_deg);
  LensForm form{lens, fov_deg * std::numbers::pi / 360, 1};
  form.scale =
      1 / radius(form, fov_deg == 180 ? 1 : std::sin(form.half_fov), fov_deg == 180 ? 0 : std::cos(form.half_fov));
  return form;
}

double radius(const LensForm& form, double s, double c) {
  switch (form.lens) {
  case Lens::equidistant: return form.scale * std::atan2(s, c);
  case Lens::equisolid: return form.scale * sin_half(s, c);
  case Lens::stereographic: return form.scale * tan_half(s, c);
  default: return form.scale * s;
  }
}

RadialJet radial(const LensForm& form, double theta) {
  const double a = form.scale, half = 0.5 * theta;
  switch (form.lens) {
  case Lens::equidistant: return {a * theta, a, 0};
  case Lens::equisolid: return {a * std::sin(half), 0.5 * a * std::cos(half), -0.25 * a * std::sin(half)};
  case Lens::stereographic: {
    const double t = std::tan(half), slope = 0.5 * (1 + t * t);
    return {a * t, a * slope, a * slope * t};
  }
  default: return {a * std::sin(theta), a * std::cos(theta), -a * std::sin(theta)};
  }
}

RadialJet depth(const LensForm& form, double theta) {
  const double a = form.scale, s = std::sin(theta), c = std::cos(theta), half = 0.5 * theta;
  switch (form.lens) {
  case Lens::equidistant: return equidistant_depth(a, theta, s, c);
  case Lens::equisolid: {
    const double u = std::cos(half), t = std::tan(half);
    const double z = 0.5 * a * c / u, dz = 0.5 * (-a * s / u + z * t);
    return {z, dz, 0.5 * (-a * (c + 0.5 * s * t) / u + dz * t + 0.5 * z * (1 + t * t))};
  }
  case Lens::stereographic: {
    const double t = std::tan(half), slope = 0.5 * (1 + t * t);
    return {0.5 * a * (1 - t * t), -a * t * slope, -a * slope * (slope + t * t)};
  }
  default: return {a * c, -a * s, -a * c};
  }
}

double angle(const LensForm& form, double r) {
  const double x = r / form.scale;
  switch (form.lens) {
  case Lens::equidistant: return x;
  case Lens::equisolid: return 2 * std::asin(std::min(x, 1.0));
  case Lens::stereographic: return 2 * std::atan(x);
  default: return std::asin(std::min(x, 1.0));
  }
}

} // namespace domewarp
