// What one view shares between all passes. Filled by rendering/visual/view_block.py: same order, std140.
// Frame "eye": world axes, origin at the eye, metres. No shader assumes a symmetric frustum.

#ifdef EYES_BY_VIEWPORT
#extension GL_ARB_shader_viewport_layer_array : enable
#endif

#define MAX_LIGHTS 8

layout(std140, binding = 0) uniform ViewBlock {
    mat4 clip_from_eyes[2];     // of the eye; of the other one too where both are drawn together
    vec4 sun_right;             // across the sun's rays, unit; w: half of a map that may be asked [texel]
    vec4 sun_up;                // across both; w: width of a map's tile in the atlas [texel]
    vec4 sun_map[4];            // middle from the eye along the two, half the width that may be asked [m]; w unused
    mat4 spot_from_eye[4];      // the same of spot lights, before the division by w
    vec4 spot_tile[4];          // corner and width in the atlas [texel], texel at 1 m [m]
    vec4 tangents;              // left, right, bottom, top
    vec4 axis_right;            // of the eye, in the world; w: where the eye is in the world, x
    vec4 axis_up;               //                          w: y
    vec4 axis_back;             //                          w: z
    vec4 sun_direction;         // unit, towards the sun; w: depth per metre
    vec4 sun_colour;            // linear; 1 makes a white surface facing it white; w: depth of the eye
    vec4 sky_zenith;            // linear radiance; w: exposure
    vec4 sky_horizon;           // w: unused
    vec4 sky_ground;            // w: 1 for the neutral tone map, 0 for none
    vec4 sky_light[3];          // from all around on surfaces: level, by the height of their normal, by its square
    vec4 ambient;               // rgb: factor on the sky's light on surfaces; w: number of lights below
    vec4 shadow;                // tone of modulative ones or 0, half a texel over half of what a map may be asked, texel of the atlas [uv], its tiles along a side
    vec4 fog_colour;            // linear; w: unused
    vec4 fog_figures;           // density [1/m], start [m], kind: 0 squared, 1 exponential, 2 linear
    vec4 light_position[MAX_LIGHTS];   // eye frame; w: range [m], 0 for unlimited
    vec4 light_colour[MAX_LIGHTS];     // linear, at 1 m; w: cosine of the outer cone, -2 for a point light
    vec4 light_direction[MAX_LIGHTS];  // unit, where it shines; w: cosine of the inner cone
    vec4 light_shadow[MAX_LIGHTS];     // x: number of its map, -1 for none
    vec4 eye_places[2];                // of the eyes in the frame "eye", whose origin is between eyes that share a queue;
                                       // w of the first: which of them is drawn, negative: both, by turns of instances
};

#define clip_from_eye clip_from_eyes[0]

vec3 eye_position_world() {
    return vec3(axis_right.w, axis_up.w, axis_back.w);
}
