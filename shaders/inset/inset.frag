// An inset with its border; display values.
layout(binding = 22) uniform sampler2D picture;
uniform float mirrored;         // 1: flipped horizontally

in vec2 uv;
out vec4 colour;

void main() {
    vec2 at = vec2(mirrored > 0.5 ? 1.0 - uv.x : uv.x, uv.y);
    bool inside = all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
    colour = vec4(inside ? textureLod(picture, at, 0.0).rgb : vec3(0.05, 0.06, 0.08), 1.0);
}
