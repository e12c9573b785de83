// Pieces of a volume's box, and with each vertex what its viewing ray needs (medium_ray.glsl).
#include "algorithms/shaders/shadows.glsl"
#define MEDIUM_RAY out
#include "algorithms/shaders/medium_ray.glsl"

layout(location = 0) in vec3 position;  // local coordinates

uniform mat4 local_to_clip;
uniform mat4 volume_to_world;
uniform mat4 world_to_local;
uniform vec3 eye;
uniform float volume_extinction;
uniform vec3 volume_albedo;
uniform vec3 volume_emission;
uniform float path_sample_offset;  // of techniques that take several points on a path
uniform int path_sample_count;
#ifdef UNIFORM_SOURCE
uniform vec3 uniform_source;  // no light depends on the place, so neither does C0: it is computed once
#endif
#ifdef TRANSFER
uniform vec2 transfer_scale_offset;
#endif

flat out float sample_offset;
flat out int sample_count;

void main() {
  sample_offset = path_sample_offset;
  sample_count = path_sample_count;
  local = position;
  gl_Position = local_to_clip * vec4(position, 1.0);
#ifdef CLIP_AT_NEAR_PLANE
  gl_ClipDistance[0] = gl_Position.z + gl_Position.w;
#endif
  from_eye = (volume_to_world * vec4(position, 1.0)).xyz - eye;
  local_from_eye = mat3(world_to_local) * from_eye;
  metres = from_eye * mat3(volume_to_world);
  map_extinction = volume_extinction;
#ifdef TRANSFER
  transfer_place = transfer_scale_offset;
#endif
#ifdef UNIFORM_SOURCE
  source_everywhere = uniform_source;
#else
  emitted = volume_emission;
  scattered_ambient = volume_albedo * ambient_count.rgb;
#endif
#if MEDIUM_LIGHTS > 0
  for (int k = 0; k < MEDIUM_LIGHTS; ++k) {
    const int i = FIRST_LIGHT + k;
    Light light = lights[i];
    vec3 intensity = light.intensity_inner.rgb;
    float greatest = max(intensity.r, max(intensity.g, intensity.b));
    scattered_light[k] = vec4(volume_albedo * intensity / (4.0 * kPi), max(greatest / kGreatestIrradiance, 1e-12));
    place_from_eye[k] = light_place(i, vec4(from_eye, 0.0));
    eye_place[k] = light_place(i, vec4(eye, 1.0));
    eye_from_light[k] = eye - light.position_kind.xyz;
    float scale = 1.0 / max(light.intensity_inner.w - light.direction_outer.w, 1e-6);
    cone_range[k] = vec4(scale, -light.direction_outer.w * scale, 0.0, 0.0);
#ifdef SHADOWS
    cone_range[k].zw = shadows[i].range.xy;
    shadow_settings = bleeding_variance.xyz;
#endif
  }
#endif
}
