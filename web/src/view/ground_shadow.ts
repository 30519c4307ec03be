// The shadow on the ground: all its casters are drawn along the light into one small texture, and blurred to a soft
// mask.
// The ground covers most of the picture, and a software renderer can afford one texture read per pixel there.
import {
  BufferAttribute,
  BufferGeometry,
  Matrix4,
  Mesh,
  NoBlending,
  OrthographicCamera,
  RedFormat,
  Scene,
  ShaderMaterial,
  Vector2,
  WebGLRenderTarget,
  type IUniform,
  type Object3D,
  type Texture,
  type Vector3,
  type WebGLRenderer,
} from "three";

const size = 128; // pixels along each side of the mask
const blurStep = 1.1; // pixels between taps: the penumbra is about 4 % of the scene wide

export interface GroundShadowUniforms {
  [name: string]: IUniform;
  shadowMask: IUniform<Texture | null>;
  shadowMatrix: IUniform<Matrix4>; ///< world to mask, both axes 0 to 1
}

// Nine taps of a Gaussian. Eight are read in pairs, between two pixels: linear filtering halves the reads.
const blurFragment = /* glsl */ `
uniform sampler2D source;
uniform vec2 along;
varying vec2 vAt;
void main() {
  float sum = texture2D(source, vAt).r * 0.2270;
  sum += (texture2D(source, vAt + along * 1.3846).r + texture2D(source, vAt - along * 1.3846).r) * 0.3162;
  sum += (texture2D(source, vAt + along * 3.2308).r + texture2D(source, vAt - along * 3.2308).r) * 0.0703;
  gl_FragColor = vec4(sum);
}`;

const target = () =>
  new WebGLRenderTarget(size, size, { depthBuffer: false, format: RedFormat, generateMipmaps: false });

export class GroundShadow {
  readonly casters = new Scene();
  readonly uniforms: GroundShadowUniforms = { shadowMask: { value: null }, shadowMatrix: { value: new Matrix4() } };
  private readonly camera = new OrthographicCamera();
  private readonly targets = [target(), target()] as const;
  private readonly along = { value: new Vector2() };
  private readonly source: IUniform<Texture | null> = { value: null };
  private readonly screen = new Scene();

  constructor(
    private readonly renderer: WebGLRenderer,
    cloth: Object3D,
  ) {
    this.casters.add(cloth);
    const triangle = new BufferGeometry();
    triangle.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const blur = new ShaderMaterial({
      uniforms: { source: this.source, along: this.along },
      depthTest: false,
      depthWrite: false,
      blending: NoBlending,
      vertexShader:
        "varying vec2 vAt;\nvoid main() { vAt = position.xy * 0.5 + 0.5; gl_Position = vec4(position.xy, 0.0, 1.0); }",
      fragmentShader: blurFragment,
    });
    const mesh = new Mesh(triangle, blur);
    mesh.frustumCulled = false;
    this.screen.add(mesh);
    this.uniforms.shadowMask.value = this.targets[0].texture;
  }

  /// Looks along the light at a ball of this radius [m].
  aim(center: Vector3, lightFrom: Vector3, radius: number): void {
    Object.assign(this.camera, {
      left: -radius,
      right: radius,
      top: radius,
      bottom: -radius,
      near: 0,
      far: radius * 8,
    });
    this.camera.position.copy(center).addScaledVector(lightFrom, radius * 4);
    this.camera.lookAt(center);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.uniforms.shadowMatrix.value
      .set(0.5, 0, 0, 0.5, 0, 0.5, 0, 0.5, 0, 0, 1, 0, 0, 0, 0, 1)
      .multiply(this.camera.projectionMatrix)
      .multiply(this.camera.matrixWorldInverse);
  }

  /// Compiles what draw() needs for casters like these.
  compile(samples: Object3D[]): void {
    this.renderer.setRenderTarget(this.targets[0]); // a program depends on the target it draws to
    this.casters.add(...samples);
    this.renderer.compile(this.casters, this.camera);
    this.casters.remove(...samples);
    this.renderer.compile(this.screen, this.camera);
    this.renderer.setRenderTarget(null);
  }

  draw(): void {
    const [mask, blurred] = this.targets;
    this.renderer.setRenderTarget(mask);
    this.renderer.render(this.casters, this.camera);
    for (const [from, to, x, y] of [
      [mask, blurred, 1, 0],
      [blurred, mask, 0, 1],
    ] as const) {
      this.source.value = from.texture;
      this.along.value.set((x * blurStep) / size, (y * blurStep) / size);
      this.renderer.setRenderTarget(to);
      this.renderer.render(this.screen, this.camera);
    }
    this.renderer.setRenderTarget(null);
  }
}
