// Skinning by joints and morph targets (glTF 2.0); transform feedback into the vertex buffer that all passes draw from.
// SETS: number of attributes of four joints each. DUAL: blends dual quaternions (Kavan et al. 2008), else matrices.
// MORPHS: has morph targets.
layout(std140, binding = 11) uniform Palette {
    vec4 rows[4096];
};

in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
in uvec4 in_joints0;
in vec4 in_weights0;
#if SETS > 1
in uvec4 in_joints1;
in vec4 in_weights1;
#endif
#if SETS > 2
in uvec4 in_joints2;
in vec4 in_weights2;
#endif
#if SETS > 3
in uvec4 in_joints3;
in vec4 in_weights3;
#endif

out vec3 bent_position;
out vec3 bent_normal;
out vec2 bent_uv;

#ifdef MORPHS
layout(binding = 24) uniform sampler2D deltas;
uniform int vertices;
uniform int moved;
uniform vec2 morphs[64];

vec3 delta(int target, int what) {
    int texel = (2 * target + what) * vertices + gl_VertexID;
    int across = textureSize(deltas, 0).x;
    return texelFetch(deltas, ivec2(texel % across, texel / across), 0).xyz;
}
#endif

#ifdef DUAL
vec4 turn = vec4(0.0), shift = vec4(0.0), heaviest;

void mix_joint(uint joint, float weight) {
    vec4 real = rows[2u * joint];
    float share = dot(real, heaviest) < 0.0 ? -weight : weight;
    turn += share * real;
    shift += share * rows[2u * joint + 1u];
}

vec3 turned(vec3 v) {
    vec3 t = 2.0 * cross(turn.xyz, v);
    return v + turn.w * t + cross(turn.xyz, t);
}
#else
vec4 row0 = vec4(0.0), row1 = vec4(0.0), row2 = vec4(0.0);

void mix_joint(uint joint, float weight) {
    row0 += weight * rows[3u * joint];
    row1 += weight * rows[3u * joint + 1u];
    row2 += weight * rows[3u * joint + 2u];
}
#endif

void mix_four(uvec4 joints, vec4 weights) {
    mix_joint(joints.x, weights.x);
    mix_joint(joints.y, weights.y);
    mix_joint(joints.z, weights.z);
    mix_joint(joints.w, weights.w);
}

void main() {
    vec3 position = in_position, normal = in_normal;
#ifdef MORPHS
    for (int k = 0; k < moved; k++) {
        position += morphs[k].y * delta(int(morphs[k].x), 0);
        normal += morphs[k].y * delta(int(morphs[k].x), 1);
    }
#endif
#ifdef DUAL
    heaviest = rows[2u * in_joints0.x];
#endif
    mix_four(in_joints0, in_weights0);
#if SETS > 1
    mix_four(in_joints1, in_weights1);
#endif
#if SETS > 2
    mix_four(in_joints2, in_weights2);
#endif
#if SETS > 3
    mix_four(in_joints3, in_weights3);
#endif
#ifdef DUAL
    float scale = inversesqrt(dot(turn, turn));
    turn *= scale;
    shift *= scale;
    vec3 moved_by = 2.0 * (turn.w * shift.xyz - shift.w * turn.xyz + cross(turn.xyz, shift.xyz));
    bent_position = turned(position) + moved_by;
    normal = turned(normal);
#else
    vec4 point = vec4(position, 1.0);
    bent_position = vec3(dot(row0, point), dot(row1, point), dot(row2, point));
    // Normals transform by the cofactor matrix, for joints with scale; of a rotation it is the rotation itself.
    normal = vec3(
        dot(cross(row1.xyz, row2.xyz), normal), dot(cross(row2.xyz, row0.xyz), normal), dot(cross(row0.xyz, row1.xyz), normal)
    );
#endif
    float size = length(normal);
    bent_normal = size > 0.0 ? normal / size : vec3(0.0);
    bent_uv = in_uv;
}
