/// The shaders of the window, as texts.
#pragma once

namespace oilskin::demo {

/// Shared by the fragments: light from the left of the eye, less from its right, a little from itself.
/// `normal` and `sight` (from the point to the eye) are unit vectors in the eye's axes.
constexpr const char* shader_light = R"(#version 330 core
vec3 lit(vec3 colour, vec3 normal, vec3 sight, float shine) {
  vec3 sum = 0.27 * colour;
  vec3 from[3] = vec3[3](normalize(vec3(-0.9, 0.55, 0.9)), normalize(vec3(1.1, -0.1, 0.8)), vec3(0.0, 0.0, 1.0));
  vec3 light[3] = vec3[3](0.62 * vec3(1.0, 0.98, 0.94), 0.24 * vec3(0.85, 0.92, 1.0), vec3(0.16));
  for (int k = 0; k < 3; ++k) {
    sum += light[k] * colour * max(dot(normal, from[k]), 0.0);
    vec3 half_way = normalize(from[k] + sight);
    sum += light[k] * shine * pow(max(dot(normal, half_way), 0.0), 40.0);
  }
  return sum;
}
)";

/// Balls and flat drops: a square for each, in which the fragment finds the drop along the line of sight.
constexpr const char* shader_drop_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in float radius;
layout(location = 2) in vec3 normal;
layout(location = 3) in float height;
layout(location = 4) in float value;
uniform mat4 view, projection;
uniform vec4 cut;
uniform float pixel;  // its size at distance 1
out vec3 place;
flat out vec3 center, axis;
flat out float wide, flatness, scale;
void main() {
  center = (view * vec4(position, 1.0)).xyz;
  axis = mat3(view) * normal;
  wide = max(radius, height);
  flatness = wide / height;
  scale = value;
  float distance = length(center);
  vec3 to_eye = -center / distance;
  vec3 right = normalize(cross(abs(to_eye.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), to_eye));
  vec3 up = cross(to_eye, right);
  vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2.0 - 1.0;
  float reach = wide * distance / sqrt(max(distance * distance - wide * wide, 1e-6 * wide * wide)) + pixel * distance;
  place = center + reach * (corner.x * right + corner.y * up);
  gl_Position = projection * vec4(place, 1.0);
  if (dot(cut.xyz, position) + cut.w > 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
)";

constexpr const char* shader_drop_fragment = R"(
in vec3 place;
flat in vec3 center, axis;
flat in float wide, flatness, scale;
uniform mat4 projection;
uniform vec3 stops[6];
out vec4 colour;
vec3 stretched(vec3 v) { return v + (flatness - 1.0) * dot(axis, v) * axis; }
void main() {
  vec3 sight = normalize(place);
  vec3 from = stretched(-center), along = stretched(sight);
  float a = dot(along, along), b = dot(from, along), c = dot(from, from) - wide * wide;
  float d = (b * b - a * c) / (a * wide * wide);
  float coverage = clamp(d / max(fwidth(d), 1e-6) + 0.5, 0.0, 1.0);
  if (coverage <= 0.0) discard;
  vec3 hit = sight * ((-b - sqrt(max(b * b - a * c, 0.0))) / a);
  vec3 normal = normalize(stretched(stretched(hit - center)));
  vec4 clip = projection * vec4(hit, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  float at = clamp(scale, 0.0, 1.0) * 5.0;
  int k = min(int(at), 4);
  colour = vec4(lit(mix(stops[k], stops[k + 1], at - float(k)), normal, -sight, 0.35), coverage);
}
)";

/// Triangles: cloth, bodies, the water mesh.
constexpr const char* shader_mesh_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;
uniform mat4 view, projection;
uniform vec4 cut;
out vec3 place, facing;
out float scale, in_front;
void main() {
  place = (view * vec4(position, 1.0)).xyz;
  facing = mat3(view) * normal;
  scale = value;
  in_front = dot(cut.xyz, position) + cut.w;
  gl_Position = projection * vec4(place, 1.0);
}
)";

/// Cloth and bodies have two sides in two tints; wet cloth is darker.
constexpr const char* shader_mesh_fragment = R"(
in vec3 place, facing;
in float scale, in_front;
uniform vec3 front, back;
uniform float opacity;
out vec4 colour;
void main() {
  if (in_front > 0.0) discard;
  vec3 sight = -normalize(place);
  vec3 normal = normalize(facing);
  vec3 tint = gl_FrontFacing ? front : back;
  if (!gl_FrontFacing) normal = -normal;
  tint *= mix(vec3(1.0), vec3(0.42, 0.46, 0.55), smoothstep(0.0, 1.0, scale));
  colour = vec4(lit(tint, normal, sight, 0.08), opacity);
}
)";

/// Water: bright where one looks along it, where it mirrors the sky.
constexpr const char* shader_water_fragment = R"(
in vec3 place, facing;
in float scale, in_front;
uniform vec3 stops[6];
uniform mat4 view;
uniform vec3 up;
uniform float opacity;
out vec4 colour;
void main() {
  if (in_front > 0.0) discard;
  vec3 sight = -normalize(place);
  vec3 normal = normalize(facing);
  if (dot(normal, sight) < 0.0) normal = -normal;
  float grazing = pow(1.0 - max(dot(normal, sight), 0.0), 4.0);
  vec3 mirrored = reflect(-sight, normal);
  float sky = 0.5 + 0.5 * dot(mirrored, mat3(view) * up);
  float at = (0.2 + 0.6 * clamp(scale, 0.0, 1.0)) * 5.0;
  int k = min(int(at), 4);
  vec3 deep = mix(stops[k], stops[k + 1], at - float(k));
  vec3 seen = mix(lit(deep, normal, sight, 0.9), mix(vec3(0.45, 0.55, 0.62), vec3(0.96, 0.98, 1.0), sky), 0.08 + 0.6 * grazing);
  colour = vec4(seen, mix(opacity, 1.0, grazing));
}
)";

/// Lines and dots in one colour.
constexpr const char* shader_line_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view, projection;
uniform vec4 cut;
uniform float size;
out float in_front;
void main() {
  vec4 place = view * vec4(position, 1.0);
  in_front = dot(cut.xyz, position) + cut.w;
  gl_Position = projection * (place * vec4(0.999, 0.999, 0.999, 1.0));
  gl_PointSize = size;
}
)";

constexpr const char* shader_line_fragment = R"(#version 330 core
in float in_front;
uniform vec3 tint;
uniform bool is_dot;
out vec4 colour;
void main() {
  vec2 from_middle = 2.0 * gl_PointCoord - 1.0;
  if (in_front > 0.0 || (is_dot && dot(from_middle, from_middle) > 1.0)) discard;
  colour = vec4(tint, 1.0);
}
)";

/// The background, from the horizon to above.
constexpr const char* shader_sky_vertex = R"(#version 330 core
out float height;
void main() {
  vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2.0 - 1.0;
  height = 0.5 + 0.5 * corner.y;
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

constexpr const char* shader_sky_fragment = R"(#version 330 core
in float height;
out vec4 colour;
void main() { colour = vec4(mix(vec3(0.84, 0.87, 0.90), vec3(0.98, 0.985, 0.99), height), 1.0); }
)";

}  // namespace oilskin::demo
