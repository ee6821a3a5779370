// Fast approximate anti-aliasing of the finished picture (FXAA: Lottes 2009), own implementation. An edge is followed
// in both directions to its ends; the pixel's position between them gives its blend with the neighbour across.
//
// Two passes, since software renderers do not branch: FIND copies the picture and marks pixels beside edges as far away,
// and the depth test of the second pass leaves out all others.
#include "post/region.glsl"

out vec4 colour;

const float MIN_CONTRAST = 0.0312;      // in display values, below which a pixel is left as it is
const float SHARE_CONTRAST = 0.125;     // minimum contrast over the brightest neighbour
const float SMOOTHING = 0.75;           // strength for isolated pixels, 0 to 1

#ifndef FIND
// A uniform prevents unrolling: the loop ends as soon as all pixels of a group have found both ends, in a third of the
// time on a software renderer.
uniform float steps;
#endif

float luma(vec3 display) {
    return dot(display, vec3(0.299, 0.587, 0.114));
}

// Luma between texels, `at` in texels.
float luma_between(vec2 at) {
    return luma(region_colour(at));
}

float luma_at(ivec2 texel) {
    ivec2 first = ivec2(region.xy);
    return luma(texelFetch(picture, clamp(texel, first, first + ivec2(region.zw) - 1), 0).rgb);
}

void main() {
    vec2 at = region_at;
    ivec2 t = ivec2(at);
    vec3 own = texelFetch(picture, t, 0).rgb;
    float middle = luma(own);
    float south = luma_at(t + ivec2(0, -1)), north = luma_at(t + ivec2(0, 1));
    float west = luma_at(t + ivec2(-1, 0)), east = luma_at(t + ivec2(1, 0));
    float brightest = max(middle, max(max(south, north), max(west, east)));
    float contrast = brightest - min(middle, min(min(south, north), min(west, east)));
    bool plain = contrast < max(MIN_CONTRAST, SHARE_CONTRAST * brightest);
#ifdef FIND
    colour = vec4(own, 1.0);
    gl_FragDepth = plain ? 0.0 : 1.0;
#else

    float south_west = luma_at(t + ivec2(-1, -1)), south_east = luma_at(t + ivec2(1, -1));
    float north_west = luma_at(t + ivec2(-1, 1)), north_east = luma_at(t + ivec2(1, 1));
    float level = abs(south_west + north_west - 2.0 * west) + 2.0 * abs(south + north - 2.0 * middle)
        + abs(south_east + north_east - 2.0 * east);
    float upright = abs(south_west + south_east - 2.0 * south) + 2.0 * abs(west + east - 2.0 * middle)
        + abs(north_west + north_east - 2.0 * north);
    bool horizontal = level >= upright;
    float before = horizontal ? south : west, behind = horizontal ? north : east;
    bool towards_before = abs(before - middle) >= abs(behind - middle);
    vec2 across = (horizontal ? vec2(0.0, 1.0) : vec2(1.0, 0.0)) * (towards_before ? -1.0 : 1.0);
    vec2 along = horizontal ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
    float border = 0.5 * (middle + (towards_before ? before : behind));
    float jump = 0.25 * max(abs(before - middle), abs(behind - middle));

    // On the border between both pixels luma is constant until the edge ends.
    vec2 line = at + 0.5 * across;
    float back = 0.0, ahead = 0.0, back_end = 0.0, ahead_end = 0.0;
    bool back_found = false, ahead_found = false;
    for (int i = 0; i < int(steps) && !(back_found && ahead_found); ++i) {
        float step = i < 4 ? 1.0 : i < 9 ? 2.0 : 4.0;
        if (!back_found) {
            back += step;
            back_end = luma_between(line - back * along) - border;
            back_found = abs(back_end) >= jump;
        }
        if (!ahead_found) {
            ahead += step;
            ahead_end = luma_between(line + ahead * along) - border;
            ahead_found = abs(ahead_end) >= jump;
        }
    }
    bool nearer_back = back < ahead;
    bool consistent = ((nearer_back ? back_end : ahead_end) < 0.0) != (middle < border);
    // The edge ends half a pixel before the first sample beyond it.
    float from_edge = consistent ? 0.5 - (min(back, ahead) - 0.5) / (back + ahead - 1.0) : 0.0;

    float mean = (2.0 * (south + north + west + east) + south_west + south_east + north_west + north_east) / 12.0;
    // Beside a straight edge the mean differs by a third of the contrast: only more than that marks an isolated pixel.
    float isolated = clamp(1.5 * abs(mean - middle) / contrast - 0.5, 0.0, 1.0);
    colour = vec4(region_colour(at + max(from_edge, SMOOTHING * isolated) * across), 1.0);
#endif
}
