// Metallic-roughness reflectance (glTF 2.0 appendix B): GGX, Smith height-correlated visibility, Schlick Fresnel.

struct Surface {
    vec3 diffuse;       // diffuse albedo
    vec3 specular;      // reflectance at normal incidence
    float alpha;        // roughness squared
    vec3 normal;
    vec3 view;          // unit, towards the camera
    float facing;       // cosine between the two, at least 1e-3
#ifdef SOFT
    vec3 creep;         // wrap of the diffuse light into the shade, as a cosine by colour
#endif
};

#ifdef SOFT
// Subsurface scattering of skin: red light scatters farther than green and blue.
const vec3 CREEP = vec3(0.42, 0.19, 0.12);
// Depth up to which occluders cast no shadow, the scattering distance [m].
const float CREEP_DEPTH = 0.010;
#endif

Surface make_surface(vec3 base, float metallic, float roughness, vec3 normal, vec3 view) {
    Surface s;
    s.diffuse = base * (1.0 - metallic);
    s.specular = mix(vec3(0.04), base, metallic);
    float rough = max(roughness, 0.045);
    s.alpha = rough * rough;
    s.normal = normal;
    s.view = view;
    s.facing = max(dot(normal, view), 1e-3);
#ifdef SOFT
    s.creep = CREEP * map_strength.z;
#endif
    return s;
}

float specular_lobe(Surface s, vec3 light, float incidence) {
    vec3 halfway = normalize(light + s.view);
    float along = clamp(dot(s.normal, halfway), 0.0, 1.0);
    float a2 = s.alpha * s.alpha;
    float spread = along * along * (a2 - 1.0) + 1.0;
    float masked = incidence * sqrt(s.facing * s.facing * (1.0 - a2) + a2);
    float shadowed = s.facing * sqrt(incidence * incidence * (1.0 - a2) + a2);
    return 0.5 * a2 / (spread * spread * (masked + shadowed) + 1e-6);
}

vec3 fresnel(vec3 head_on, float cosine) {
    float away = 1.0 - clamp(cosine, 0.0, 1.0);
    float away2 = away * away;
    return head_on + (1.0 - head_on) * (away2 * away2 * away);
}

// Diffuse irradiance of unit light: Lambert, or wrapped by w as ((c + w) / (1 + w))^(1 + 2 w), which is 1 where Lambert
// is and conserves energy (McAuley 2013).
vec3 arriving(Surface s, float cosine) {
#ifdef SOFT
    return pow(max((cosine + s.creep) / (1.0 + s.creep), vec3(0.0)), 1.0 + 2.0 * s.creep);
#else
    return vec3(clamp(cosine, 0.0, 1.0));
#endif
}

// Radiance reflected towards the camera for unit light from `light`, times the cosine of incidence.
vec3 reflect_light(Surface s, vec3 light) {
    float cosine = dot(s.normal, light);
    vec3 scattered = arriving(s, cosine) * s.diffuse;
#ifdef MATT
    return scattered;
#else
    float incidence = clamp(cosine, 0.0, 1.0);
    vec3 mirrored = fresnel(s.specular, dot(s.view, normalize(light + s.view)));
    return scattered * (1.0 - mirrored) + incidence * mirrored * specular_lobe(s, light, incidence);
#endif
}

// Specular reflectance of a smooth environment: two-term fit of Karis (2014) to the GGX integral.
vec3 environment_share(vec3 head_on, float roughness, float facing) {
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a004 = min(r.x * r.x, exp2(-9.28 * facing)) * r.x + r.y;
    vec2 scale_bias = vec2(-1.04, 1.04) * a004 + r.zw;
    return head_on * scale_bias.x + scale_bias.y;
}
