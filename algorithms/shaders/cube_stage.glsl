// Which face a vertex goes to.
uniform mat4 world_to_face[6];
#if CUBE_PASS == 2
uniform int cube_face;
void choose_face(vec4 world) { gl_Position = world_to_face[cube_face] * world; }
#elif CUBE_PASS == 1
void choose_face(vec4 world) {
  gl_Layer = gl_InstanceID % 6;
  gl_Position = world_to_face[gl_Layer] * world;
}
#endif
