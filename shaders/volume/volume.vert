// A shadow volume for one eye or both; vertices at infinity have w = 0 (Everitt and Kilgard 2002).
#include "common/view.glsl"
#include "common/both_eyes.glsl"

uniform mat4 clip_from_volume[EYES];

in vec4 in_corner;

void main() {
    gl_Position = put_for_eye(clip_from_volume[EYE] * in_corner);
}
