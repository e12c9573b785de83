// The map of places (Sec. 5, "uvmap"): where on which receiver's light map a direction ends. In the stead of a normal comes
// the place, in the stead of a colour the area that the unit square of the light map stands for [m²], see caustics.cpp.
in vec3 world_normal;
in vec3 albedo;

layout(location = 0) out vec4 place;  // u, v; receiver and part; area

void main() { place = vec4(world_normal.xy, round(world_normal.z * 1024.0) / 1024.0, albedo.r); }
