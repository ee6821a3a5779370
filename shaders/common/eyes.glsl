// Which eye a vertex is drawn for and where that puts it.
#include "common/both_eyes.glsl"

invariant gl_Position;
flat out vec4 eye_seen;         // of that eye its place, frame "eye"; w: its number

void put_at(vec3 position_eye) {
    eye_seen = vec4(eye_places[EYE].xyz, float(EYE));
    gl_Position = put_for_eye(clip_from_eyes[EYE] * vec4(position_eye, 1.0));
}
