// Bilinear scaling of a picture.
#include "post/region.glsl"

out vec4 colour;

void main() {
    colour = vec4(region_colour(region_at), 1.0);
}
