// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/gl_shaders.h"

namespace domewarp {

const char* const vertex_shader_source = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 source;
layout(location = 2) in vec3 normal;
layout(location = 3) in vec4 colour;
layout(location = 4) in vec4 uv;
uniform mat4 projection;  // camera space to the clip space of the picture
uniform vec2 picture;     // its size, samples
uniform vec4 window;      // left, bottom, width, height of the part of it that clips, samples
uniform float subpixels;  // per sample, of the driver's grid
out vec4 point_source;
out vec3 point_normal;
out vec4 point_colour;
out vec4 point_uv;
out float point_depth;    // in front of the camera

// A driver rounds vertices to its grid after it has added the window's corner in float32, so that a vertex may fall on
// different points in two tiles. Rounded in the picture before, it cannot.
vec2 on_grid(vec2 ndc) {
  return round((0.5 * ndc + 0.5) * picture * subpixels) / subpixels;
}

void main() {
  vec4 clip = projection * vec4(position, 1.0);
  vec2 at = clip.xy / clip.w;
  if (clip.w > 0.0 && all(lessThan(abs(at), vec2(8.0))))
    clip.xy = (2.0 * (on_grid(at) - window.xy) / window.zw - 1.0) * clip.w;
  else
    clip.xy = (clip.xy * picture + (picture - 2.0 * window.xy - window.zw) * clip.w) / window.zw;
  gl_Position = clip;
  point_source = source;
  point_normal = normal;
  point_colour = colour;
  point_uv = uv;
  point_depth = -position.z;
}
)";

// Texels are fetched and mixed here rather than by the texture unit, which may have as few as 8 bits for the weights.
const char* const fragment_shader_source = R"(#version 450 core
in vec4 point_source;
in vec3 point_normal;
in vec4 point_colour;
in vec4 point_uv;
in float point_depth;
layout(location = 0) out vec4 out_colour;
layout(location = 1) out vec4 out_source;  // w: the depth, 0 without source positions
layout(location = 2) out uvec2 out_ids;
layout(location = 3) out vec4 out_normal;
layout(location = 4) out vec2 out_uv;

const int wrap_repeat = 0, wrap_clamp = 1, wrap_mirror = 2;
const int alpha_opaque = 0, alpha_mask = 1, alpha_blend = 2;

uniform sampler2D base_map, glow_map;
uniform ivec4 base_use, glow_use;  // present, wrap_s, wrap_t, nearest
uniform vec3 emissive;
uniform int alpha_mode;
uniform float alpha_cutoff;
uniform bool unlit;
uniform int first_triangle;        // of this draw, in ids
uniform int light_count;           // -1: one light at the eye
uniform float exposure;
uniform bool parallel_view;        // without source positions, all is seen along -z

layout(std430, binding = 0) readonly buffer Triangles { uvec2 ids[]; };

struct Light {
  vec4 position;   // w: kind
  vec4 direction;  // w: range
  vec4 strength;   // w: cone scale
  vec4 cone;       // x: cone offset
};
const int light_directional = 0, light_point = 1, light_spot = 2;
layout(std430, binding = 1) readonly buffer Lights { Light lights[]; };

float reduce(float u, int wrap) {
  if (isnan(u) || isinf(u)) return 0.0;
  if (wrap == wrap_repeat) return u - floor(u);
  if (wrap == wrap_mirror) return u - 2.0 * floor(u / 2.0);
  return clamp(u, 0.0, 1.0);
}

int wrap_texel(int i, int n, int wrap) {
  if (wrap == wrap_repeat) return (i + n) % n;
  if (wrap == wrap_clamp) return clamp(i, 0, n - 1);
  i = (i + 2 * n) % (2 * n);
  return i < n ? i : 2 * n - 1 - i;
}

vec4 texel(sampler2D map, int x, int y, ivec2 size, ivec4 use) {
  return texelFetch(map, ivec2(wrap_texel(x, size.x, use.y), wrap_texel(y, size.y, use.z)), 0);
}

vec4 read_texture(sampler2D map, vec2 uv, ivec4 use) {
  if (use.x == 0) return vec4(1.0);
  ivec2 size = textureSize(map, 0);
  vec2 at = vec2(reduce(uv.x, use.y), reduce(uv.y, use.z)) * vec2(size);
  if (use.w != 0) return texel(map, int(at.x), int(at.y), size, use);
  vec2 corner = floor(at - 0.5);
  vec2 part = at - 0.5 - corner;
  ivec2 i = ivec2(corner);
  vec4 top = mix(texel(map, i.x, i.y, size, use), texel(map, i.x + 1, i.y, size, use), part.x);
  vec4 bottom = mix(texel(map, i.x, i.y + 1, size, use), texel(map, i.x + 1, i.y + 1, size, use), part.x);
  return mix(top, bottom, part.y);
}

float head_light(vec3 n, vec3 p) {
  float scale = length(n) * length(p);
  if (!(scale > 0.0)) return 1.0;
  return 0.35 + 0.65 * min(1.0, abs(dot(n, p)) / scale);
}

vec3 diffuse(Light light, vec3 n, vec3 p) {
  int kind = int(light.position.w);
  if (kind == light_directional) return max(0.0, -dot(n, light.direction.xyz)) * light.strength.rgb;
  vec3 path = light.position.xyz - p;
  float far = length(path);
  if (!(far > 0.0)) return vec3(0.0);
  vec3 towards = path / far;
  float strength = 1.0 / (far * far);
  float range = light.direction.w;
  if (range > 0.0) strength *= clamp(1.0 - pow(far / range, 4.0), 0.0, 1.0);
  float edge = clamp(-dot(light.direction.xyz, towards) * light.strength.w + light.cone.x, 0.0, 1.0);
  return max(0.0, dot(n, towards)) * strength * edge * edge * light.strength.rgb;
}

vec3 light_at(vec3 n, vec3 seen_n, vec3 p, vec3 view) {
  if (unlit) return vec3(1.0);
  if (light_count < 0) return vec3(head_light(n, view));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < light_count; ++i) sum += diffuse(lights[i], seen_n, p);
  return exposure / 3.14159265358979 * sum;
}

void main() {
  vec3 face = cross(dFdx(point_source.xyz), dFdy(point_source.xyz));
  vec3 view = parallel_view && point_source.w == 0.0 ? vec3(0.0, 0.0, -1.0) : point_source.xyz;
  vec4 albedo = point_colour * read_texture(base_map, point_uv.xy, base_use);
  if (alpha_mode == alpha_mask && !(albedo.a >= alpha_cutoff)) discard;
  if (alpha_mode == alpha_blend && !(albedo.a >= 1.0 / 510.0)) discard;
  if (dot(face, view) > 0.0) face = -face;
  vec3 n = point_normal == vec3(0.0) ? face : point_normal;
  float size = length(n);
  vec3 seen_n = size > 0.0 ? (dot(n, face) < 0.0 ? -n : n) / size : vec3(0.0);
  vec3 colour = light_at(n, seen_n, point_source.xyz, view) * albedo.rgb;
  if (emissive != vec3(0.0)) colour += emissive * read_texture(glow_map, point_uv.zw, glow_use).rgb;
  float alpha = alpha_mode == alpha_blend ? min(albedo.a, 1.0) : 1.0;
  out_colour = vec4(colour * alpha, alpha);
  out_source = vec4(point_source.xyz, point_source.w < 0.5 ? 0.0 : point_depth);
  out_ids = ids[first_triangle + gl_PrimitiveID];
  out_normal = vec4(seen_n, 1.0);
  out_uv = point_uv.xy;
}
)";

} // namespace domewarp
