// Lines of constant width on the screen over a plane or along a surface, fading where they would flicker.

// Coverage of this pixel by lines at integers of `at`, which counts cells.
float line_coverage(float at, float width_px) {
    float per_pixel = max(fwidth(at), 1e-6);
    float away_px = abs(fract(at - 0.5) - 0.5) / per_pixel;
    float crowded = clamp(2.0 - 5.0 * per_pixel, 0.0, 1.0);
    return clamp(0.5 + 0.5 * width_px - away_px, 0.0, 1.0) * crowded;
}

// Lines at every cell and stronger ones at every fifth.
float grid_coverage(vec2 cells) {
    vec2 fifth = cells * 0.2;
    float fine = max(line_coverage(cells.x, 1.0), line_coverage(cells.y, 1.0));
    float coarse = max(line_coverage(fifth.x, 1.4), line_coverage(fifth.y, 1.4));
    return max(0.35 * fine, coarse);
}
