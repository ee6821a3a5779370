// One material: its uniforms and textures.
#include "common/material_block.glsl"

#ifdef TEXTURED
layout(binding = 0) uniform sampler2D base_texture;
#endif
#ifdef NORMAL_MAP
layout(binding = 5) uniform sampler2D normal_texture;
#endif
#ifdef SURFACE_MAP
layout(binding = 6) uniform sampler2D surface_texture;
#endif
#ifdef OCCLUSION_MAP
layout(binding = 7) uniform sampler2D occlusion_texture;
#endif
#ifdef EMISSION_MAP
layout(binding = 8) uniform sampler2D emission_texture;
#endif

const int BASE = 0, NORMAL = 1, SURFACE = 2, OCCLUSION = 3, EMISSION = 4;

#ifdef SECOND_UV
in vec2 second_uv;              // texture coordinates of the maps whose bits are set in SECOND_UV
#endif

vec2 map_place(int map, vec2 uv) {
#ifdef SECOND_UV
    if ((SECOND_UV >> map & 1) != 0) uv = second_uv;
#endif
#ifdef UV_TRANSFORMS
    vec3 at = vec3(uv, 1.0);
    uv = vec2(dot(uv_rows[2 * map].xyz, at), dot(uv_rows[2 * map + 1].xyz, at));
#endif
    return uv;
}

vec4 material_colour(vec4 tint, vec2 uv) {
    vec4 colour = tint;
#ifdef TEXTURED
    colour *= texture(base_texture, map_place(BASE, uv));
#endif
    return colour;
}

#ifdef MASKED
// Covers the share of the pixel's samples that a masked surface has there: its edge is as smooth as that of a triangle.
void cover_samples(float alpha) {
    float share = clamp((alpha - emission.w) / max(fwidth(alpha), 1e-3) + 0.5, 0.0, 1.0);
    int samples = int(share * float(gl_NumSamples) + 0.5);
    if (samples == 0) discard;
    gl_SampleMask[0] = (1 << samples) - 1;
}
#endif

// Metallic and roughness.
vec2 material_finish(vec2 uv) {
    vec2 figures = metallic_roughness.xy;
#ifdef SURFACE_MAP
    figures *= texture(surface_texture, map_place(SURFACE, uv)).bg;
#endif
    return figures;
}

// Baked visibility of the sky.
float material_occlusion(vec2 uv) {
#ifdef OCCLUSION_MAP
    return 1.0 + map_strength.y * (texture(occlusion_texture, map_place(OCCLUSION, uv)).r - 1.0);
#else
    return 1.0;
#endif
}

vec3 material_emission(vec2 uv) {
#ifdef EMISSION_MAP
    return emission.rgb * texture(emission_texture, map_place(EMISSION, uv)).rgb;
#elif defined(EMISSIVE)
    return emission.rgb;
#else
    return vec3(0.0);
#endif
}

#ifdef NORMAL_MAP
// Tangent frame from screen-space derivatives of position and texture coordinates (Mikkelsen 2010), so that meshes need
// no tangents. Unnormalised tangents keep the ratio of slopes; u grows along the tangent, v against the bitangent.
vec3 material_normal(vec3 normal, vec3 position, vec2 uv) {
    vec2 place = map_place(NORMAL, uv);
    vec3 along_x = dFdx(position), along_y = dFdy(position);
    vec2 step_x = dFdx(place), step_y = dFdy(place);
    vec3 across_x = cross(normal, along_x), across_y = cross(along_y, normal);
    vec3 tangent = across_y * step_x.x + across_x * step_y.x;
    vec3 bitangent = across_y * step_x.y + across_x * step_y.y;
    float largest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    vec3 slope = 2.0 * texture(normal_texture, place).xyz - 1.0;
    slope.xy *= map_strength.x;
    float scale = inversesqrt(max(largest, 1e-30));
    return normalize(scale * (tangent * slope.x - bitangent * slope.y) + normal * slope.z);
}
#endif
