#pragma once

namespace sulcus {

// GLSL 3.30, so that any OpenGL core context will do. Light and colour are linear; the last line of
// each fragment shader encodes for the screen (gamma 2.2, near enough to sRGB). The lights hang on
// the camera: every view is lit like a photograph taken from there.

inline constexpr const char* kBackgroundVertex = R"(#version 330 core
out vec2 place;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  place = corner;
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

inline constexpr const char* kBackgroundFragment = R"(#version 330 core
in vec2 place;
out vec4 colour;
void main() {
  vec3 tone = mix(vec3(0.58, 0.61, 0.64), vec3(0.80, 0.82, 0.84),
                  smoothstep(-1.1, 1.1, place.y + 0.15 * (1.0 - place.x * place.x)));
  colour = vec4(tone, 1.0);
}
)";

// Edges are smoothed in the picture [Lottes 2009, FXAA]: several samples a pixel would double the
// time of a software rasteriser. Where brightness changes little round a pixel it stays as it is.
inline constexpr const char* kSmoothFragment = R"(#version 330 core
uniform sampler2D picture;
out vec4 colour;
float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(picture, 0) - 1;
  ivec2 before = max(at - 1, ivec2(0)), after = min(at + 1, last);
  vec3 here = texelFetch(picture, at, 0).rgb;
  float w = luma(texelFetch(picture, ivec2(before.x, at.y), 0).rgb);
  float e = luma(texelFetch(picture, ivec2(after.x, at.y), 0).rgb);
  float s = luma(texelFetch(picture, ivec2(at.x, before.y), 0).rgb);
  float n = luma(texelFetch(picture, ivec2(at.x, after.y), 0).rgb);
  float m = luma(here);
  float low = min(m, min(min(w, e), min(s, n)));
  float high = max(m, max(max(w, e), max(s, n)));
  colour = vec4(here, 1.0);
  if (high - low < max(0.04, 0.10 * high)) return;
  vec2 pixel = 1.0 / vec2(textureSize(picture, 0));
  vec2 place = gl_FragCoord.xy * pixel;
  // Between four pixels each.
  float nw = 0.25 * (n + w + m + luma(texelFetch(picture, ivec2(before.x, after.y), 0).rgb));
  float ne = 0.25 * (n + e + m + luma(texelFetch(picture, after, 0).rgb));
  float sw = 0.25 * (s + w + m + luma(texelFetch(picture, before, 0).rgb));
  float se = 0.25 * (s + e + m + luma(texelFetch(picture, ivec2(after.x, before.y), 0).rgb));
  // Along the edge: across the gradient of brightness.
  vec2 along = vec2((sw + se) - (nw + ne), (ne + se) - (nw + sw));
  float least = min(abs(along.x), abs(along.y)) + (nw + ne + sw + se) / 32.0 + 1.0 / 128.0;
  along = clamp(along / least, vec2(-8.0), vec2(8.0)) * pixel;
  vec3 inner = 0.5 * (texture(picture, place - along / 6.0).rgb +
                      texture(picture, place + along / 6.0).rgb);
  vec3 outer = 0.5 * inner + 0.25 * (texture(picture, place - 0.5 * along).rgb +
                                     texture(picture, place + 0.5 * along).rgb);
  float reached = luma(outer);
  colour = vec4(reached < low || reached > high ? inner : outer, 1.0);
}
)";

// The tooth's triangles are a few pixels large, and a software rasteriser shades at least a block
// of pixels for each and pays for each quantity that is interpolated. So all light is computed at
// the vertices and one colour goes on. World is where a body was at the start; of one that has
// moved since, camera, lights and occlusion are given as if they had moved instead.
inline constexpr const char* kToothVertex = R"(#version 330 core
layout(location = 0) in vec3 position_world;
layout(location = 1) in vec4 normal_unlit;  // the fourth, 1: its colour stands for a value
layout(location = 2) in vec4 colour_cut;
uniform mat4 clip_from_world;
uniform sampler3D occlusion;        // blurred density of the solid
uniform mat4 texture_from_world;
uniform vec4 shown;                 // the plane of a section
uniform float occlusion_cell;       // m
uniform vec3 eye_world;
uniform vec3 right_world, up_world, back_world;
out vec3 encoded;

float lobe(vec3 n, vec3 view, vec3 light, float power) {
  return pow(max(dot(n, normalize(view + light)), 0.0), power);
}

void main() {
  gl_Position = clip_from_world * vec4(position_world, 1.0);
  gl_ClipDistance[0] = dot(shown, vec4(position_world, 1.0));
  vec3 n = normalize(normal_unlit.xyz);
  vec3 albedo = colour_cut.rgb * colour_cut.rgb;
  float cut = colour_cut.a;

  // Over a flat surface the blurred density falls to 0.033 and 0.001 at these two heights. What is
  // more than that stands in the light's way. Nearer to the surface it would show its terraces.
  vec3 low = position_world + 3.8 * occlusion_cell * n;
  vec3 high = position_world + 6.4 * occlusion_cell * n;
  float near_by = texture(occlusion, (texture_from_world * vec4(low, 1.0)).xyz).r - 0.033;
  float further = texture(occlusion, (texture_from_world * vec4(high, 1.0)).xyz).r - 0.001;
  float open = exp(-3.2 * max(near_by, 0.0) - 2.0 * max(further, 0.0));

  vec3 view = normalize(eye_world - position_world);
  vec3 key = normalize(-0.55 * right_world + 0.75 * up_world + 0.50 * back_world);
  vec3 fill = normalize(0.85 * right_world + 0.10 * up_world + 0.55 * back_world);
  vec3 rim = normalize(0.35 * right_world + 0.55 * up_world - 0.75 * back_world);

  // A cut face is matt, chalky and rough; sound surface shines, the lighter tissue the more.
  float whiteness = smoothstep(0.25, 0.75, dot(albedo, vec3(0.3, 0.6, 0.1)));
  float gloss = (1.0 - cut) * mix(0.35, 1.0, whiteness);
  float grain = fract(sin(dot(position_world * 1e5, vec3(12.99, 78.23, 37.72))) * 43758.5) - 0.5;
  vec3 chalky = min(albedo * vec3(1.05, 1.08, 1.14) + 0.04, vec3(1.0)) * (1.0 + 0.14 * grain);
  vec3 body = mix(albedo, chalky, cut);

  float shade = open * open;
  // Light wraps round what scatters inside: enamel more than the rest.
  float wrap = mix(0.12, 0.30, whiteness * (1.0 - cut));
  float from_key = max((dot(n, key) + wrap) / (1.0 + wrap), 0.0);
  float from_fill = max(0.5 + 0.5 * dot(n, fill), 0.0);
  float sky = 0.5 + 0.5 * dot(n, up_world);
  vec3 ambient = mix(vec3(0.14, 0.13, 0.125), vec3(0.27, 0.29, 0.315), sky);
  vec3 light = vec3(0.66, 0.64, 0.60) * from_key * mix(shade, 1.0, 0.25) +
               (vec3(0.13, 0.145, 0.165) * from_fill + ambient) * shade;
  // Dim light in a fissure has passed through tooth: it comes out warmer.
  vec3 warm = mix(pow(body, vec3(1.35)), body, open);
  vec3 lit = warm * light;

  float grazing = pow(1.0 - max(dot(n, view), 0.0), 4.0);
  lit += gloss * shade *
         (0.05 * lobe(n, view, key, 12.0) + 0.22 * lobe(n, view, key, 70.0) +
          0.05 * lobe(n, view, fill, 30.0) + vec3(0.13, 0.15, 0.18) * grazing);
  lit += vec3(0.10) * shade * max(dot(n, rim), 0.0) * grazing;
  lit = mix(lit, albedo, normal_unlit.w);
  encoded = pow(min(lit, vec3(1.0)), vec3(1.0 / 2.2));
}
)";

inline constexpr const char* kToothFragment = R"(#version 330 core
in vec3 encoded;
out vec4 colour;
void main() { colour = vec4(encoded, 1.0); }
)";

// The face of a section: a quad with a picture of the tissues that it goes through, colours times
// how much is solid, so that an edge keeps the colour of what is inside it.
inline constexpr const char* kSectionVertex = R"(#version 330 core
uniform mat4 clip_from_world;
uniform vec3 corner, along, across;  // m
out vec2 place;
void main() {
  place = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = clip_from_world * vec4(corner + place.x * along + place.y * across, 1.0);
}
)";

inline constexpr const char* kSectionFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D tissues;
out vec4 colour;
void main() {
  vec4 solid = texture(tissues, place);
  // Somewhat beyond where the surface is, or a gap would show between them here and there.
  if (solid.a < 0.33) discard;
  vec3 lit = 0.92 * solid.rgb / solid.a;
  // A thin dark line where the tooth ends.
  lit *= mix(0.8, 1.0, smoothstep(0.4, 0.75, solid.a));
  colour = vec4(pow(min(lit, vec3(1.0)), vec3(1.0 / 2.2)), 1.0);
}
)";

// What is not there: brighter where its walls are seen edgewise, as glass is.
inline constexpr const char* kGhostVertex = R"(#version 330 core
layout(location = 0) in vec3 position_world;
layout(location = 1) in vec3 normal_world;
uniform mat4 clip_from_world;
uniform vec4 shown;                 // the plane of a section
uniform vec3 eye_world;
out float edgewise;
void main() {
  gl_Position = clip_from_world * vec4(position_world, 1.0);
  gl_ClipDistance[0] = dot(shown, vec4(position_world, 1.0));
  edgewise = 1.0 - abs(dot(normalize(normal_world), normalize(eye_world - position_world)));
}
)";

inline constexpr const char* kGhostFragment = R"(#version 330 core
in float edgewise;
out vec4 colour;
void main() {
  colour = vec4(0.40, 0.12, 0.62, 0.16 + 0.5 * edgewise * edgewise * edgewise * edgewise);
}
)";

// The outline of what is not there, 3 pixels wide.
inline constexpr const char* kGhostSectionFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D tissues;
out vec4 colour;
void main() {
  float inside = texture(tissues, place).a;
  float from_edge = abs(inside - 0.5) / max(fwidth(inside), 1e-4);
  float line = 1.0 - smoothstep(1.0, 2.0, from_edge);
  colour = vec4(0.40, 0.12, 0.62, max(line, inside > 0.5 ? 0.12 : 0.0));
}
)";

inline constexpr const char* kBurrVertex = R"(#version 330 core
layout(location = 0) in vec3 position_tool;
layout(location = 1) in vec3 normal_tool;
uniform mat4 clip_from_world;
uniform mat4 world_from_tool;
out vec3 point;
out vec3 in_tool;
out vec3 direction_tool;
void main() {
  in_tool = position_tool;
  direction_tool = normal_tool;
  vec4 world = world_from_tool * vec4(position_tool, 1.0);
  point = world.xyz;
  gl_Position = clip_from_world * world;
}
)";

inline constexpr const char* kBurrFragment = R"(#version 330 core
in vec3 point;
in vec3 in_tool;
in vec3 direction_tool;
uniform mat4 world_from_tool;
uniform vec3 eye_world;
uniform vec3 right_world, up_world, back_world;
uniform float head_length;   // m: blades up to there, a smooth shank beyond
uniform float head_radius;   // m
uniform float turn;          // rad
uniform float alpha;
out vec4 colour;

void main() {
  vec3 n_tool = normalize(direction_tool);
  // Eight blades that wind round the head. They are only shaded: the burr cuts as what they sweep.
  float blades = 1.0 - smoothstep(0.94, 1.0, in_tool.y / head_length);
  float phase = 8.0 * (atan(in_tool.z, in_tool.x) + turn) + 3.2 * in_tool.y / head_radius;
  vec3 around = normalize(vec3(-in_tool.z, 0.0, in_tool.x) + vec3(1e-9, 0.0, 0.0));
  float rise = fract(phase / 6.2831853);
  float slope = mix(0.55, -1.6, smoothstep(0.70, 0.80, rise));
  float axis_distance = length(in_tool.xz) / head_radius;
  n_tool = normalize(n_tool + blades * smoothstep(0.02, 0.25, axis_distance) * slope * around);
  float groove = mix(1.0, 0.45 + 0.55 * smoothstep(0.0, 0.5, rise), blades);

  vec3 n = normalize(mat3(world_from_tool) * n_tool);
  vec3 view = normalize(eye_world - point);
  vec3 mirrored = reflect(-view, n);
  // Steel shows the room: bright above, a dark horizon, a lamp.
  float height = dot(mirrored, up_world);
  vec3 room = mix(vec3(0.10, 0.11, 0.13), vec3(0.62, 0.66, 0.70), smoothstep(-0.35, 0.75, height));
  room = mix(room, vec3(0.05, 0.055, 0.065), exp(-18.0 * height * height) * 0.6);
  vec3 key = normalize(-0.55 * right_world + 0.75 * up_world + 0.50 * back_world);
  room += vec3(1.0, 0.97, 0.92) * pow(max(dot(mirrored, key), 0.0), 24.0) * 0.9;
  vec3 lit = room * vec3(0.86, 0.88, 0.92) * groove + 0.10 * max(dot(n, key), 0.0);
  colour = vec4(pow(min(lit, vec3(1.0)), vec3(1.0 / 2.2)), alpha);
}
)";

}  // namespace sulcus
