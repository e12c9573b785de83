// A pixel's entry: depth along the view's axis [m], normal as a point of the octahedron, and a tag of object and cube; tag 0
// where there is none.
const int kCubesOfTag = 16;  // kMaxCubes

float entry_tag(int object_number, int cube) { return float(object_number * kCubesOfTag + cube); }
int tagged_object(float tag) { return int(tag) / kCubesOfTag; }
int tagged_cube(float tag) { return int(tag) % kCubesOfTag; }
