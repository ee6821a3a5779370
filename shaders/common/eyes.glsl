// Position of a vertex for the eye it is drawn for.
#include "common/both_eyes.glsl"

invariant gl_Position;
flat out vec4 eye_seen;         // position of that eye, frame "eye"; w: its number

void put_at(vec3 position_eye) {
    eye_seen = vec4(eye_places[EYE].xyz, float(EYE));
    gl_Position = put_for_eye(clip_from_eyes[EYE] * vec4(position_eye, 1.0));
}
