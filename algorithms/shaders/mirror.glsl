// A mirror or a metal; algorithms/raster/mirror.hpp sets the uniforms.
#include "algorithms/shaders/optics.glsl"

uniform vec3 reflectance;
uniform bool metal;
uniform vec3 metal_n;
uniform vec3 metal_k;

// Reflected share of light that meets the surface at this cosine.
vec3 mirror_share(float cosine) {
  return metal ? reflectance * fresnel_metal(cosine, metal_n, metal_k) : reflectance;
}
