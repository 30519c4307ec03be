// The cloth's materials: three.js's Lambert shading with vertices decoded from q16 words, woven colour and sheen.
import {
  Color,
  DoubleSide,
  MeshLambertMaterial,
  ShaderMaterial,
  Vector2,
  type Vector3,
  type IUniform,
  type Vector4,
} from "three";
import {
  casterFragment,
  decodeParameters,
  fabricFragmentParameters,
  fabricShadowNormal,
  fabricSheen,
  fabricVertexParameters,
} from "./shaders";
import { scale } from "./fields";
import type { Cloth } from "../link/scene_types";

const patterns = ["plain", "weave", "checker", "stripes"];
const threadsAcross = 64; // along the longer side: about 8 pixels per thread at the default framing

/// Uniforms set from each frame's header, shared by every material that draws the payload.
export interface DecodeUniforms {
  [name: string]: IUniform;
  boxMinimum: IUniform<Vector3>;
  boxExtent: IUniform<Vector3>;
  coloured: IUniform<number>; ///< 1: the field colours the cloth
  fieldPower: IUniform<number>; ///< colours are even in this power of the field
  fieldScale: IUniform<number>; ///< range of the frame over that of the colours
}

// sRGB as the style sheet has it: the shader mixes them, then makes them linear.
const fieldColors = { value: scale.map((colour) => new Color(`#${colour}`).convertLinearToSRGB()) };

/// Uniforms shared by every surface of the stage.
export interface StageUniforms {
  lightDirection: IUniform<Vector3>;
  occluders: IUniform<Vector4[]>;
}

export class FabricMaterial extends MeshLambertMaterial {
  private readonly threads = { value: new Vector2(threadsAcross, threadsAcross) };
  private readonly pattern = { value: 1 };
  private readonly hemmed = { value: 1 };

  constructor(decode: DecodeUniforms, stage: StageUniforms) {
    super({ side: DoubleSide, shadowSide: DoubleSide });
    this.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, decode, stage, {
        threads: this.threads,
        pattern: this.pattern,
        hemmed: this.hemmed,
        fieldColors,
      });
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", `#include <common>\n${fabricVertexParameters}`)
        .replace("#include <uv_vertex>", "vCloth = textureCoordinate * threads;")
        .replace("#include <beginnormal_vertex>", "vec3 objectNormal = decodeNormal();")
        .replace(
          "#include <begin_vertex>",
          "vec3 transformed = decodePosition();\nvWorld = transformed;\nvField = field;",
        )
        .replace("#include <shadowmap_vertex>", `${fabricShadowNormal}\n#include <shadowmap_vertex>`);
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", `#include <common>\n${fabricFragmentParameters}`)
        .replace(
          "#include <color_fragment>",
          "diffuseColor.rgb = coloured > 0.5 ? fieldColor() : fabricColor(diffuseColor.rgb, gl_FrontFacing);",
        )
        .replace(
          "#include <aomap_fragment>",
          "reflectedLight.indirectDiffuse *= skyLeft(vWorld, inverseTransformDirection(normal, viewMatrix));",
        )
        .replace("#include <opaque_fragment>", `${fabricSheen}\n#include <opaque_fragment>`);
    };
  }

  show(cloth: Cloth): void {
    this.color = new Color(cloth.color);
    this.pattern.value = Math.max(0, patterns.indexOf(cloth.texture));
    const grid = "grid" in cloth.mesh ? cloth.mesh.grid : null;
    const longer = grid ? Math.max(grid.width, grid.height) : 1;
    if (grid) this.threads.value.set((threadsAcross * grid.width) / longer, (threadsAcross * grid.height) / longer);
    else this.threads.value.setScalar(threadsAcross);
    this.hemmed.value = grid ? 1 : 0;
  }
}

/// The material that draws a cloth's outline or depth, for both kinds of shadow.
export function clothCasterMaterial(decode: DecodeUniforms): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: decode,
    side: DoubleSide,
    vertexShader: `${decodeParameters}\nvoid main() { gl_Position = projectionMatrix * viewMatrix * vec4(decodePosition(), 1.0); }`,
    fragmentShader: casterFragment,
  });
}

/// The material that draws the outline or depth of a three.js mesh.
export function casterMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: casterFragment,
  });
}

/// Draws small discs on the pinned vertices, from the same payload.
export function pinMaterial(decode: DecodeUniforms, pixelRatio: IUniform<number>): ShaderMaterial {
  return new ShaderMaterial({
    uniforms: { ...decode, pixelRatio, diameter: { value: 9 } },
    transparent: true,
    depthWrite: false,
    vertexShader: /* glsl */ `
      ${decodeParameters}
      uniform float pixelRatio;
      uniform float diameter;  // [CSS pixels]
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(decodePosition(), 1.0);
        gl_Position.z -= 0.002 * gl_Position.w;  // in front of the cloth it holds
        gl_PointSize = diameter * pixelRatio;
      }`,
    fragmentShader: /* glsl */ `
      void main() {
        float radius = length(gl_PointCoord - 0.5) * 2.0;
        float disc = 1.0 - smoothstep(0.8, 1.0, radius);
        float core = 1.0 - smoothstep(0.42, 0.58, radius);
        gl_FragColor = vec4(mix(vec3(0.1, 0.11, 0.13), vec3(1.0), core), disc * 0.9);
      }`,
  });
}
