// How a fragment's searches are written down, for the bare shader of `pellucid bench translucent_relief`, which makes the same
// fetches. Four words make a group, which that shader reads at once: its own fetches should cost little.

// The first word of the first group: the fragment; then the view ray's search of both layers, or of the medium and of the solid.
const uint kSeen = 1u, kOnMedium = 2u, kOnlyReflected = 4u;
const int kViewSearch = 1;
// By turn, a place that is lit: none, on the medium's surface, or on the solid, where the ray through the medium or the
// reflected one met it.
const int kMostTurns = 3;
const uint kSurfacePlace = 1u, kThroughPlace = 2u, kReflectedPlace = 3u;
uint place_word(int turn, uint place) { return place << (8 + 2 * turn); }
uint place_of(uint fragment, int turn) { return (fragment >> (8 + 2 * turn)) & 3u; }

// The second group: of the ray through the medium (0) or the reflected one (1), the solid's search and the medium's.
int part_search(int part) { return 4 + 2 * part; }

// From the third group on, by turn and light: the solid's search and up to `boundaries` of the medium.
int light_search(int turn, int light, int boundaries) {
  return 8 + 4 * (turn * LIGHT_COUNT + light) * ((4 + boundaries) / 4);
}

// A search: how many heights were asked for, whether the layer was met, and how far apart on the map they were, if they
// were spread evenly.
const uint kHeights = 0x7fffu, kMet = 0x8000u;
const float kStepScale = 64.0;
uint search_word(uint heights, bool met, vec2 by) {
  return min(heights, kHeights) | (met ? kMet : 0u) | packSnorm4x8(vec4(0.0, 0.0, kStepScale * by));
}
vec2 step_of(uint search) { return unpackSnorm4x8(search).zw / kStepScale; }
