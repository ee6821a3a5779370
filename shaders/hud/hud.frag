// Rounded box, glyph from a signed distance field (Green 2007), or image. Each is a variant: software renderers pay for
// the texture that a box does not have.
#if defined(GLYPHS)
layout(binding = 2) uniform sampler2D glyphs;           // signed distance, 0.5 on the outline

uniform float glyph_spread;     // distance from 0 to 1 in the atlas [atlas px]
#elif defined(IMAGES)
layout(binding = 3) uniform sampler2DArray images;      // display values
#endif

in vec2 at;
in vec2 uv;
flat in vec2 half_size;
flat in vec4 box_tint;
flat in vec4 box_style;
out vec4 colour;

#ifdef GLYPHS
float coverage() {
    vec2 texels = vec2(textureSize(glyphs, 0));
    vec2 step_x = dFdx(uv) * texels, step_y = dFdy(uv) * texels;
    float texels_per_pixel = max(0.5 * (length(step_x) + length(step_y)), 1e-6);
    float away = (texture(glyphs, uv).r - 0.5) * glyph_spread / texels_per_pixel;
    return clamp(away + 0.5, 0.0, 1.0);
}
#else
// Distance to the outline of a rounded box [hud px], negative inside (Quilez).
float rounded_box(vec2 p, vec2 size, float radius) {
    vec2 q = abs(p) - size + radius;
    return min(max(q.x, q.y), 0.0) + length(max(q, 0.0)) - radius;
}

float coverage() {
    float pixels_per_unit = 1.0 / max(length(vec2(dFdx(at.x), dFdy(at.x))), 1e-6);
    float outside = rounded_box(at, half_size, box_style.y) * pixels_per_unit;
    float inside = clamp(0.5 - outside, 0.0, 1.0);
    float border = box_style.z * pixels_per_unit;
    float hollow = border > 0.0 ? clamp(0.5 + outside + border, 0.0, 1.0) : 1.0;
    return inside * hollow;
}
#endif

void main() {
    vec4 ink = box_tint;
#ifdef IMAGES
    ink *= texture(images, vec3(uv, box_style.w));
#endif
    colour = vec4(ink.rgb, ink.a * coverage());
}
