// Opaque objects near and in the medium, as the screen shows them (Timonen, Sec. 6, leaves them to future work).
layout(binding = 11) uniform sampler2D scene_color;
layout(binding = 12) uniform sampler2D scene_depth;
uniform mat4 world_to_clip;
uniform vec2 clip_planes;  // near and far [m]
uniform int object_steps;
uniform float object_reach;  // of reflected rays that leave the relief [m]

// How far behind the objects of the screen a world point lies, by the distance along the view's axis; negative before them,
// and off the screen.
float behind_objects(vec3 world, out vec2 at) {
  vec4 clip = world_to_clip * vec4(world, 1.0);
  at = 0.5 * clip.xy / clip.w + 0.5;
  if (clip.w <= 0.0 || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, vec2(1.0)))) return -1.0;
  float depth = textureLod(scene_depth, at, 0.0).r;
  if (depth >= 1.0) return -1.0;
  return clip.w - clip_planes.x * clip_planes.y / (clip_planes.y - depth * (clip_planes.y - clip_planes.x));
}

// Where a ray of that length passes behind an object, and its radiance there; negative where it does not. A surface that it passes
// far behind is not thick enough to be met. Steps are equal on the screen.
float meet_object(vec3 origin, vec3 direction, float reach, out vec3 color) {
  mat4 rows = transpose(world_to_clip);
  float near = dot(rows[3], vec4(origin, 1.0)), along = dot(rows[3].xyz, direction);  // of the view's axis
  if (near <= clip_planes.x) return -1.0;
  if (along < 0.0) reach = min(reach, (clip_planes.x - near) / along);
  float far = near + reach * along, before = 0.0;
  vec2 at;
  for (int i = 1; i <= object_steps; ++i) {
    float t = reach * near * float(i) / (far * float(object_steps - i) + near * float(i));
    float behind = behind_objects(origin + t * direction, at);
    if (behind >= 0.0 && behind < 2.0 * (t - before)) {
      for (int k = 0; k < 6; ++k) {
        float middle = 0.5 * (before + t);
        vec2 place;
        if (behind_objects(origin + middle * direction, place) >= 0.0) {
          t = middle;
          at = place;
        } else {
          before = middle;
        }
      }
      color = textureLod(scene_color, at, 0.0).rgb;
      return t;
    }
    before = t;
  }
  return -1.0;
}
