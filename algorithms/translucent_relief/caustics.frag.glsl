// Light of a part of the medium's surface, spread over as much of the solid as it falls on.
in vec2 source;
in vec3 power;

uniform float resolution;

layout(location = 0) out vec4 gathered;  // power on a unit of the mesh's texture

void main() {
  vec2 x = dFdx(source), y = dFdy(source);
  gathered = vec4(power * abs(x.x * y.y - x.y * y.x) * resolution * resolution, 1.0);
}
