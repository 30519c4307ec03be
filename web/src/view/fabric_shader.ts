// What a fabric's surface adds to three.js's physical shading, by the chunk of its program that it takes the place of.
import { ShaderChunk } from "three";
import { occlusion, studio } from "./studio_shader";
import { weaveParameters } from "./weave_shader";

/// A program with chunks replaced.
export const spliced = (program: string, chunks: Record<string, string>): string =>
  Object.entries(chunks).reduce((text, [name, code]) => text.replace(`#include <${name}>`, () => code), program);

export const fabricFragments: Record<string, string> = {
  common: `#include <common>\n${occlusion}\nuniform float shines;\n${weaveParameters}`,
  // The side that is seen. Where a fold is finer than its triangles the smooth normal knows better than they do.
  color_fragment: /* glsl */ `
    bool front = gl_FrontFacing;
    #ifndef FLAT_SHADED
      float towards = dot(normalize(vNormal), normalize(vViewPosition));
      if (abs(towards) > 0.3) front = towards > 0.0;
    #endif
    #ifdef THREADS
      vec2 threads = vCloth / pitch;
      float share = seen(threads);
      Thread thread = threadAt(threads, share);
    #else
      float share = 0.0;
      Thread thread = Thread(vec2(0.0), 0.62, 1.0);
    #endif
    diffuseColor.rgb = coloured > 0.5 ? fieldColor() : fabricColor(diffuseColor.rgb, front, thread, share);`,
  roughnessmap_fragment: /* glsl */ `
    float roughnessFactor = front ? roughness : mix(roughness, 1.0, 0.8 * backness);
    if (coloured > 0.5) roughnessFactor = 1.0;`,
  normal_fragment_begin: ShaderChunk.normal_fragment_begin.replace("gl_FrontFacing", "front"),
  // Threads lean along the axes of the texture, which the derivatives tell (Schueler 2007, Normal mapping without
  // precomputed tangents).
  normal_fragment_maps: /* glsl */ `
    #ifdef THREADS
    vec3 ex = dFdx(-vViewPosition), ey = dFdy(-vViewPosition);
    vec2 tx = dFdx(vCloth), ty = dFdy(vCloth);
    vec3 across = cross(ey, normal), along = cross(normal, ex);
    vec3 u = across * tx.x + along * ty.x, v = across * tx.y + along * ty.y;
    float scale = inversesqrt(max(max(dot(u, u), dot(v, v)), 1e-20));
    normal = normalize(normal - relief * faceDirection * scale * (thread.slope.x * u + thread.slope.y * v));
    #endif`,
  lights_physical_fragment: /* glsl */ `
    #include <lights_physical_fragment>
    if (coloured > 0.5) material.sheenColor = material.specularColor = material.specularColorBlended = vec3(0.0);`,
  lights_physical_pars_fragment: `#include <lights_physical_pars_fragment>\n${studio}`,
  lights_fragment_maps: /* glsl */ `
    radiance += studio(inverseTransformDirection(reflect(-geometryViewDir, geometryNormal), viewMatrix), material.roughness);`,
  aomap_fragment: /* glsl */ `
    float kept = front ? vShade.x : vShade.y;
    float open = skyLeft(vWorld, inverseTransformDirection(normal, viewMatrix)) * (1.0 - kept);
    reflectedLight.directDiffuse *= 1.0 - 0.4 * kept;  // and what folds hide in less than a pixel of the shadow map
    reflectedLight.indirectDiffuse *= open;
    reflectedLight.indirectSpecular *= open;
    sheenSpecularIndirect *= open;`,
  opaque_fragment: /* glsl */ `
    if (coloured > 0.5) {
      outgoingLight = mix(outgoingLight, diffuseColor.rgb, 0.35);  // light and shade must not hide what a colour means
    } else {
      #if NUM_DIR_LIGHTS > 0  // light that comes through from behind
        float behind = max(-dot(nonPerturbedNormal, directionalLights[0].direction), 0.0);
        outgoingLight += diffuseColor.rgb * directionalLights[0].color * RECIPROCAL_PI * (0.12 + shines) * behind * open;
      #endif
    }
    #include <opaque_fragment>`,
};
