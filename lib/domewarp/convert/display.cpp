// SPDX-License-Identifier: Apache-2.0
#include "domewarp/convert/display.h"

#include <string>

#include "domewarp/convert/record.h"
#include "domewarp/scene/view.h"

namespace domewarp {

Display make_display(const SurfaceOptions& options, const Raster& raster, Method method, std::size_t points) {
  Surface surface(options, screen_radius(raster));
  ImageMap map = make_image_map(surface, method, points);
  return {std::move(surface), std::move(map)};
}

std::shared_ptr<const Display> DisplayCache::find(const SurfaceOptions& options, const Raster& raster, Method method,
                                                  std::size_t points) {
  const bool few = points < table_pays_from;
  const std::string key = to_json(options) + std::to_string(raster.width) + "x" + std::to_string(raster.height) +
                          std::to_string(static_cast<int>(method)) + (few ? " few" : "");
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(guard_);
    std::shared_ptr<Entry>& found = entries_[key];
    if (!found) found = std::make_shared<Entry>();
    entry = found;
  }
  const std::lock_guard lock(entry->making);
  if (!entry->display) entry->display = std::make_shared<const Display>(make_display(options, raster, method, points));
  return entry->display;
}

} // namespace domewarp
