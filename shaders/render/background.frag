in float height;
layout(location = 0) out vec4 pixel;

void main() { pixel = vec4(mix(vec3(0.80, 0.82, 0.85), vec3(0.94, 0.95, 0.97), height), 1.0); }
