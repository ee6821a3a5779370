// Lighting of an opaque surface: sun, point and spot lights, sky. Placed lights decrease with the inverse square of the
// distance, and end at their range (window: Karis 2013).

#ifdef PLACED_LIGHTS
vec3 shine_of_light(int i, vec3 position_eye, Surface s) {
    vec3 to_light = light_position[i].xyz - position_eye;
    float distance2 = max(dot(to_light, to_light), 1e-4);
    vec3 direction = to_light * inversesqrt(distance2);
    float range = light_position[i].w;
    float ratio2 = range > 0.0 ? distance2 / (range * range) : 0.0;
    float window = clamp(1.0 - ratio2 * ratio2, 0.0, 1.0);
    float outer = light_colour[i].w;
    float cone = smoothstep(outer, max(light_direction[i].w, outer + 1e-4), dot(-direction, light_direction[i].xyz));
    float strength = window * window / distance2 * (outer < -1.5 ? 1.0 : cone);
#ifdef SPOT_SHADOWS
    strength *= spot_visibility(i, position_eye, s.normal);
#endif
    return strength * light_colour[i].rgb * reflect_light(s, direction);
}
#endif

vec3 shine_of_sky(Surface s, float roughness) {
#ifdef MATT
    return s.diffuse * sky_irradiance(s.normal);
#else
    vec3 around = sky_irradiance(s.normal);
    vec3 mirrored = environment_share(s.specular, roughness, s.facing);
    vec3 bounce = ambient.rgb * sky_radiance(reflect(-s.view, s.normal));
    return s.diffuse * around + mirrored * mix(bounce, around, roughness);
#endif
}

// sun_share: visibility of the sun; occlusion: visibility of the sky.
vec3 shine(Surface s, float roughness, vec3 position_eye, float sun_share, float occlusion) {
    vec3 light = sun_share * sun_colour.rgb * reflect_light(s, sun_direction.xyz);
#ifdef PLACED_LIGHTS
    // PLACED_LIGHTS is their number. With a loop's variable, software renderers gather every uniform of a light from
    // memory per pixel, and they execute a loop's body at least once.
    light += shine_of_light(0, position_eye, s);
#if PLACED_LIGHTS > 1
    light += shine_of_light(1, position_eye, s);
#endif
#if PLACED_LIGHTS > 2
    light += shine_of_light(2, position_eye, s);
#endif
#if PLACED_LIGHTS > 3
    light += shine_of_light(3, position_eye, s);
#endif
#if PLACED_LIGHTS > 4
    light += shine_of_light(4, position_eye, s);
#endif
#if PLACED_LIGHTS > 5
    light += shine_of_light(5, position_eye, s);
#endif
#if PLACED_LIGHTS > 6
    light += shine_of_light(6, position_eye, s);
#endif
#if PLACED_LIGHTS > 7
    light += shine_of_light(7, position_eye, s);
#endif
#endif
    return light + occlusion * shine_of_sky(s, roughness);
}
