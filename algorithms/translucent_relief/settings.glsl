// The settings that a relief's shaders read, the same for all of a mesh. As uniforms llvmpipe gathers them anew, pixel by
// pixel, wherever a shader reads them, which took a twentieth of a frame; so relief.vert.glsl hands them on, flat, to its
// fragment shaders.
//   solid_range, medium_range   the height [m] of 0, and what is added at 1
//   index_ratios                n1 / n2 and its inverse
//   absorption                  [1/m]
//   step_counts, refinements    of view, reflected, refracted and light rays; whole numbers
//   steps_at_normal             share of the steps that a ray along the normal takes
//   boundaries                  of the medium, that a light ray may pass
//   solid_phong, medium_phong   specular weight and exponent
//   plane_height                of the flat solid that planar rays meet [m]: the solid's mean
//   least_shine                 cosine from which on the medium's highlight counts
//   cut, …_normal_map           1 or 0
//   radiance_scale to ground    as environment.glsl reads them
#define RELIEF_SETTINGS(qualifier)  \
  qualifier vec2 solid_range;       \
  qualifier vec2 medium_range;      \
  qualifier vec2 tiling;            \
  qualifier vec2 index_ratios;      \
  qualifier vec3 absorption;        \
  qualifier vec4 step_counts;       \
  qualifier vec4 refinements;       \
  qualifier float steps_at_normal;  \
  qualifier int boundaries;         \
  qualifier vec3 solid_albedo;      \
  qualifier vec2 solid_phong;       \
  qualifier vec2 medium_phong;      \
  qualifier float intensification;  \
  qualifier float plane_height;     \
  qualifier float least_shine;      \
  qualifier int cut;                \
  qualifier int solid_normal_map;   \
  qualifier int medium_normal_map;  \
  qualifier vec3 eye;               \
  qualifier float radiance_scale;   \
  qualifier vec3 zenith;            \
  qualifier vec3 horizon;           \
  qualifier vec3 ground;

#ifdef UNIFORM_SETTINGS
RELIEF_SETTINGS(uniform)
#else
in Settings { RELIEF_SETTINGS(flat) };
#endif
