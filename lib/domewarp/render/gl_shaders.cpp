// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/gl_shaders.h"

namespace domewarp {

const char* const vertex_shader_source = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 source;
layout(location = 2) in vec3 normal;
layout(location = 3) in vec4 colour;
layout(location = 4) in vec4 uv;
uniform mat4 projection;
out vec4 point_source;
out vec3 point_normal;
out vec4 point_colour;
out vec4 point_uv;

void main() {
  gl_Position = projection * vec4(position, 1.0);
  point_source = source;
  point_normal = normal;
  point_colour = colour;
  point_uv = uv;
}
)";

// Texels are fetched and mixed here rather than by the texture unit, which may have as few as 8 bits for the weights.
const char* const fragment_shader_source = R"(#version 450 core
in vec4 point_source;
in vec3 point_normal;
in vec4 point_colour;
in vec4 point_uv;
layout(location = 0) out vec4 out_colour;
layout(location = 1) out vec4 out_source;
layout(location = 2) out uvec2 out_ids;

const int wrap_repeat = 0, wrap_clamp = 1, wrap_mirror = 2;
const int alpha_opaque = 0, alpha_mask = 1, alpha_blend = 2;

uniform sampler2D base_map, glow_map;
uniform ivec4 base_use, glow_use;  // present, wrap_s, wrap_t, nearest
uniform vec3 emissive;
uniform int alpha_mode;
uniform float alpha_cutoff;
uniform bool unlit;
uniform int first_triangle;        // of this draw, in ids

layout(std430, binding = 0) readonly buffer Triangles { uvec2 ids[]; };

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

float light_factor(vec3 n, vec3 p) {
  float scale = length(n) * length(p);
  if (!(scale > 0.0)) return 1.0;
  return 0.35 + 0.65 * min(1.0, abs(dot(n, p)) / scale);
}

void main() {
  vec3 across = dFdx(point_source.xyz), along = dFdy(point_source.xyz);
  vec4 albedo = point_colour * read_texture(base_map, point_uv.xy, base_use);
  if (alpha_mode == alpha_mask && !(albedo.a >= alpha_cutoff)) discard;
  if (alpha_mode == alpha_blend && !(albedo.a >= 1.0 / 510.0)) discard;
  vec3 n = point_normal == vec3(0.0) ? cross(across, along) : point_normal;
  vec3 colour = (unlit ? 1.0 : light_factor(n, point_source.xyz)) * albedo.rgb;
  if (emissive != vec3(0.0)) colour += emissive * read_texture(glow_map, point_uv.zw, glow_use).rgb;
  float alpha = alpha_mode == alpha_blend ? min(albedo.a, 1.0) : 1.0;
  out_colour = vec4(colour * alpha, alpha);
  out_source = point_source;
  out_ids = ids[first_triangle + gl_PrimitiveID];
}
)";

} // namespace domewarp
