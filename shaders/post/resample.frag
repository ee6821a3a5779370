// Bilinear scaling of a picture. WHOLE: the region is the texture, whose sampler clamps by itself.
#include "post/region.glsl"

in vec2 picture_at;
out vec4 colour;

void main() {
#ifdef WHOLE
    // Nothing but a sample at an interpolated position: llvmpipe then scales in integers, three times as fast.
    colour = texture(picture, picture_at);
#else
    colour = region_texel(region_at);
#endif
}
