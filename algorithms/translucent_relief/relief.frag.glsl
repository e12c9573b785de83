// Timonen, Sec. 3, Algorithm 1: a fragment of a mesh over a solid and a translucent layer.
#define HAS_SKY
#include "algorithms/translucent_relief/settings.glsl"
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/shadows.glsl"
#include "algorithms/translucent_relief/light_reaching.glsl"

#include "algorithms/translucent_relief/objects.glsl"
#ifdef CAUSTICS
// By light and layer of charts: power on a unit of the mesh's texture that falls on a plane at the solid's mean height.
layout(binding = 13) uniform sampler2DArray caustic_maps;
// By triangle; over an edge where its map does not repeat, light is that of the edge.
layout(std430, binding = 2) readonly buffer CausticLayers { uint caustic_layers[]; };
const uint kCausticLayer = 0xffu, kRepeatsOverU = 0x100u, kRepeatsOverV = 0x200u;
#endif
in vec3 world_position;
in vec3 world_normal;
in vec3 world_over_u;
in vec3 world_over_v;
in vec3 tint;
in vec2 mesh_uv;

// SHOW, the parameter `show`, is compiled in.
const int kShowRadiance = 0, kShowReflections = 1, kShowOcclusion = 2, kShowSteps = 3;

#ifdef REPORT
layout(location = 0) out vec4 report_start;   // uv of the fragment; kind of the first hit: 0 none, 1 solid, 2 medium; distance
layout(location = 1) out vec4 report_ray;     // direction in the frame; a step of the search
layout(location = 2) out vec4 report_scale;   // metres over u and v; heights asked for; 1
layout(location = 3) out vec4 report_light;   // of the first light: direction in the frame, share that reaches the hit
#elif defined(COUNT)
layout(location = 0) out float fetch_count;
#else
layout(location = 0) out vec4 radiance;
#endif

mat3 to_frame;  // rows: along u, along v, normal

vec3 to_world_direction(vec3 d) { return d * to_frame; }
vec3 to_world_point(vec3 p) { return world_position + p * to_frame; }

#ifdef AIR
#include "algorithms/translucent_relief/air.glsl"
#endif

vec3 sky_radiance(vec3 direction) {
  FETCHED(1);
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

// A normal that looks away from the ray, as interpolated ones may, is turned so far that the ray grazes.
vec3 facing(vec3 n, vec3 v) {
  float along = dot(n, v);
  return along < 0.0 ? n : normalize(n - 1.0001 * along * v);
}

// Where a ray from the medium's surface meets the solid: by search, or a plane at its mean height. Negative: nowhere.
float meet_solid(Ray ray, bool reflection) {
  if (reflection ? !PLANAR_REFLECTIONS : !PLANAR_REFRACTIONS)
    return find_crossing(kSolid, ray, 0.0, 1.0, reflection ? kReflected : kRefracted);
  float t = -1.0;
  if (ray.direction.z < -1e-6) {
    t = max((plane_height - ray.origin.z) / ray.direction.z, 0.0);
    if (t > clip_ray(ray, -1e9, 1e9, cut != 0, 0.0).y) t = -1.0;
  }
  RECORDED(heights = 0u; record_search(t >= 0.0, vec2(0.0), vec2(0.0));)
  return t;
}

// How far a ray that meets no solid has to the end of the layers.
float way_out(Ray ray) { return max(clip_to_layer(kEither, ray, 0.0).y, 0.0); }

// A place that light falls on.
struct Place {
  vec3 p, n;
  vec3 mirrored;    // the way on of a ray that is reflected there towards the eye
  float side;       // of the medium's surface: 1 above it, −1 below
  vec3 albedo;      // diffuse
  vec2 shine;       // Phong's: weight and exponent
  bool see_through; // the medium's own surface
};

#ifdef CAUSTICS
// Irradiance under the medium: what its surface gathers here of a light, arriving as through a level one.
vec3 gathered_irradiance(Ray frame, Place place, int i, vec3 to_light) {
  vec3 p = place.p, bent, entry = p;
  float rise = medium_height(tiling * (frame.uv + p.xy * frame.uv_per_metre)) - p.z;
  // Where a near light's ray comes in depends on how it is bent there: by repeated substitution.
  for (int k = kLightKinds[i] == kDirectional ? 3 : 0; k < 4; ++k) {
    if (to_light.z <= 0.0) return vec3(0.0);
    bent = -refract(-to_light, vec3(0.0, 0.0, 1.0), index_ratios.x);
    if (bent.z <= 0.0) return vec3(0.0);
    entry = p + rise / bent.z * bent;
    light_irradiance(i, to_world_point(entry), to_light);
    to_light = to_frame * to_light;
  }
  if (dot(place.n, bent) <= 0.0) return vec3(0.0);
  Ray ray = Ray(p, bent, frame.uv, frame.uv_per_metre);
  if (find_crossing(kSolid, ray, 0.0, 1.0, kLight) >= 0.0) return vec3(0.0);
  // The maps are of the plane at the solid's mean height: where the light through here comes to it.
  vec2 on_plane = uv_at(ray, (plane_height - p.z) / bent.z);
  uint word = caustic_layers[gl_PrimitiveID];
  vec2 half_texel = 0.5 / vec2(textureSize(caustic_maps, 0).xy);
  vec2 inside = clamp(on_plane, half_texel, 1.0 - half_texel);
  if ((word & kRepeatsOverU) == 0u) on_plane.x = inside.x;
  if ((word & kRepeatsOverV) == 0u) on_plane.y = inside.y;
  int layer = i * (textureSize(caustic_maps, 0).z / LIGHT_COUNT) + int(word & kCausticLayer);
  vec3 gathered = textureLod(caustic_maps, vec3(on_plane, float(layer)), 0.0).rgb * frame.uv_per_metre.x *
                  frame.uv_per_metre.y;
  return gathered * (dot(place.n, bent) / bent.z * object_visibility(i, entry, to_light));
}
#endif

// The light that a place sends back of the lights' and the ambient light; the paper's SAMPLE. `occlusion`: of the first light.
vec3 reflected_radiance(Ray frame, Place place, inout float occlusion) {
  vec3 p = place.p, sum = place.albedo * ambient_count.rgb;
#if LIGHT_COUNT > 0
  int i = 0;
  do {
    vec3 to_light;
    vec3 irradiance = light_irradiance(i, to_world_point(p), to_light) * (1.0 / kPi);
    to_light = to_frame * to_light;
    float cosine = dot(place.n, to_light);
    RECORDED(next_search = light_search(turn, i, boundaries);)
    bool straight = true;
#ifdef CAUSTICS
    straight = place.side >= 0.0;
    if (!straight) sum += place.albedo * gathered_irradiance(frame, place, i, to_light) / kPi;
#endif
    bool shown = SHOW == kShowOcclusion && i == 0 && !place.see_through;
    float highlight = phong(place.shine, place.mirrored, to_light);
    bool answers = cosine > 0.0 && (!place.see_through || highlight >= 1e-4 || place.albedo != vec3(0.0));
    if (straight && (answers || shown)) {
      vec3 share = light_reaching(frame, p, to_light, place.side) * object_visibility(i, p, to_light);
      if (shown) occlusion = max(share.r, max(share.g, share.b));
      if (cosine > 0.0) sum += irradiance * share * (place.albedo * cosine + highlight);
    }
  } while (++i < LIGHT_COUNT);
#endif
  return sum;
}

// A point of the solid that is seen along `v`.
Place solid_place(Ray frame, vec3 p, vec3 v) {
  FETCHED(1);
  vec2 at = tiling * (frame.uv + p.xy * frame.uv_per_metre);
  vec3 n = solid_normal(at, frame.uv_per_metre);
  vec3 albedo = solid_albedo * tint * textureLod(solid_colors, at, 0.0).rgb;
  return Place(p, n, reflect(v, n), medium_height(at) > p.z ? -1.0 : 1.0, albedo, solid_phong, false);
}

#ifdef SCATTERING
// The share of the solid's radiance, met after `t`, that is seen through a path in the medium: a part of it sharp, a part
// blurred over as much of the solid as the Gaussian spreads it, a part as its mean. Blurred are the solid's colours, not
// its light.
vec3 through_scattering(Ray ray, float t, float path) {
  vec2 at = uv_at(ray, t) * tiling;
  vec2 texels_per_metre = vec2(textureSize(solid_colors, 0)) * tiling * ray.uv_per_metre;
  float texels = max(texels_per_metre.x, texels_per_metre.y);
  vec3 here = max(textureLod(solid_colors, at, 0.0).rgb, vec3(1e-4)), seen = vec3(0.0);
  for (int c = 0; c < 3; ++c) {
    vec4 fit = transfer_row(extinction[c] * path, c);
    float lod = log2(max(path * tan(min(fit.z, 1.4)) * texels, 1.0));
    float blurred = textureLod(solid_colors, at, lod)[c], mean = textureLod(solid_colors, at, 16.0)[c];
    seen[c] = fit.x + (fit.y * blurred + fit.w * mean) / here[c];
  }
  return seen;
}
#endif

#ifdef TWO_LAYERS
// The medium's surface at `p` as lights see it.
bool shines(vec3 p, vec3 n, vec3 mirrored) {
  bool any_light = false;
#if LIGHT_COUNT > 0
  int i = 0;
  do {
    vec3 to_light;
    light_irradiance(i, to_world_point(p), to_light);
    to_light = to_frame * to_light;
    if (dot(mirrored, to_light) >= least_shine && dot(n, to_light) > 0.0) any_light = true;
  } while (++i < LIGHT_COUNT);
#endif
  return any_light && SHOW == kShowRadiance;
}
#endif

// Radiance seen along `v` at its hit `p`: the solid, or on the medium's surface what comes through it, what it reflects from
// the solid or the environment, and the lights' own reflections. First rays are followed, then lights to the places that
// they met; each in one loop, so that a shader holds a search once. All loops here test at their end: processors that run
// pixels in step, and llvmpipe, leave a loop when the last pixel does, and one that tests at its begin goes through all of its
// body once more before.
vec3 seen_radiance(Ray frame, vec3 p, vec3 v, bool on_medium, out float occlusion) {
  const int kThrough = 0, kReflection = 1, kSurface = 2;
  int places = 1 << kThrough;  // a bit for each that needs light
  vec3 sum = vec3(0.0), n = vec3(0.0), bent = v, mirrored = v, seen_at = p, reflected_at = p;
  vec3 through = vec3(1.0), ahead = vec3(0.0), back = vec3(0.0), mark = vec3(0.0);
  vec2 surface_shine = vec2(0.0);
  float reflected_share = 0.0;
#ifdef TWO_LAYERS
  int part = 0, parts = 0;
  float seen_after = 0.0, way = -1.0;
  if (on_medium) {
    n = facing(medium_normal(tiling * (frame.uv + p.xy * frame.uv_per_metre), frame.uv_per_metre), v);
    float eta = index_ratios.x;
    reflected_share = fresnel_dielectric(-dot(v, n), eta);
    through = vec3(1.0 - reflected_share);
    bent = refract(v, n, eta);
    mirrored = reflect(v, n);
    surface_shine = vec2(mix(reflected_share, 1.0, intensification) * medium_phong.x, medium_phong.y);
    places = shines(p, n, mirrored) ? 1 << kSurface : 0;
    part = reflected_share < 1.0 ? kThrough : kReflection;
    RECORDED(fragment |= part == kThrough ? kOnMedium : kOnMedium | kOnlyReflected;)
    parts = kReflection + 1;
  }
  if (part < parts) do {
    bool reflection = part == kReflection;
    RECORDED(next_search = part_search(part);)
    Ray ray = Ray(p, reflection ? mirrored : bent, frame.uv, frame.uv_per_metre);
    float t = meet_solid(ray, reflection);
    vec3 color = t < 0.0 ? sky_radiance(to_world_direction(ray.direction)) : vec3(0.0);
    bool solid = t >= 0.0;
#ifdef OBJECTS
    vec3 object_color;
    float end = t < 0.0 ? way_out(ray) : t, reach = !solid && reflection ? object_reach : end;
    float object = meet_object(to_world_point(p), to_world_direction(ray.direction), reach, object_color);
    if (object >= 0.0) {
      color = object_color;
      solid = false;
      if (!reflection) way = object;
    }
#endif
    if (reflection) {
      reflected_at = p + t * mirrored;
      mark = t < 0.0 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
      if (SHOW == kShowReflections) solid = false, color = vec3(0.0);
      sum = reflected_share * color;
    } else {
      seen_at = p + t * bent;
      seen_after = t;
      ahead = color;
    }
    if (solid) places |= 1 << part;
  } while (++part < parts);
#ifdef ABSORPTION
  if (on_medium && reflected_share < 1.0) {
    Ray ray = Ray(p, bent, frame.uv, frame.uv_per_metre);
    RECORDED(next_search = part_search(kThrough) + 1;)
    float leaves = find_crossing(kMedium, ray, 0.0, -1.0, kRefracted);
    if (way < 0.0) way = seen_after < 0.0 ? way_out(ray) : seen_after;
    float inside = leaves < 0.0 ? way : min(leaves, way);
#ifdef SCATTERING
    back = through * scattered_reflectance(inside);
    places |= 1 << kSurface;
    through *= seen_after < 0.0 ? scattered_transmittance(inside) : through_scattering(ray, seen_after, inside);
#else
    through *= transmitted(absorption, inside);
#endif
  }
#endif
  sum += through * ahead;
#endif
  occlusion = 1.0;
  if (places != 0) do {
    int at = findLSB(places);
    places &= places - 1;
    Place place = Place(p, n, mirrored, 1.0, back, surface_shine, true);
    vec3 share = vec3(1.0);
    if (at != kSurface) {
      bool reflection = at == kReflection;
      place = solid_place(frame, reflection ? reflected_at : seen_at, reflection ? mirrored : bent);
      share = reflection ? vec3(reflected_share) : through;
    }
    RECORDED(fragment |= place_word(turn, at == kSurface    ? kSurfacePlace
                                          : at == kThrough ? kThroughPlace
                                                           : kReflectedPlace);)
    float reached = 1.0;
    sum += share * reflected_radiance(frame, place, reached);
    if (at == kThrough) occlusion = reached;
    RECORDED(++turn;)
  } while (places != 0);
  return SHOW == kShowReflections && on_medium ? mix(sum, mark, 0.6) : sum;
}

void main() {
  vec2 metres;
  to_frame = surface_frame(normalize(world_normal), world_over_u, world_over_v, metres);
  vec3 v = to_frame * normalize(world_position - eye);
  v.z = min(v.z, -1e-4);  // an interpolated normal may look away
  v = normalize(v);
  Ray ray = Ray(vec3(0.0), v, mesh_uv, 1.0 / metres);
#if defined(AIR) && !defined(REPORT) && !defined(COUNT)
  vec3 through, beyond;
  int end = bend_through_air(mesh_uv, 1.0 / metres, through, v, beyond);
  if (end == kLeaves) {
#ifdef OBJECTS
    if (meet_object(to_world_point(through), to_world_direction(v), clip_planes.y, beyond) < 0.0)
#endif
      beyond = sky_radiance(to_world_direction(v));
  }
  if (end != kComesDown) {
    radiance = vec4(beyond, 1.0);
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
#if defined(SEPARATE_BOXES) || SEARCH != 0
  {
    float medium = find_crossing(kMedium, ray, 0.0, 1.0, kView);
    t = find_crossing(kSolid, ray, 0.0, 1.0, kView);
    on_medium = medium >= 0.0 && (t < 0.0 || medium < t);
    if (on_medium) t = medium;
  }
#else
  {
    t = find_crossing(kEither, ray, 0.0, 1.0, kView);
    vec2 at = tiling * uv_at(ray, t);
    on_medium = t >= 0.0 && medium_height(at) > solid_height(at);
  }
#endif
#else
  t = find_crossing(kSolid, ray, 0.0, 1.0, kView);
#endif
#if !defined(REPORT) && !defined(COUNT)
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
  vec3 color = vec3(0.0);
  if (t >= 0.0) color = seen_radiance(ray, p, v, on_medium, occlusion);
  if (SHOW == kShowOcclusion) color = vec3(occlusion);
  if (SHOW == kShowSteps) {
    float most = dot(step_counts, vec4(1.0));
    color = vec3(dot(taken, vec4(1.0)) / most);
  }
#ifdef COUNT
  fetch_count = fetches;
  record(0, t < 0.0 ? fragment : fragment | kSeen);
#else
  radiance = vec4(color, 1.0);
#endif
#ifdef AIR
  gl_FragDepth = gl_FragCoord.z;  // where the bent ray ends is not behind what straight rays see there
#else
  // Depth over the distance from the eye is far / (far − near) − c / distance along a ray.
  float at_infinity = clip_planes.y / (clip_planes.y - clip_planes.x);
  float to_mesh = distance(world_position, eye), nearer = to_mesh / (to_mesh + t);
  gl_FragDepth = clamp(at_infinity - (at_infinity - gl_FragCoord.z) * nearer, 0.0, 1.0);
#endif
#endif
}
