// What one view shares between all passes. Filled by rendering/visual/view_block.py: same order, std140.
// Frame "eye": world axes, origin at the eye, metres. No shader assumes a symmetric frustum.

#define MAX_LIGHTS 8

layout(std140, binding = 0) uniform ViewBlock {
    mat4 clip_from_eye;
    mat4 shadow_from_eye;       // to coordinates in the tile and depth of the sun's innermost map, 0 to 1
    vec4 shadow_scale[4];       // from there to the atlas: across, along; depth of a texel; half of what may be asked
    vec4 shadow_offset[4];      // the same; w unused
    vec4 shadow_tile[4];        // middle in the atlas, far away for a map that is not there
    mat4 spot_from_eye[4];      // the same of spot lights, before the division by w
    vec4 spot_tile[4];          // texel [m] at 1 m
    vec4 tangents;              // left, right, bottom, top
    vec4 axis_right;            // of the eye, in the world; w: where the eye is in the world, x
    vec4 axis_up;               //                          w: y
    vec4 axis_back;             //                          w: z
    vec4 sun_direction;         // unit, towards the sun; w: unused
    vec4 sun_colour;            // linear; 1 makes a white surface facing it white
    vec4 sky_zenith;            // linear radiance; w: exposure
    vec4 sky_horizon;           // w: unused
    vec4 sky_ground;            // w: 1 for the neutral tone map, 0 for none
    vec4 ambient;               // rgb: factor on the sky's light on surfaces; w: number of lights below
    vec4 shadow;                // texel of the atlas [uv], tone of modulative shadows or 0, lift across by the normal, unused
    vec4 fog_colour;            // linear; w: unused
    vec4 fog_figures;           // density [1/m], start [m], kind: 0 squared, 1 exponential, 2 linear
    vec4 light_position[MAX_LIGHTS];   // eye frame; w: range [m], 0 for unlimited
    vec4 light_colour[MAX_LIGHTS];     // linear, at 1 m; w: cosine of the outer cone, -2 for a point light
    vec4 light_direction[MAX_LIGHTS];  // unit, where it shines; w: cosine of the inner cone
    vec4 light_shadow[MAX_LIGHTS];     // x: number of its map, -1 for none
};

vec3 eye_position_world() {
    return vec3(axis_right.w, axis_up.w, axis_back.w);
}
