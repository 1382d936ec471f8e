// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/facts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "domewarp/core/errors.h"
#include "domewarp/profile/analysis.h"

namespace domewarp {

namespace {

constexpr double pi = std::numbers::pi;

// Six significant digits, enough for people.
std::string brief(double value) {
  std::array<char, 32> text{};
  const double unsigned_zero = value == 0 ? 0 : value;
  const auto format = std::chars_format::general;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), unsigned_zero, format, 6).ptr;
  return {text.data(), end};
}

std::string degrees(double radians) { return brief(radians * 180 / pi); }

std::string describe_end(const Surface& surface) {
  const SurfaceRim rim = surface.rim();
  const std::string place = "r = " + brief(rim.point.x);
  if (!surface.options().profile.empty()) return "the measured rows end at " + place;
  const bool vertical = rim.tangent.x == 0 && rim.tangent.y != 0;
  return "f(r) is not defined, or jumps, beyond " + place + (vertical ? ", where its tangent is vertical" : "");
}

} // namespace

std::string name_of(const Surface& surface) {
  const SurfaceOptions& options = surface.options();
  std::string name = "profile " + options.profile_name;
  if (options.lens) name = std::string(to_string(*options.lens)) + " lens, " + brief(options.fov_deg) + " degrees";
  if (!options.curve.empty()) name = "z = " + options.curve;
  if (options.projector) name += ", projector at " + brief(*options.projector);
  return name;
}

Vec2 visible_range(const Surface& surface) {
  Vec2 range(pi, 0);
  for (const Branch& branch : surface.branches())
    range = {std::min(range.x, branch.theta_low), std::max(range.y, branch.theta_high)};
  return range;
}

double field_of_view(const Surface& surface) {
  const Vec2 range = visible_range(surface);
  return 2 * (range.x == 0 ? range.y : pi - range.x);
}

Domain find_domain(const Surface& surface) {
  const SurfaceOptions& options = surface.options();
  if (options.lens) return {surface.rim().point.x, surface.rim().point.x};
  constexpr double reach = 16;
  Domain domain{0, reach * surface.rim().point.x};
  try {
    const Curve curve =
        options.profile.empty() ? make_curve(options.curve) : make_curve(options.profile, options.profile_name);
    domain.end = find_domain_end(curve, domain.searched_to);
  } catch (const Error&) { // too irregular out there
    domain = {surface.rim().point.x, surface.rim().point.x};
  }
  return domain;
}

std::string explain_r_max(const Surface& surface) {
  const std::string at = degrees(visible_range(surface).y);
  switch (surface.r_max_limit()) {
  case RadiusLimit::user: return "that is the --rmax given";
  case RadiusLimit::screen: return "the picture's corners lie there";
  case RadiusLimit::domain: return describe_end(surface);
  case RadiusLimit::fold: return "the view angle turns there, at " + at + " degrees, and --branch first stops at a turn";
  case RadiusLimit::projector: return "the projector's light reaches no further: " + explain_projector(surface);
  default: return "half the lens's field of view, " + degrees(0.5 * field_of_view(surface)) + " degrees, falls there";
  }
}

std::string explain_projector(const Surface& surface) {
  if (!surface.options().projector) return "";
  if (std::isfinite(surface.hidden_from()))
    return "its rays touch the surface at r = " + brief(surface.hidden_from()) + " and what lies further out is hidden";
  if (surface.r_max_limit() == RadiusLimit::projector)
    return "however far the surface goes on, it appears within this radius";
  return "it lights all of the visible part, out to r = " + brief(surface.rim().point.x) + ", z = " +
         brief(surface.rim().point.y);
}

namespace {

std::string describe(const Branch& branch) {
  return "theta " + degrees(branch.theta_low) + " to " + degrees(branch.theta_high) + " degrees on image radius " +
         brief(branch.radius_low) + " to " + brief(branch.radius_high) + (branch.orientation < 0 ? ", mirrored" : "");
}

std::string describe_blind(const Surface& surface) {
  const BlindCone blind = surface.blind();
  if (blind.theta_low < blind.theta_high)
    return "theta " + degrees(blind.theta_low) + " to " + degrees(blind.theta_high) + " degrees";
  const auto reaches_behind = [](const Branch& branch) { return branch.theta_high >= std::numbers::pi; };
  return std::ranges::any_of(surface.branches(), reaches_behind) ? "no direction" : "straight behind only";
}

std::string describe(const Kink& kink) {
  return std::string(to_string(kink.kind)) + " at r = " + brief(kink.r) + ", theta " + degrees(kink.theta) + " degrees";
}

} // namespace

std::vector<std::string> summarise(const Surface& surface) {
  std::vector<std::string> lines{
      "r_max " + brief(surface.r_max()) + ": " + explain_r_max(surface),
      "field of view " + degrees(field_of_view(surface)) + " degrees" +
          (visible_range(surface).x > 0 ? " around the backward axis" : ""),
  };
  for (std::size_t i = 0; i < surface.branches().size(); ++i)
    lines.push_back("branch " + std::to_string(i + 1) + ": " + describe(surface.branches()[i]));
  lines.push_back("blind: " + describe_blind(surface));
  std::size_t joints = 0;
  for (const Kink& kink : surface.kinks()) {
    if (kink.kind != KinkKind::joint) lines.push_back(describe(kink));
    joints += kink.kind == KinkKind::joint;
  }
  if (joints > 0) lines.push_back(std::to_string(joints) + " joints of the measured profile");
  if (const std::string projector = explain_projector(surface); !projector.empty())
    lines.push_back("projector: " + projector);
  return lines;
}

} // namespace domewarp
