// Refraction at both sides and internal reflection: Chan and Wang 2005, Sec. 2.
#include "algorithms/geocube/entry.glsl"
#include "algorithms/geocube/search.glsl"
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/octahedron.glsl"
#include "algorithms/shaders/optics.glsl"
#ifdef SCATTERING
vec3 sharp_radiance(vec3 direction) { return environment_radiance(direction); }
#include "algorithms/shaders/translucency.glsl"
#endif

layout(binding = 5) uniform sampler2D entries;
#ifdef SPLIT
layout(binding = 6) uniform sampler2D entry_cleared;
#endif
uniform int object_number;
uniform mat3 pixel_to_ray;  // of (x, y, 1): from the eye to depth 1, in the object's space

uniform vec3 eye;  // in the object's space, like all but the light
uniform mat3 object_to_world;
uniform float object_scale;  // metres for a unit of the object's space
uniform float ior;
uniform vec3 absorption;  // 1/m
uniform int reflections;
uniform float cut;
uniform int show;
uniform float diagonal;

#ifdef REPORT
layout(location = 0) out vec4 entry;      // point; 1
layout(location = 1) out vec4 ray;        // refracted direction; steps
layout(location = 2) out vec4 exit_point; // and the length, negative when the bound stopped the search
layout(location = 3) out vec4 exit_normal; // and the cube
#elif defined(COUNT)
layout(location = 0) out vec4 fetched;  // both cube maps, bounds alone, the environment; 1
int lights_fetched = 0;
#else
layout(location = 0) out vec4 radiance;
#endif

vec3 light(vec3 direction) {
#if defined(COUNT) && defined(ENVIRONMENT_IMAGE)
  ++lights_fetched;
#endif
  return environment_radiance(normalize(object_to_world * direction));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 entering = texelFetch(entries, pixel, 0);
  bool here = tagged_object(entering.w) == object_number;
  if (!here) discard;
  vec3 ray_of_pixel = pixel_to_ray * vec3(gl_FragCoord.xy, 1.0);
  vec3 p = eye + entering.x * ray_of_pixel;
  vec3 v = normalize(ray_of_pixel);
  vec3 n = from_square(entering.yz);
  // Interpolated, a normal may look away at the silhouette: there the ray grazes.
  float cosine = max(-dot(v, n), 0.0);
  if (-dot(v, n) < 0.0) n = normalize(n - 1.0001 * dot(v, n) * v);
  float reflected_share = fresnel_dielectric(cosine, 1.0 / ior);
  vec3 color = reflected_share * light(reflect(v, n));
  vec3 h = refract(v, n, 1.0 / ior);
  vec3 weight = vec3(1.0 - reflected_share);

  int cube = tagged_cube(entering.w);
#ifdef SPLIT
  float start = max(texelFetch(entry_cleared, pixel, 0).x, min_step);
#elif defined(LAYERS)
  float start = 0.0;  // that search takes its own first step
#else
  float start = first_step(p, n, h, cube);
#endif
#ifdef REPORT
  entry = vec4(p, h != vec3(0.0) ? 1.0 : 0.0);
  Exit first = trace_inside(p, n, h, cube, start);
  ray = vec4(h, float(first.steps));
  exit_point = vec4(first.point, first.bounded ? -first.path : first.path);
  exit_normal = vec4(first.normal, float(first.cube));
#else
  vec3 shown = vec3(0.0);
  float most = 1.0;  // share of the light that is still on its way, in the channel with the largest
#ifdef SCATTERING
  vec3 depth = vec3(0.0), returned = vec3(0.0);  // optical thickness so far, and what of the light it has sent back
#endif
  for (int k = 0; here && k <= reflections && h != vec3(0.0) && (k == 0 || most > cut); ++k) {
    Exit found = trace_inside(p, n, h, cube, start);
#ifdef SCATTERING
    depth += extinction * (found.path * object_scale);
#else
    weight *= transmitted(absorption, found.path * object_scale);
#endif
    n = found.normal;
    // A normal that looks against the ray belongs to another part of the surface. The one where it leaves is not known, and the ray
    // goes on straight: taken to graze that part, it would be lost inside.
    if (dot(h, n) <= 0.0) n = h;
    float inner = clamp(dot(h, n), 0.0, 1.0);
    float kept = fresnel_dielectric(inner, ior);
    if (k == 0) {
      if (show == 1) shown = vec3(float(found.steps) / float(iterations));
      if (show == 2) shown = vec3(found.path / diagonal);
      if (show == 3) shown = vec3(found.bounded ? 1.0 : 0.0);
      if (show == 4) shown = vec3(found.cube & 1, found.cube >> 1 & 1, found.cube >> 2 & 1) * 0.75 + 0.25;
      if (show == 5) shown = kept >= 1.0 ? vec3(1.0, 0.5, 0.0) : vec3(0.2);
    }
#ifdef SCATTERING
    vec3 outwards = normalize(object_to_world * (kept < 1.0 ? refract(h, -n, ior) : n));
    color += weight.x * translucent(depth, outwards, 1.0 - kept, returned);
#else
    if (kept < 1.0) color += (1.0 - kept) * weight * light(refract(h, -n, ior));
#endif
    weight *= kept;
#ifdef SCATTERING
    vec3 on_the_way = weight * transmitted_share;
#else
    vec3 on_the_way = weight;
#endif
    most = max(on_the_way.x, max(on_the_way.y, on_the_way.z));
    h = reflect(h, n);
    p = found.point;
    cube = found.cube;
    start = next_start(found, h);
  }
#ifdef SCATTERING
  // Light that is still inside would go on to where this search does not follow it. Its scattered part leaves somewhere, and the mean of
  // the environment stands for what it sees there; the rest is left out, as in a clear medium.
  color += weight * scattered * mean_radiance;
#endif
#ifdef COUNT
  fetched = vec4(both_fetched, bounds_fetched, lights_fetched, 1.0);
#else
  radiance = vec4(show > 0 ? shown : color, 1.0);
#endif
#endif
}
