// Depths of the shadow atlas as greys, near ones bright; what nothing was drawn to stays dark blue.
layout(binding = 4) uniform sampler2D depths;
uniform float tiles;            // along a side

in vec2 uv;
out vec4 colour;

void main() {
    float depth = texture(depths, uv).r;
    vec2 border = abs(fract(uv * tiles + 0.5) - 0.5) / fwidth(uv * tiles);
    vec3 grey = depth < 1.0 ? vec3(1.0 - 0.85 * depth) : vec3(0.05, 0.07, 0.16);
    bool edge = min(border.x, border.y) < 1.0;
    colour = vec4(edge ? vec3(0.98, 0.76, 0.40) : grey, 0.94);
}
