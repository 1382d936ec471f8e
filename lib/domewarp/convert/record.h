// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "domewarp/convert/convert.h"

namespace domewarp {

/// What a written file says of itself in asset.extras.domewarp: enough to draw the same picture again from the original
/// scene. Holds nothing that differs from run to run.
struct Record {
  std::string version;
  View view;
  SurfaceOptions surface;
  Raster raster;
  Projection projection = Projection::perspective;
  double tolerance_px = 0;
  double near = 0;
  bool unlit = false;
  bool baked = false;            ///< light in the colours; with shadows, exposure in stops:
  bool shadows = false;
  double exposure = 0;
  double error_px = 0;           ///< certified; nan when nothing bounds it
  double depth_error = 0;        ///< certified, relative: how far interpolated depths are off; the default tolerance
                                 ///< when the file does not say or nothing bounds it
  std::size_t triangles_in = 0, triangles_out = 0, vertices = 0;
};

Record make_record(const ConvertOptions& options, const ConvertReport& report);

/// JSON text; numbers survive to the last bit.
std::string to_json(const Record& record);

/// The surface alone, as in `Record::surface`.
std::string to_json(const SurfaceOptions& surface);

/// @param name of the file, for messages
/// @throws Error(input) when the text is empty, no JSON, or lacks what a picture needs
Record parse_record(const std::string& text, const std::string& name);

} // namespace domewarp
