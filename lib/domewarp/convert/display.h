// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "domewarp/profile/surface.h"
#include "domewarp/scene/raster.h"
#include "domewarp/transform/image_map.h"

namespace domewarp {

/// A surface analysed for one shape of picture, and its map: all of a conversion that does not depend on the scene.
struct Display {
  Surface surface;
  ImageMap map;
};

/// @param points how many will be mapped, for Method::automatic
/// @throws Error(usage) when the surface cannot be used (see Surface)
Display make_display(const SurfaceOptions& options, const Raster& raster, Method method, std::size_t points = many_points);

/// Displays that many conversions share. Safe to use from several threads.
class DisplayCache {
public:
  /// The display for these options, made when it is asked for first; errors are those of `make_display`, each time.
  std::shared_ptr<const Display> find(const SurfaceOptions& options, const Raster& raster, Method method,
                                      std::size_t points);

private:
  struct Entry {
    std::mutex making;
    std::shared_ptr<const Display> display;
  };
  std::mutex guard_;
  std::map<std::string, std::shared_ptr<Entry>> entries_;
};

} // namespace domewarp
