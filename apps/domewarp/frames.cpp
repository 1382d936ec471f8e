// SPDX-License-Identifier: Apache-2.0
#include "frames.h"

#include <filesystem>

#include "domewarp/core/errors.h"
#include "options.h"

namespace domewarp {

void parse_frames(const std::string& option, const std::string& text, FrameRange& frames) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw Error(ErrorCode::usage, option + ": needs FIRST:LAST, got '" + text + "'");
  frames.first = parse_count(option, text.substr(0, colon));
  frames.last = parse_count(option, text.substr(colon + 1));
  if (frames.first > frames.last || frames.last >= 1'000'000)
    throw Error(ErrorCode::usage, option + ": needs FIRST <= LAST < 1000000, got '" + text + "'");
}

std::string frame_path(const std::string& output, std::size_t frame) {
  std::string number = std::to_string(frame);
  number.insert(0, number.size() < 4 ? 4 - number.size() : 0, '0');
  const std::filesystem::path path(output);
  return (path.parent_path() / (path.stem().string() + "." + number + path.extension().string())).string();
}

void hold_view(const std::string& input, JobOptions& job) {
  ViewOptions& view = job.convert.view;
  if (view.eye || !view.camera.empty()) return;
  ReadOptions rest = job.read;
  rest.animation.clear();
  rest.time = 0;
  const Scene scene = read_scene(input, rest);
  if (!scene.cameras.empty()) return;
  const View held = resolve_view(scene, view);
  view = {.eye = held.eye, .target = {}, .forward = -held.back, .up = held.up, .camera = {}};
}

} // namespace domewarp
