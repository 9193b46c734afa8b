#pragma once

namespace sulcus {

// GLSL 3.30, as engine/graphics/shaders.hpp. What is drawn are numbers: depth along the optical
// axis in metres, which is w of the clip space of our cameras, and normals in camera space.

inline constexpr const char* kGeometryVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
uniform mat4 world_from_model;      // of the burr; bodies are given in the world
uniform vec4 shown;                 // the plane of a section
uniform vec3 right_world, up_world, back_world;
out vec3 normal_camera;
out float depth;
void main() {
  vec4 world = world_from_model * vec4(position, 1.0);
  gl_Position = clip_from_world * world;
  gl_ClipDistance[0] = dot(shown, world);
  vec3 n = mat3(world_from_model) * normal;
  normal_camera = vec3(dot(right_world, n), -dot(up_world, n), -dot(back_world, n));
  depth = gl_Position.w;
}
)";

inline constexpr const char* kGeometryFragment = R"(#version 330 core
in vec3 normal_camera;
in float depth;
uniform int object;
layout(location = 0) out vec4 numbers;
layout(location = 1) out uint shows;
void main() {
  numbers = vec4(normalize(normal_camera), depth);
  shows = uint(object);
}
)";

// As kSectionVertex and kSectionFragment: the face is where those draw it.
inline constexpr const char* kFaceGeometryVertex = R"(#version 330 core
uniform mat4 clip_from_world;
uniform vec3 corner, along, across;  // m
out vec2 place;
out float depth;
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = clip_from_world * vec4(corner + place.x * along + place.y * across, 1.0);
  depth = gl_Position.w;
}
)";

inline constexpr const char* kFaceGeometryFragment = R"(#version 330 core
in vec2 place;
in float depth;
uniform sampler2D tissues;
uniform vec3 normal_camera;
uniform int object;
layout(location = 0) out vec4 numbers;
layout(location = 1) out uint shows;
void main() {
  if (texture(tissues, place).a < 0.33) discard;
  numbers = vec4(normal_camera, depth);
  shows = uint(object);
}
)";

}  // namespace sulcus
