// The point of a mirror, metal or dielectric that a fragment shows: of a triangle, or with FROM_PIXELS what
// object_pixels.frag.glsl kept of one. KIND: 1 mirror, 2 metal, 3 dielectric.
#include "algorithms/shaders/octahedron.glsl"

uniform vec3 eye;

#ifdef FROM_PIXELS
in vec2 clip_position;

// xy: the normal on the octahedron's square; z: distance from the eye; w: the object's number, < 0 where it is seen from
// the inside, 0: no object.
layout(binding = 9) uniform sampler2D object_pixels;
uniform int object_number;
uniform mat3 clip_to_ray;

vec3 world_position;
vec4 object_pixel;

// False where the pixel shows something else.
bool fetch_surface(out vec3 V) {
  object_pixel = texelFetch(object_pixels, ivec2(gl_FragCoord.xy), 0);
  V = normalize(clip_to_ray * vec3(clip_position, 1.0));
  world_position = eye + object_pixel.z * V;
  return int(abs(object_pixel.w)) == object_number;
}

vec3 visible_normal(vec3 V, out bool inside) {
  inside = object_pixel.w < 0.0;
  return from_square(object_pixel.xy);
}
#else
in vec3 world_position;
in vec3 world_normal;

bool fetch_surface(out vec3 V) {
  V = normalize(world_position - eye);
  return true;
}

// The unit normal on the viewer's side, as the forward pass has it, and whether that is the inside.
vec3 visible_normal(vec3 V, out bool inside) {
  vec3 n = normalize(world_normal);
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  if (dot(geometric, V) > 0.0) geometric = -geometric;
  inside = dot(n, geometric) < 0.0;
  return inside ? -n : n;
}
#endif
