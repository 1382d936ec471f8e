// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace domewarp {

/// What the JSON of a glTF file says before any of its data is read.
struct FileSurvey {
  std::vector<std::filesystem::path> side_files; ///< buffers and images it refers to, in the order of the file; may be missing
  double file_bytes = 0;                         ///< of the file and its side files
  double decoded_bytes = 0;                      ///< of its accessors as 32-bit numbers
  double texture_pixels = 0;                     ///< of the images of base colours and glow that stand in files or a GLB
  double drawn_triangles = 0;                    ///< instances multiplied out, over all scenes of the file
};

/// Never throws: a file that cannot be understood gives what was understood of it, and read_scene says what is wrong.
/// Files that read_scene would refuse to open (outside the folder, unless `allow_external`) are not listed.
FileSurvey survey_file(const std::filesystem::path& path, bool allow_external);

} // namespace domewarp
