// Uniforms of one cord, filled by rendering/visual/passes/cord.py: same order, std140.

#define MAX_TAPS 8

layout(std140, binding = 7) uniform CordBlock {
    vec4 start;                 // eye frame; w: length [m]
    vec4 along;                 // horizontal axis of its plane; w: parameter a [m]
    vec4 up;                    // the axis it sags against; w: slope at the start
    vec4 form;                  // radius [m], rings, sides, taps
    vec4 waves;                 // speed [m/s], wave number [1/m], 1 / width^2 [1/m^2], damping by distance [1/m]
    vec4 colour_roughness;                 // linear RGB; w: roughness
    vec4 ball;                  // centre, eye frame; w: radius [m], 0 for none
    vec4 ball_light;            // unit, towards what casts its shadow; w: softness of the shadow per metre of gap
    vec4 tap[MAX_TAPS];         // along [m], around [rad], age [s], height with its damping by time [m]
};
