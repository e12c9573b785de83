flat in float value;
layout(location = 0) out float color;

void main() {
  color = value;
}
