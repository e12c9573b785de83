// Wyman 2005, Sec. 3: refraction in, the far side by two depths, refraction out.
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/optics.glsl"

in vec3 world_position;
in vec3 world_normal;
in float normal_depth_m;

layout(binding = 1) uniform sampler2D far_side;  // outward normal N2 and distance from the eye; the latter 0 outside
uniform vec3 eye;
uniform mat4 world_to_clip;
uniform float ior;
uniform vec3 absorption;

layout(location = 0) out vec4 radiance;

void main() {
  vec3 to_point = world_position - eye;
  float distance_to_point = length(to_point);
  vec3 v = to_point / distance_to_point;
  vec3 n1 = normalize(world_normal);
  // Interpolated, a normal may look away at the silhouette: there the ray grazes.
  float cosine = max(-dot(v, n1), 0.0);
  float eta = 1.0 / ior;

  float reflected_share = fresnel_dielectric(cosine, eta);
  vec3 color = reflected_share * environment_radiance(reflect(v, n1));
  vec3 t1 = refract(v, n1, eta);
  if (reflected_share < 1.0 && t1 != vec3(0.0)) {
    // d_V: how deep the object is along the line of sight.
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float view_depth = max(texelFetch(far_side, pixel, 0).w - distance_to_point, 0.0);
    float d = view_depth;
#ifdef NORMAL_DEPTH
    // d = (θt/θi) d_V + (1 − θt/θi) d_N: d_V when η = 1, d_N when the ray is bent into the normal. θt/θi → 1/η as θi → 0.
    float incident = acos(min(cosine, 1.0)), transmitted_angle = acos(clamp(-dot(t1, n1), 0.0, 1.0));
    float ratio = incident > 1e-3 ? transmitted_angle / incident : eta;
    d = max(ratio * view_depth + (1.0 - ratio) * normal_depth_m, 0.0);
#endif
    // P2 = P1 + d T1, and N2 where P2 lies on the screen.
    vec4 clip = world_to_clip * vec4(world_position + d * t1, 1.0);
    vec2 uv = 0.5 + 0.5 * clip.xy / clip.w;
    vec4 behind = clip.w > 0.0 ? textureLod(far_side, uv, 0.0) : vec4(0.0);
    // Beyond the silhouette the far side is unknown: there it turns away from the viewer, as at the silhouette itself.
    vec3 sideways = t1 - dot(t1, v) * v;
    vec3 n2 = behind.w > 0.0              ? normalize(behind.xyz)
              : length(sideways) > 1e-6   ? normalize(sideways)
                                          : t1;
    // A normal that looks against the ray belongs to another part of the surface.
    if (dot(n2, t1) < 0.0) n2 = normalize(n2 - 1.0001 * dot(n2, t1) * t1);
    vec3 path = transmitted(absorption, d);
    float inner_cosine = clamp(dot(t1, n2), 0.0, 1.0);
    float sine2 = ior * ior * (1.0 - inner_cosine * inner_cosine);
    if (sine2 < 1.0) {
      vec3 t2 = normalize(ior * t1 - (ior * inner_cosine - sqrt(1.0 - sine2)) * n2);
      float leaving = 1.0 - fresnel_dielectric(inner_cosine, ior);
      color += (1.0 - reflected_share) * leaving * path * environment_radiance(t2);
    } else {
#ifdef REFLECT
      color += (1.0 - reflected_share) * path * environment_radiance(reflect(t1, -n2));
#else
      vec3 along = t1 - inner_cosine * n2;
      color += (1.0 - reflected_share) * path * environment_radiance(normalize(along));
#endif
    }
  }
  radiance = vec4(color, 1.0);
}
