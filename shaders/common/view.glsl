// Uniforms of one view, shared by all passes, filled by rendering/visual/view_block.py: same order, std140.
// Frame "eye": world axes, origin at the camera or between two eyes, metres. No shader assumes a symmetric frustum.

#ifdef EYES_BY_VIEWPORT
#extension GL_ARB_shader_viewport_layer_array : enable
#endif

#define MAX_LIGHTS 8

layout(std140, binding = 0) uniform ViewBlock {
    mat4 clip_from_eyes[2];     // of the eye; of the other one too where one pass draws both
    vec4 sun_right;             // across the sun's rays, unit; w: half the width of a map to be sampled [texel]
    vec4 sun_up;                // across both, unit; w: width of a map in the atlas [texel]
    vec4 sun_map[4];            // place of the eye in the atlas [texel], texels per metre; w: unused
    mat4 spot_from_eye[4];      // tile coordinates and depth of spot lights, before the division by w
    vec4 spot_tile[4];          // corner and width in the atlas [texel], width of a texel at 1 m [m]
    vec4 tangents;              // left, right, bottom, top
    vec4 axis_right;            // axis of the camera in the world; w: origin of the frame "eye" in the world, x
    vec4 axis_up;               //                          w: y
    vec4 axis_back;             //                          w: z
    vec4 sun_direction;         // unit, towards the sun; w: depth per metre
    vec4 sun_colour;            // linear; 1 makes a white surface facing it white; w: depth of the eye
    vec4 sky_zenith;            // linear radiance; w: exposure
    vec4 sky_horizon;           // w: unused
    vec4 sky_ground;            // w: 1 for the neutral tone map, 0 for none
    vec4 sky_light[3];          // ambient irradiance: coefficients of 1, of the normal's height, of its square
    vec4 ambient;               // factor on the sky's light on surfaces; w: unused
    vec4 shadow;                // tone of modulative shadows or 0; texel of the atlas [uv]; turns of its filter; w: unused
    vec4 fog_colour;            // linear; w: unused
    vec4 fog_figures;           // density [1/m], start [m], kind: 0 squared, 1 exponential, 2 linear
    vec4 light_position[MAX_LIGHTS];   // eye frame; w: range [m], 0 for unlimited
    vec4 light_colour[MAX_LIGHTS];     // linear, at 1 m; w: cosine of the outer cone, -2 for a point light
    vec4 light_direction[MAX_LIGHTS];  // unit, along its rays; w: cosine of the inner cone
    vec4 light_shadow[MAX_LIGHTS];     // x: number of its shadow map, -1 for none
    vec4 eye_places[2];                // positions of the eyes in the frame "eye"; w of the first: number of the only
                                       // eye drawn, negative: both, in alternating instances
};

#define clip_from_eye clip_from_eyes[0]

vec3 eye_position_world() {
    return vec3(axis_right.w, axis_up.w, axis_back.w);
}
