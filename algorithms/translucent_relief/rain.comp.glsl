// Drops that grow, run and merge, a thread each, in whole numbers: they end as in the C++ twin (algorithms/scene/relief/
// rain.cpp), bit for bit.
layout(local_size_x = 256) in;

struct Drop {
  int x, y, radius, life;
};
layout(std430, binding = 0) buffer Drops { Drop result[]; };
uniform int seed;
uniform int count;
uniform int largest;
uniform int fall;
uniform int first_step;  // 0: from the dry start, else from the drops in the buffer
uniform int steps;

const int kUnits = 4096, kMask = kUnits - 1;

shared ivec4 drops[256];     // x, y, radius, life
shared bool smaller[256];    // touches one that takes it
shared int taken_by[256];    // the first that does, or −1

uint mix_bits(uint x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}
int random(int x, int y, int z) {
  uint h = mix_bits(uint(seed) ^ 0x9e3779b9u);
  h = mix_bits(h ^ uint(x));
  h = mix_bits(h ^ (uint(y) * 0x85ebca6bu));
  return int(mix_bits(h ^ (uint(z) * 0xc2b2ae35u)) >> 8);
}

ivec4 born(int index, int life) {
  return ivec4(random(index, life, 1) & kMask, random(index, life, 2) & kMask,
               max(1, largest / 5) + random(index, life, 3) % max(1, largest / 3), life);
}

int apart(int a, int b) { return ((a - b + kUnits / 2) & kMask) - kUnits / 2; }

bool touching(ivec4 a, ivec4 b) {
  int dx = apart(a.x, b.x), dy = apart(a.y, b.y), reach = 3 * (a.z + b.z) / 4;
  return dx * dx + dy * dy < reach * reach;
}

void move(inout ivec4 drop, int index, int step) {
  if ((step + index) % 8 == 0) drop.z = min(drop.z + 1, largest);
  int sticks = largest / 2;
  if (drop.z <= sticks) return;
  drop.y = (drop.y - 1 - (drop.z - sticks) * fall / 16) & kMask;
  drop.x = (drop.x + random(index, drop.y >> 6, 4) % 3 - 1) & kMask;
}

void main() {
  int i = int(gl_LocalInvocationID.x);
  bool used = i < count;
  if (used) {
    Drop last = result[i];
    drops[i] = first_step == 0 ? born(i, 0) : ivec4(last.x, last.y, last.radius, last.life);
  }
  for (int step = first_step; step < first_step + steps; ++step) {
    if (used) move(drops[i], i, step);
    barrier();
    ivec4 own = used ? drops[i] : ivec4(0);
    if (used) {
      bool less = false;
      for (int j = 0; j < count; ++j) {
        ivec4 other = drops[j];
        bool takes = other.z > own.z || (other.z == own.z && j < i);
        less = less || (j != i && takes && touching(own, other));
      }
      smaller[i] = less;
    }
    barrier();
    if (used) {
      taken_by[i] = -1;
      if (smaller[i]) {
        for (int j = count - 1; j >= 0; --j) {
          if (!smaller[j] && touching(drops[j], own)) taken_by[i] = j;
        }
      }
    }
    barrier();
    ivec4 next = own;
    if (used) {
      if (taken_by[i] >= 0) {
        next = born(i, own.w + 1);
      } else if (!smaller[i]) {
        uint volume = uint(own.z * own.z * own.z);
        for (int j = 0; j < count; ++j) {
          if (taken_by[j] == i) volume += uint(drops[j].z * drops[j].z * drops[j].z);
        }
        while (next.z < largest && uint((next.z + 1) * (next.z + 1) * (next.z + 1)) <= volume) ++next.z;
      }
    }
    barrier();
    if (used) drops[i] = next;
    barrier();
  }
  if (used) result[i] = Drop(drops[i].x, drops[i].y, drops[i].z, drops[i].w);
}
