// SPDX-License-Identifier: Apache-2.0
#include "domewarp/scene/test_scenes.h"

#include "domewarp/scene/test_scenes/scenes.h"

namespace domewarp {

std::vector<TestScene> make_test_scenes() {
  std::vector<TestScene> scenes;
  scenes.push_back({"cubes", test_scenes::make_cubes()});
  scenes.push_back({"pool", test_scenes::make_pool()});
  scenes.push_back({"hardware", test_scenes::make_hardware()});
  scenes.push_back({"toys", test_scenes::make_toys()});
  scenes.push_back({"biology", test_scenes::make_biology()});
  for (TestScene& test : scenes) test.scene.name = test.name;
  return scenes;
}

} // namespace domewarp
