// A hanging cord: centre line in closed form, twist-free frame, ripples with their normals.
// In float64: mimics_app/maths/cord.py.
#include "common/view.glsl"
#include "common/eyes.glsl"
#include "cord/cord_block.glsl"

out vec3 position_eye;
out vec3 normal;
out vec2 at;                    // along [m], around [rad]

const float PI = 3.14159265358979;

// asinh; log(x + sqrt(x^2 + 1)) suffers from cancellation at small x.
float small_asinh(float x) {
    float x2 = x * x;
    float series = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (3.0 / 40.0 - x2 * (15.0 / 336.0))));
    return abs(x) < 0.15 ? series : sign(x) * log(abs(x) + sqrt(x2 + 1.0));
}

// Returns height, slope along, slope around.
vec3 ripple(vec4 tapped, float s, float theta, float radius) {
    float ds = s - tapped.x;
    float turn = mod(theta - tapped.y + PI, 2.0 * PI) - PI;
    float d = sqrt(ds * ds + radius * radius * turn * turn);
    float x = d - waves.x * tapped.z;
    float envelope = tapped.w * exp(-waves.w * d - x * x * waves.z);
    float c = cos(waves.y * x), sn = sin(waves.y * x);
    float slope = -envelope * (waves.y * sn + (waves.w + 2.0 * x * waves.z) * c);
    float safe = max(d, 1e-6);
    return vec3(envelope * c, slope * ds / safe, slope * radius * radius * turn / safe);
}

void main() {
    int sides = int(form.z);
    float rings = form.y;
    float s = start.w * float(gl_VertexID / (sides + 1)) / (rings - 1.0);
    float theta = 2.0 * PI * float(gl_VertexID % (sides + 1)) / float(sides);
    float a = along.w, q = up.w, w = s / a, p = q + w;
    float root_p = sqrt(1.0 + p * p), root_q = sqrt(1.0 + q * q);
    float apart = p * q > 0.0 ? w * (p + q) / (p * root_q + q * root_p) : p * root_q - q * root_p;
    vec3 centre = start.xyz + a * small_asinh(apart) * along.xyz + s * (p + q) / (root_p + root_q) * up.xyz;
    vec3 tangent = (along.xyz + p * up.xyz) / root_p;
    vec3 inside = (up.xyz - p * along.xyz) / root_p;
    vec3 binormal = cross(along.xyz, up.xyz);
    vec3 h = vec3(0.0);
    int taps = int(form.w);
    for (int i = 0; i < taps; ++i) h += ripple(tap[i], s, theta, form.x);
    vec3 outwards = cos(theta) * inside + sin(theta) * binormal;
    vec3 around = cos(theta) * binormal - sin(theta) * inside;
    float r = form.x + h.x;
    float stretch = 1.0 - r * cos(theta) / (a * root_p * root_p);
    normal = outwards - h.y / stretch * tangent - h.z / r * around;
    position_eye = centre + r * outwards;
    at = vec2(s, theta);
    put_at(position_eye);
}
