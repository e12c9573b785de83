// Timonen, Sec. 3, Algorithm 1: a fragment of a mesh over a solid and a translucent layer.
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/shadows.glsl"
#include "algorithms/translucent_relief/light_reaching.glsl"

#include "algorithms/translucent_relief/objects.glsl"
#ifdef CAUSTICS
layout(binding = 13) uniform sampler2DArray caustic_maps;  // by light, over the relief's maps
#endif
#ifdef AIR
#include "algorithms/translucent_relief/air.glsl"
#endif

in vec3 world_position;
in vec3 world_normal;
in vec3 world_over_u;
in vec3 world_over_v;
in vec3 tint;
in vec2 mesh_uv;

uniform vec3 eye;
uniform vec3 solid_albedo;
uniform vec2 solid_phong;   // specular, exponent
uniform vec2 medium_phong;
uniform float intensification;
uniform float plane_height;  // of the flat solid that planar rays meet
uniform bool planar_reflections;
uniform bool planar_refractions;
uniform bool separate_boxes;
uniform int show;

const int kShowRadiance = 0, kShowReflections = 1, kShowOcclusion = 2, kShowSteps = 3;

#ifdef REPORT
layout(location = 0) out vec4 report_start;   // uv of the fragment; kind of the first hit: 0 none, 1 solid, 2 medium; distance
layout(location = 1) out vec4 report_ray;     // direction in the frame; a step of the search
layout(location = 2) out vec4 report_scale;   // metres over u and v; heights asked for; 1
layout(location = 3) out vec4 report_light;   // of the first light: direction in the frame, share that reaches the hit
#else
layout(location = 0) out vec4 radiance;
#endif

mat3 to_frame;  // rows: along u, along v, normal

vec3 to_world_direction(vec3 d) { return d * to_frame; }
vec3 to_world_point(vec3 p) { return world_position + p * to_frame; }

vec3 sky_radiance(vec3 direction) {
#ifdef COUNT
  environment_fetches += 1.0;
#endif
  return environment_radiance(direction);
}

// The opaque objects' shadows, at the place where light comes through the mesh.
float object_visibility(int i, vec3 p, vec3 to_light) {
  if (!casts_shadow(i)) return 1.0;
  return light_visibility(i, to_world_point(p - to_light * (p.z / max(to_light.z, 1e-4))));
}

// Phong's highlight, relative to a white Lambertian surface's radiance in light along its normal.
float phong(vec2 settings, vec3 reflected, vec3 to_light) {
  return settings.x * pow(max(dot(reflected, to_light), 0.0), settings.y);
}

// A point of the solid as it is seen along `v`; the paper's SAMPLE. `occlusion`: of the first light.
vec3 solid_radiance(Ray frame, vec3 p, vec3 v, out float occlusion) {
  FETCHED(1);
  vec2 uv = frame.uv + p.xy * frame.uv_per_metre;
  vec3 n = solid_normal(uv, frame.uv_per_metre);
  vec3 albedo = solid_albedo * tint * textureLod(solid_colors, uv * tiling, 0.0).rgb;
  float side = medium_height(uv) > p.z ? -1.0 : 1.0;
  vec3 sum = albedo * ambient_count.rgb;
  occlusion = 1.0;
  for (int i = 0; i < LIGHT_COUNT; ++i) {
    vec3 to_light;
    vec3 irradiance = light_irradiance(i, to_world_point(p), to_light) / kPi;
    to_light = to_frame * to_light;
    float cosine = dot(n, to_light);
#ifdef CAUSTICS
    // Under a medium: what its surface gathers here, arriving as through a level one.
    vec3 bent = -refract(-to_light, vec3(0.0, 0.0, 1.0), outside_index / index);
    if (side < 0.0 && kLightKinds[i] == kDirectional && to_light.z > 0.0 && bent.z > 0.0) {
      vec3 gathered = textureLod(caustic_maps, vec3(uv * tiling, float(i)), 0.0).rgb;
      sum += irradiance * albedo * gathered *
             (to_light.z * max(dot(n, bent), 0.0) / bent.z * object_visibility(i, p, to_light));
      continue;
    }
#endif
    if (cosine <= 0.0 && (i > 0 || show != kShowOcclusion)) continue;
    vec3 share = light_reaching(frame, p, to_light, side) * object_visibility(i, p, to_light);
    if (i == 0) occlusion = max(share.r, max(share.g, share.b));
    if (cosine <= 0.0) continue;
    sum += irradiance * share * (albedo * cosine + phong(solid_phong, reflect(v, n), to_light));
  }
  return sum;
}

// A normal that looks away from the ray, as interpolated ones may, is turned so far that the ray grazes.
vec3 facing(vec3 n, vec3 v) {
  float along = dot(n, v);
  return along < 0.0 ? n : normalize(n - 1.0001 * along * v);
}

// Where a ray from the medium's surface meets the solid: by search, or a plane at its mean height. Negative: nowhere.
float meet_solid(Ray ray, int kind, bool planar) {
  if (!planar) return find_crossing(kSolid, ray, 0.0, 1.0, kind);
  if (ray.direction.z >= -1e-6) return -1.0;
  float t = max((plane_height - ray.origin.z) / ray.direction.z, 0.0);
  vec2 range = clip_ray(ray, -1e9, 1e9, cut, 0.0);
  return t <= range.y ? t : -1.0;
}

#ifdef SCATTERING
// The solid's radiance `color`, met after `t`, as it is seen through a path in the medium: a part of it sharp, a part
// blurred over as much of the solid as the Gaussian spreads it, a part as its mean; and what the medium itself sends back of
// the light that falls on `p` with the normal `n`. Blurred are the solid's colours, not its light.
vec3 through_scattering(Ray frame, vec3 p, vec3 n, Ray ray, float t, float path, vec3 color) {
  vec2 uv = uv_at(ray, t) * tiling;
  vec2 texels_per_metre = vec2(textureSize(solid_colors, 0)) * tiling * frame.uv_per_metre;
  float texels = max(texels_per_metre.x, texels_per_metre.y);
  vec3 here = max(textureLod(solid_colors, uv, 0.0).rgb, vec3(1e-4)), seen = vec3(0.0);
  for (int c = 0; c < 3; ++c) {
    vec4 fit = transfer_row(extinction[c] * path, c);
    float lod = log2(max(path * tan(min(fit.z, 1.4)) * texels, 1.0));
    float blurred = textureLod(solid_colors, uv, lod)[c], mean = textureLod(solid_colors, uv, 16.0)[c];
    seen[c] = color[c] * (fit.x + (fit.y * blurred + fit.w * mean) / here[c]);
  }
  vec3 incident = ambient_count.rgb;
  for (int i = 0; i < LIGHT_COUNT; ++i) {
    vec3 to_light;
    vec3 irradiance = light_irradiance(i, to_world_point(p), to_light) / kPi;
    to_light = to_frame * to_light;
    float cosine = dot(n, to_light);
    if (cosine > 0.0) incident += irradiance * cosine * light_reaching(frame, p, to_light, 1.0) * object_visibility(i, p, to_light);
  }
  return seen + scattered_reflectance(path) * incident;
}
#endif

vec3 medium_radiance(Ray frame, vec3 p, vec3 v, out float occlusion) {
  vec2 uv_p = frame.uv + p.xy * frame.uv_per_metre;
  vec3 n = facing(medium_normal(uv_p, frame.uv_per_metre), v);
  float eta = outside_index / index;
  float reflected_share = fresnel_dielectric(-dot(v, n), eta);
  vec3 sum = vec3(0.0);
  occlusion = 1.0;
  float unused;

  // Refraction, to the solid.
  if (reflected_share < 1.0) {
    Ray ray = Ray(p, refract(v, n, eta), frame.uv, frame.uv_per_metre);
    float t = meet_solid(ray, kRefracted, planar_refractions);
    vec3 color = t < 0.0 ? sky_radiance(to_world_direction(ray.direction))
                         : solid_radiance(frame, ray.origin + t * ray.direction, ray.direction, occlusion);
    float end = t < 0.0 ? max(clip_to_layer(kMedium, ray, 0.0).y, 0.0) : t;
#ifdef OBJECTS
    vec3 object_color;
    float object = meet_object(to_world_point(p), to_world_direction(ray.direction), end, object_color);
    if (object >= 0.0) {
      color = object_color;
      end = object;
    }
#endif
#ifdef ABSORPTION
    float leaves = find_crossing(kMedium, ray, 0.0, -1.0, kRefracted);
    float inside = leaves < 0.0 ? end : min(leaves, end);
#ifdef SCATTERING
    color = t < 0.0 ? color * scattered_transmittance(inside) : through_scattering(frame, p, n, ray, t, inside, color);
#else
    color *= transmitted(absorption, inside);
#endif
#endif
    sum += (1.0 - reflected_share) * color;
  }

  // Reflection, into the surface or the environment.
  vec3 mirrored = reflect(v, n);
  {
    Ray ray = Ray(p, mirrored, frame.uv, frame.uv_per_metre);
    float t = meet_solid(ray, kReflected, planar_reflections);
    vec3 color = t < 0.0 ? sky_radiance(to_world_direction(mirrored))
                         : solid_radiance(frame, p + t * mirrored, mirrored, unused);
#ifdef OBJECTS
    vec3 object_color;
    float reach = t < 0.0 ? object_reach : t;
    if (meet_object(to_world_point(p), to_world_direction(mirrored), reach, object_color) >= 0.0) color = object_color;
#endif
    if (show == kShowReflections) color = (t < 0.0 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0));
    sum = show == kShowReflections ? mix(sum, color, 0.6) : sum + reflected_share * color;
  }

  // The lights' own reflections.
  if (medium_phong.x > 0.0 && show == kShowRadiance) {
    for (int i = 0; i < LIGHT_COUNT; ++i) {
      vec3 to_light;
      vec3 irradiance = light_irradiance(i, to_world_point(p), to_light) / kPi;
      to_light = to_frame * to_light;
      float highlight = phong(medium_phong, mirrored, to_light);
      if (highlight < 1e-4 || dot(n, to_light) <= 0.0) continue;
      vec3 share = light_reaching(frame, p, to_light, 1.0) * object_visibility(i, p, to_light);
      sum += mix(reflected_share, 1.0, intensification) * highlight * irradiance * share;
    }
  }
  return sum;
}

void main() {
  vec3 n = normalize(world_normal);
  vec3 u = world_over_u - n * dot(n, world_over_u);
  vec2 metres = vec2(length(u), 0.0);
  u /= metres.x;
  vec3 w = cross(n, u);
  metres.y = dot(w, world_over_v);
  if (metres.y < 0.0) w = -w;
  metres.y = abs(metres.y);
  to_frame = transpose(mat3(u, w, n));
  vec3 v = to_frame * normalize(world_position - eye);
  v.z = min(v.z, -1e-4);  // an interpolated normal may look away
  v = normalize(v);
  Ray ray = Ray(vec3(0.0), v, mesh_uv, 1.0 / metres);
#if defined(AIR) && !defined(REPORT)
  vec3 through;
  bool down = bend_through_air(mesh_uv, 1.0 / metres, through, v);
  if (!down) {
    radiance = vec4(sky_radiance(to_world_direction(v)), 1.0);
    gl_FragDepth = gl_FragCoord.z;
    return;
  }
  ray = Ray(vec3(through.xy, 0.0), v, mesh_uv, 1.0 / metres);
#endif

  // The first hit.
  float t = -1.0;
  bool on_medium = false;
#if MAPPING == 0
  t = 0.0;
#else
#ifdef TWO_LAYERS
  if (separate_boxes || SEARCH != 0) {
    float medium = find_crossing(kMedium, ray, 0.0, 1.0, kView);
    t = find_crossing(kSolid, ray, 0.0, 1.0, kView);
    on_medium = medium >= 0.0 && (t < 0.0 || medium < t);
    if (on_medium) t = medium;
  } else {
    t = find_crossing(kEither, ray, 0.0, 1.0, kView);
    vec2 uv = uv_at(ray, t);
    on_medium = t >= 0.0 && medium_height(uv) > solid_height(uv);
  }
#else
  t = find_crossing(kSolid, ray, 0.0, 1.0, kView);
#endif
#ifndef REPORT
  if (t < 0.0) discard;
#endif
#endif
  vec3 p = ray.origin + t * v;

  float occlusion = 1.0;
#ifdef REPORT
  report_start = vec4(mesh_uv, t < 0.0 ? 0.0 : on_medium ? 2.0 : 1.0, t);
  vec2 searched = clip_to_layer(kEither, ray, 0.0);
  report_ray = vec4(v, max(searched.y - searched.x, 0.0) / float(steps_of(kView, ray)));
  vec3 to_light = vec3(0.0, 0.0, -1.0);
  if (LIGHT_COUNT > 0) light_irradiance(0, to_world_point(p), to_light);
  to_light = to_frame * to_light;
  report_scale = vec4(metres, taken[kView], 1.0);
  vec3 share = vec3(0.0);
  if (t >= 0.0) share = light_reaching(ray, p, to_light, 1.0);
  report_light = vec4(to_light, max(share.r, max(share.g, share.b)));
#else
  vec3 color = on_medium ? medium_radiance(ray, p, v, occlusion) : solid_radiance(ray, p, v, occlusion);
  if (show == kShowOcclusion) color = vec3(occlusion);
  if (show == kShowSteps) {
    float most = dot(step_counts, vec4(1.0));
    color = vec3(dot(taken, vec4(1.0)) / most);
  }
#ifdef COUNT
  radiance = vec4(fetches, environment_fetches, 1.0, 1.0);
#else
  radiance = vec4(color, 1.0);
#endif
  vec4 clip = world_to_clip * vec4(to_world_point(p), 1.0);
  gl_FragDepth = clamp(0.5 * clip.z / clip.w + 0.5, 0.0, 1.0);
#endif
}
