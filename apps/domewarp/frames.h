// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "domewarp/convert/job.h"

namespace domewarp {

/// Frames of an animation, both included.
struct FrameRange {
  std::size_t first = 0, last = 0;
};

/// "A:B". @throws Error(usage) naming the option unless both are whole numbers and A <= B < 10^6
void parse_frames(const std::string& option, const std::string& text, FrameRange& frames);

/// The name of one frame: four digits before the extension, so frame 12 of DIR/out.glb is DIR/out.0012.glb whatever the
/// range.
std::string frame_path(const std::string& output, std::size_t frame);

/// Without a camera in the file the default view depends on where things are: it is fixed here to that of the rest pose,
/// so that the eye stands still while the scene moves.
void hold_view(const std::string& input, JobOptions& job);

} // namespace domewarp
