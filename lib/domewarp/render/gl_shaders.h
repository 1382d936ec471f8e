// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace domewarp {

// The shading of shading.h in GLSL 4.50.
//
// Vertex inputs: 0 position (camera space), 1 source position (w 1 when known; else the camera-space position, w 0),
// 2 normal (same space as the source position), 3 base colour times COLOR_0, 4 uv of the base and emissive textures.
// Outputs: 0 linear colour multiplied by alpha, 1 source position, 2 object and triangle id, 3 seen normal, 4 uv of the
// base texture.
extern const char* const vertex_shader_source;
extern const char* const fragment_shader_source;

} // namespace domewarp
