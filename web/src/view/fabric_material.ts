// The cloth's materials: three.js's physical shading of vertices decoded from q16 words, with the fabric's weave.
import {
  Color,
  DoubleSide,
  MeshPhysicalMaterial,
  ShaderMaterial,
  Vector2,
  Vector3,
  type IUniform,
  type Vector4,
} from "three";
import { fabricFragments, spliced } from "./fabric_shader";
import { lookOf, type Weave, weaves } from "./fabric_looks";
import { casterFragment, decodeParameters, fabricShadowNormal, fabricVertexParameters } from "./shaders";
import { scale } from "./fields";
import type { Cloth } from "../link/scene_types";

// A material's program is another with another value of this; without one it is not defined.
function define(material: ShaderMaterial | FabricMaterial, name: string, value: number | undefined): void {
  if (material.defines?.[name] === value) return;
  const { [name]: _, ...others } = material.defines ?? {};
  material.defines = value === undefined ? others : { ...others, [name]: value };
  material.needsUpdate = true;
}

const ribStitches = 6; // in a rib, as weave_shader.ts has it
const patterns = ["plain", "weave", "checker", "stripes"];

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
  pixel: IUniform<number>; ///< 2 over the height of the picture [1 / CSS pixels]
}

export class FabricMaterial extends MeshPhysicalMaterial {
  private weave: Weave = "plain";
  private readonly look = {
    pitch: { value: new Vector2(1, 1) },
    relief: { value: 0 },
    slub: { value: new Vector3() },
    size: { value: new Vector2(1, 1) },
    backness: { value: 0 },
    shines: { value: 0 },
    pattern: { value: 1 },
    hemmed: { value: 1 },
  };

  constructor(decode: DecodeUniforms, stage: StageUniforms) {
    super({ side: DoubleSide, shadowSide: DoubleSide, sheen: 1 });
    this.defines = { ...this.defines, WEAVE: 0, SMOOTH: 1 };
    this.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, decode, stage, this.look, { fieldColors });
      shader.vertexShader = spliced(shader.vertexShader, {
        common: `#include <common>\n${fabricVertexParameters}`,
        uv_vertex: "vCloth = textureCoordinate * size;\n#ifdef USE_ANISOTROPY\nvUv = vCloth;\n#endif",
        beginnormal_vertex: "vec3 objectNormal = decodeNormal();",
        begin_vertex:
          "vec3 transformed = decodePosition();\nvWorld = transformed;\nvField = field;\n#ifdef SMOOTH\nvShade = shade.xy;\n#endif",
        shadowmap_vertex: `${fabricShadowNormal}\n#include <shadowmap_vertex>`,
      });
      shader.fragmentShader = spliced(shader.fragmentShader, fabricFragments);
    };
  }

  /// Takes the size of a pixel of the picture on the nearest cloth [m]. Where that is larger than a thread, a program
  /// without threads draws the same, and faster.
  set pixel(size: number) {
    const [width, height] = this.look.pitch.value.toArray() as [number, number];
    const least = Math.max(width, height) * (this.weave === "rib" ? ribStitches : 1);
    define(this, "THREADS", size < least ? 1 : undefined);
  }

  /// Whether uneven threads and the hem's seam are drawn.
  set details(drawn: boolean) {
    define(this, "DETAILS", drawn ? 1 : undefined);
  }

  /// `metres`: of one unit of texture coordinates, of a cloth that is no grid.
  show({ color, texture, mesh, material, transform }: Cloth, metres: number): void {
    const made = lookOf(material.fabric);
    const { look } = this;
    this.color.set(color);
    this.roughness = made.roughness;
    this.specularIntensity = made.specular;
    this.anisotropy = made.anisotropy;
    this.sheenColor
      .set(color)
      .lerp(new Color(1, 1, 1), 0.35)
      .multiplyScalar(made.sheen);
    this.sheenRoughness = made.sheenRoughness;
    this.weave = made.weave;
    // a program of its own, as processors that draw run both sides of a branch
    define(this, "WEAVE", weaves.indexOf(made.weave));
    look.pitch.value.set(made.pitch[0], made.pitch[1]).divideScalar(1000);
    look.relief.value = texture === "plain" ? 0.5 * made.relief : made.relief;
    look.slub.value.set(made.slub, made.slubSize / 1000, (16 * made.slubSize) / 1000);
    look.backness.value = made.back;
    look.shines.value = made.shines;
    look.pattern.value = Math.max(0, patterns.indexOf(texture));
    const grid = "grid" in mesh ? mesh.grid : null;
    if (grid) look.size.value.set(grid.width, grid.height).multiplyScalar(transform.scale);
    else look.size.value.setScalar(metres);
    look.hemmed.value = grid ? 1 : 0;
  }
}

/// The material that draws a cloth's outline or depth, for both kinds of shadow.
export function clothCasterMaterial(decode: DecodeUniforms, { pixel }: StageUniforms, smooth: boolean): ShaderMaterial {
  return new ShaderMaterial({
    defines: smooth ? { SMOOTH: 1 } : {},
    uniforms: { ...decode, pixel },
    side: DoubleSide,
    vertexShader: `${decodeParameters}\nvoid main() { gl_Position = projectionMatrix * viewMatrix * vec4(decodePosition(), 1.0); }`,
    fragmentShader: casterFragment,
  });
}

/// Lets a material draw the finer mesh, or the frame as it came.
export const setSmooth = (material: ShaderMaterial | FabricMaterial, smooth: boolean): void =>
  define(material, "SMOOTH", smooth ? 1 : undefined);

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
