// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "domewarp/render/frame.h"

namespace domewarp {

/// A picture that is written row by row, so that it need not fit into memory: PNG (8-bit sRGB, straight alpha), or
/// OpenEXR with every layer of the frames: R, G, B, A (half, linear, multiplied by alpha), Z (distance from the eye),
/// P.X, P.Y, P.Z (position) and N.X, N.Y, N.Z (normal) in eye space, UV.U, UV.V, objectId and triangleId (0 where
/// nothing is). Written under a temporary name; nothing is left behind unless `finish` was reached.
class PictureFile {
 public:
  /// @throws Error(usage) when the name ends neither in .png nor in .exr, Error(output) when it cannot be written
  PictureFile(const std::filesystem::path& path, int width, int height);
  ~PictureFile();
  PictureFile(const PictureFile&) = delete;
  PictureFile& operator=(const PictureFile&) = delete;

  /// The next rows from the top. @throws Error(output)
  void write(const Frame& rows);

  /// Gives the file its name; all rows must have been written. @throws Error(output)
  void finish();

 private:
  struct Writer;
  struct PngWriter;
  struct ExrWriter;
  std::filesystem::path path_, temporary_;
  std::unique_ptr<Writer> writer_;
  bool finished_ = false;
};

/// Layers that a file of this name can hold.
Layers layers_for(const std::filesystem::path& path);

} // namespace domewarp
