// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "domewarp/scene/scene.h"
#include "domewarp/scene/test_scenes/pictures.h"
#include "domewarp/scene/test_scenes/shape.h"

namespace domewarp::test_scenes {

/// Linear colour of 0xRRGGBB in sRGB.
Vec3 linear(std::uint32_t hex);

/// Packs the picture as PNG and repeats it in both directions. @return the texture's index
int add_texture(Scene& scene, const std::string& name, const Picture& picture);

/// Appends a material and writes its glTF text from the other fields. @return its index
int add_material(Scene& scene, Material material);
int add_plain(Scene& scene, const std::string& name, std::uint32_t color, double roughness, double metallic = 0);
int add_textured(Scene& scene, const std::string& name, const Picture& picture, double roughness, double metallic = 0);
int add_unlit(Scene& scene, const std::string& name, const Picture& picture);
/// What the picture's alpha leaves of a double-sided sheet.
int add_cutout(Scene& scene, const std::string& name, const Picture& picture, double roughness);
int add_glowing(Scene& scene, const std::string& name, std::uint32_t color);

/// Texture coordinates that no material reads are left out. @return the mesh's index
int add_mesh(Scene& scene, const std::string& name, Shape shape, const ColorAt& color = {});
void add_instance(Scene& scene, const std::string& name, int mesh, const Mat4& world);
/// A mesh drawn once.
void add_object(Scene& scene, const std::string& name, const Shape& shape, const Mat4& world = Mat4(1),
                const ColorAt& color = {});

/// A perspective camera at `eye` that looks at `target`, y up.
void add_camera(Scene& scene, const std::string& name, const Vec3& eye, const Vec3& target, double yfov_degrees);
void add_point_light(Scene& scene, const std::string& name, const Vec3& position, std::uint32_t color, double candela);
void add_sun(Scene& scene, const std::string& name, const Vec3& from, std::uint32_t color, double lux);
void add_spot(Scene& scene, const std::string& name, const Vec3& position, const Vec3& target, std::uint32_t color,
              double candela);

} // namespace domewarp::test_scenes
