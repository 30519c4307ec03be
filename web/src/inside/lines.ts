// Lines over the cloth: thin ones, one pixel wide and hidden by what is before them, and thick ones, which show
// through.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  LineSegments,
  Mesh,
  ShaderMaterial,
  Vector2,
} from "three";

/// Thin lines between vertices that `index` names in pairs, of positions that others own.
export class ThinLines {
  readonly object: LineSegments;
  private readonly tone = { value: new Color() };
  private readonly opacity = { value: 1 };

  constructor() {
    const material = new ShaderMaterial({
      uniforms: { tone: this.tone, opacity: this.opacity },
      transparent: true,
      depthWrite: false,
      vertexShader: /* glsl */ `
        void main() {
          vec4 seen = modelViewMatrix * vec4(position, 1.0);
          seen.xyz *= 0.996;  // nearer to the eye than the cloth that they lie on
          gl_Position = projectionMatrix * seen;
        }`,
      fragmentShader: /* glsl */ `
        uniform vec3 tone;
        uniform float opacity;
        void main() { gl_FragColor = vec4(tone, opacity); }`,
    });
    this.object = new LineSegments(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.visible = false;
    this.object.renderOrder = 1;
  }

  /// `colour`: as a style sheet has it.
  set look({ colour, opacity }: { colour: string; opacity: number }) {
    this.tone.value.set(colour).convertLinearToSRGB(); // the shader writes sRGB as it is
    this.opacity.value = opacity;
  }

  set positions(attribute: BufferAttribute) {
    this.object.geometry.setAttribute("position", attribute);
  }

  set index(vertices: Uint32Array | null) {
    this.object.geometry.setIndex(vertices && new BufferAttribute(vertices, 1));
  }

  dispose(): void {
    this.object.geometry.dispose();
  }
}

/// Lines of the same width on the screen, each of one colour and with a dark rim, in front of everything.
export class ThickLines {
  readonly object: Mesh;
  readonly from: Float32Array; ///< [most * 3] [m]
  readonly to: Float32Array; ///< [most * 3] [m]
  readonly tone: Float32Array; ///< [most * 3] shares of sRGB
  private readonly geometry = new InstancedBufferGeometry();
  private readonly viewport = { value: new Vector2(1, 1) };

  /// Room for `most` lines, `width` wide [CSS pixels].
  constructor(
    private readonly most: number,
    width: number,
  ) {
    [this.from, this.to, this.tone] = [0, 1, 2].map(() => new Float32Array(3 * most)) as [
      Float32Array,
      Float32Array,
      Float32Array,
    ];
    const corners = Float32Array.of(0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0);
    this.geometry.setAttribute("position", new BufferAttribute(corners, 3));
    this.geometry.setIndex([0, 1, 2, 2, 1, 3]);
    for (const [name, array] of [
      ["from", this.from],
      ["to", this.to],
      ["tone", this.tone],
    ] as const)
      this.geometry.setAttribute(name, new InstancedBufferAttribute(array, 3));
    const material = new ShaderMaterial({
      uniforms: { viewport: this.viewport, width: { value: width } },
      transparent: true,
      depthTest: false,
      depthWrite: false,
      vertexShader: /* glsl */ `
        attribute vec3 from;
        attribute vec3 to;
        attribute vec3 tone;
        uniform vec2 viewport;  // [CSS pixels]
        uniform float width;    // [CSS pixels]
        varying vec3 vTone;
        varying vec2 vAt;       // along and across, in half widths from the ends and the middle
        varying float vLength;
        void main() {
          vec4 a = projectionMatrix * modelViewMatrix * vec4(from, 1.0);
          vec4 b = projectionMatrix * modelViewMatrix * vec4(to, 1.0);
          vec2 way = (b.xy / b.w - a.xy / a.w) * 0.5 * viewport;
          float span = length(way);
          vec2 along = span > 1e-3 ? way / span : vec2(1.0, 0.0);
          vec2 across = vec2(-along.y, along.x);
          bool second = position.x > 0.5;
          vec4 end = second ? b : a;
          vec2 shift = (along * (second ? 1.0 : -1.0) + across * position.y) * 0.5 * width;
          end.xy += shift / (0.5 * viewport) * end.w;
          gl_Position = a.w > 0.0 && b.w > 0.0 ? end : vec4(2.0, 2.0, 2.0, 1.0);
          vLength = 2.0 * span / width;
          vAt = vec2(second ? vLength + 1.0 : -1.0, position.y);
          vTone = tone;
        }`,
      fragmentShader: /* glsl */ `
        varying vec3 vTone;
        varying vec2 vAt;
        varying float vLength;
        void main() {
          float beyond = max(max(-vAt.x, vAt.x - vLength), 0.0);
          float off = length(vec2(beyond, vAt.y));  // from the line, in half widths
          if (off > 1.0) discard;
          gl_FragColor = vec4(mix(vTone, vec3(0.06), smoothstep(0.5, 0.75, off)), 1.0);
        }`,
    });
    this.object = new Mesh(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.visible = false;
    this.object.renderOrder = 2;
    this.geometry.instanceCount = 0;
  }

  /// Draws the first `count` of the lines as their arrays are now.
  draw(count: number): void {
    this.geometry.instanceCount = Math.min(count, this.most);
    for (const name of ["from", "to", "tone"]) this.geometry.getAttribute(name).needsUpdate = true;
  }

  /// The size of the picture [CSS pixels].
  resize(width: number, height: number): void {
    this.viewport.value.set(width, height);
  }
}
