// The values that programs over a volume hand from the vertex to the fragment stage; the includer defines MEDIUM_RAY as `out` or
// `in`. All that is affine in the position is interpolated and all that is constant is handed on flat: a software
// rasteriser reads a flat input with one instruction for all its pixels, and a uniform with several for each of them.

// The lights that medium_source() asks: those from FIRST_LIGHT on.
#if defined(UNIFORM_SOURCE)
#define FIRST_LIGHT 0
#define MEDIUM_LIGHTS 0
#elif defined(LIGHT_SPACE)
#define FIRST_LIGHT LIGHT_SPACE
#define MEDIUM_LIGHTS 1
#else
#define FIRST_LIGHT 0
#define MEDIUM_LIGHTS LIGHT_COUNT
#endif

MEDIUM_RAY vec3 local;
MEDIUM_RAY vec3 from_eye;        // in the world
MEDIUM_RAY vec3 local_from_eye;  // the same in local coordinates
MEDIUM_RAY vec3 metres;          // the same times transpose(mat3(volume_to_world))
flat MEDIUM_RAY float map_extinction;  // φ at 1 in the density map [1/m]; with TRANSFER, of the mapped extinction
#ifdef TRANSFER
flat MEDIUM_RAY vec2 transfer_place;  // scale and offset from the density map to the transfer map
#endif
#ifdef UNIFORM_SOURCE
flat MEDIUM_RAY vec3 source_everywhere;
#else
flat MEDIUM_RAY vec3 emitted;
flat MEDIUM_RAY vec3 scattered_ambient;  // times the volume's albedo
#endif
#if MEDIUM_LIGHTS > 0
flat MEDIUM_RAY vec4 scattered_light[MEDIUM_LIGHTS];  // intensity or irradiance, times albedo / 4π; w: least squared distance
MEDIUM_RAY vec3 place_from_eye[MEDIUM_LIGHTS];        // light_place() of the difference
flat MEDIUM_RAY vec3 eye_place[MEDIUM_LIGHTS];
flat MEDIUM_RAY vec3 eye_from_light[MEDIUM_LIGHTS];
// xy: scale and offset from the cosine to the range of smoothstep; zw: Shadow::range. All of this for four lights must fit
// into the 31 vectors that devices hand from stage to stage.
flat MEDIUM_RAY vec4 cone_range[MEDIUM_LIGHTS];
#ifdef SHADOWS
flat MEDIUM_RAY vec3 shadow_settings;
#endif
#endif
