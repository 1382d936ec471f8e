// SPDX-License-Identifier: Apache-2.0
#include "domewarp/profile/quad.h"

#include <limits>
#include <string>

#include <locale.h> // NOLINT(modernize-deprecated-headers): locale_t of POSIX

// glibc's functions of _Float128, which Clang's C++ does not see in <math.h>.
extern "C" {
domewarp::Float128 sqrtf128(domewarp::Float128) noexcept;
domewarp::Float128 expf128(domewarp::Float128) noexcept;
domewarp::Float128 logf128(domewarp::Float128) noexcept;
domewarp::Float128 log10f128(domewarp::Float128) noexcept;
domewarp::Float128 sinf128(domewarp::Float128) noexcept;
domewarp::Float128 cosf128(domewarp::Float128) noexcept;
domewarp::Float128 tanf128(domewarp::Float128) noexcept;
domewarp::Float128 asinf128(domewarp::Float128) noexcept;
domewarp::Float128 acosf128(domewarp::Float128) noexcept;
domewarp::Float128 atanf128(domewarp::Float128) noexcept;
domewarp::Float128 sinhf128(domewarp::Float128) noexcept;
domewarp::Float128 coshf128(domewarp::Float128) noexcept;
domewarp::Float128 tanhf128(domewarp::Float128) noexcept;
domewarp::Float128 powf128(domewarp::Float128, domewarp::Float128) noexcept;
domewarp::Float128 atan2f128(domewarp::Float128, domewarp::Float128) noexcept;
domewarp::Float128 strtof128_l(const char*, char**, locale_t) noexcept;
}

namespace domewarp {

bool isfinite(const Quad& a) { return a.value - a.value == 0; }

Quad power(const Quad& a, int exponent) { return Quad(powf128(a.value, exponent)); }
Quad power(const Quad& a, const Quad& b) {
  return a.value < 0 ? Quad(std::numeric_limits<double>::quiet_NaN()) : Quad(powf128(a.value, b.value));
}
Quad sqrt(const Quad& a) { return Quad(sqrtf128(a.value)); }
Quad exp(const Quad& a) { return Quad(expf128(a.value)); }
Quad log(const Quad& a) { return Quad(logf128(a.value)); }
Quad log10(const Quad& a) { return Quad(log10f128(a.value)); }
Quad sin(const Quad& a) { return Quad(sinf128(a.value)); }
Quad cos(const Quad& a) { return Quad(cosf128(a.value)); }
Quad tan(const Quad& a) { return Quad(tanf128(a.value)); }
Quad cot(const Quad& a) { return Quad(1 / tanf128(a.value)); }
Quad asin(const Quad& a) { return Quad(asinf128(a.value)); }
Quad acos(const Quad& a) { return Quad(acosf128(a.value)); }
Quad atan(const Quad& a) { return Quad(atanf128(a.value)); }
Quad atan2(const Quad& y, const Quad& x) { return Quad(atan2f128(y.value, x.value)); }
Quad sinh(const Quad& a) { return Quad(sinhf128(a.value)); }
Quad cosh(const Quad& a) { return Quad(coshf128(a.value)); }
Quad tanh(const Quad& a) { return Quad(tanhf128(a.value)); }

Quad quad_pi() {
  static const Quad pi = acos(Quad(-1));
  return pi;
}

Quad quad_e() {
  static const Quad e = exp(Quad(1));
  return e;
}

Quad parse_quad(std::string_view text) {
  static const locale_t classic = newlocale(LC_ALL_MASK, "C", nullptr);
  return Quad(strtof128_l(std::string(text).c_str(), nullptr, classic));
}

} // namespace domewarp
