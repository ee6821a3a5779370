// Lens correction: two pictures side by side to two panels; each pixel samples where its lens shows it,
// per colour (radial distortion: Brown 1971).
#include "post/region.glsl"

uniform vec4 panel_0, panel_1;  // tangents of the panels: left, right, bottom, top
uniform vec4 seen_0, seen_1;    // tangents of the drawn pictures
uniform mat3 lens_0, lens_1;    // columns: k1, k2 of red, then k1 of green; k2, blue's; centre

out vec4 colour;

vec2 bend(vec2 at, vec2 k) {
    float r2 = dot(at, at);
    return at * (1.0 + k.x * r2 + k.y * r2 * r2);
}

float channel(int c, int eye, vec2 at, vec2 centre, vec2 k, vec4 seen) {
    vec2 direction = bend(at - centre, k) + centre;
    vec2 uv = (direction - seen.xz) / (seen.yw - seen.xz);
    vec2 size = vec2(textureSize(picture, 0));
    vec2 half_size = vec2(0.5 * size.x, size.y);
    vec2 texel = clamp(uv * half_size, vec2(0.5), half_size - 0.5) + vec2(float(eye) * half_size.x, 0.0);
    return textureLod(picture, texel / size, 0.0)[c];
}

void main() {
    vec2 place = (region_at - region.xy) / region.zw;
    int eye = place.x < 0.5 ? 0 : 1;
    vec4 panel = eye == 0 ? panel_0 : panel_1;
    vec4 seen = eye == 0 ? seen_0 : seen_1;
    mat3 lens = eye == 0 ? lens_0 : lens_1;
    vec2 uv = vec2(2.0 * place.x - float(eye), place.y);
    vec2 at = mix(panel.xz, panel.yw, uv);
    vec2 centre = lens[2].xy;
    colour = vec4(
        channel(0, eye, at, centre, lens[0].xy, seen),
        channel(1, eye, at, centre, vec2(lens[0].z, lens[1].x), seen),
        channel(2, eye, at, centre, lens[1].yz, seen),
        1.0
    );
}
