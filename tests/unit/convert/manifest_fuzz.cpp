// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: whatever the bytes, parse_manifest gives a manifest or throws Error, and so do the options in it. Options
// that would open a file are left out.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "domewarp/convert/manifest.h"
#include "domewarp/core/errors.h"
#include "job_arguments.h"

namespace {

void parse_options(const std::vector<domewarp::ManifestOption>& options) {
  std::vector<domewarp::JobArgument> arguments;
  for (const domewarp::ManifestOption& option : options) {
    if (option.name == "profile" || option.kind == domewarp::ManifestOption::Kind::off) continue;
    const bool is_flag = option.kind == domewarp::ManifestOption::Kind::on;
    arguments.push_back({option.name, is_flag ? std::nullopt : std::optional(option.value), "here"});
  }
  try {
    domewarp::parse_arguments(arguments);
  } catch (const domewarp::Error&) {
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const domewarp::Manifest manifest = domewarp::parse_manifest({reinterpret_cast<const char*>(data), size}, "manifest");
    parse_options(manifest.defaults);
    for (const domewarp::ManifestScene& scene : manifest.scenes) parse_options(scene.options);
  } catch (const domewarp::Error&) {
  }
  return 0;
}
