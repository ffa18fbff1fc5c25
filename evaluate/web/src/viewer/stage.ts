import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  HemisphereLight,
  Mesh,
  MeshLambertMaterial,
  PerspectiveCamera,
  Scene,
  Sphere,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** A mesh with one colour for each vertex, whose positions and colours come and go with the samples. */
export class ColouredMesh {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  readonly colours: Float32Array;

  constructor(index: Uint32Array, positions: Float32Array) {
    const geometry = new BufferGeometry();
    this.colours = new Float32Array(positions.length).fill(1);
    geometry.setIndex(new BufferAttribute(index, 1));
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(this.colours, 3));
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    this.mesh = new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide }));
  }

  paint(colour: string): void {
    const { r, g, b } = new Color(colour);
    for (let at = 0; at < this.colours.length; at += 3) this.colours.set([r, g, b], at);
    this.coloursChanged();
  }

  coloursChanged(): void {
    this.mesh.geometry.getAttribute("color").needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

/** What is drawn where: one rectangle of the canvas, in CSS pixels from its top left. */
export interface Panel {
  meshes: Mesh[];
  left: number;
  top: number;
  width: number;
  height: number;
}

/** Draws panels into one canvas with one camera, so that all of them are always seen from the same side. */
export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(28, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly bounds = new Sphere();
  private panels: Panel[] = [];
  private drawing = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    handle: HTMLElement,
  ) {
    // The drawing buffer is kept: a printed page shows what was drawn last.
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setScissorTest(true);
    const headlight = new DirectionalLight(0xffffff, 1.6);
    headlight.position.set(0.4, 0.6, 1);
    this.camera.add(headlight);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0x8a8f98, 1.9));
    this.controls = new OrbitControls(this.camera, handle);
    this.controls.addEventListener("change", () => this.draw());
    // The wheel scrolls the page until the view has been picked.
    this.controls.enableZoom = false;
    handle.addEventListener("focusin", () => (this.controls.enableZoom = true));
    handle.addEventListener("focusout", () => (this.controls.enableZoom = false));
  }

  show(panels: Panel[]): void {
    this.panels.flatMap((panel) => panel.meshes).forEach((mesh) => this.scene.remove(mesh));
    this.panels = panels;
    this.panels.flatMap((panel) => panel.meshes).forEach((mesh) => this.scene.add(mesh));
    this.draw();
  }

  /** Looks at these bounds from where the camera is already turned to. */
  frame(bounds: Sphere): void {
    const moved = bounds.center.clone().sub(this.bounds.center);
    this.bounds.copy(bounds);
    this.camera.position.add(moved);
    this.controls.target.add(moved);
    this.controls.update();
    this.draw();
  }

  /** From the front, slightly to a side and above, far enough to see the bounds. */
  resetCamera(): void {
    const distance = (1.02 * this.bounds.radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.controls.target.copy(this.bounds.center);
    this.camera.position.setFromSphericalCoords(distance, 1.38, 0.45).add(this.bounds.center);
    this.controls.update();
    this.draw();
  }

  /** Turns the camera about what it looks at by angles [rad], and moves it closer by a factor. */
  turn(azimuth: number, elevation: number, closer = 1): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const at = new Spherical().setFromVector3(offset);
    at.theta += azimuth;
    at.phi = Math.min(Math.max(at.phi - elevation, 0.05), Math.PI - 0.05);
    at.radius /= closer;
    this.camera.position.copy(this.controls.target).add(new Vector3().setFromSpherical(at));
    this.controls.update();
    this.draw();
  }

  /** Draws with the next frame, however often it is asked for. */
  draw(): void {
    if (this.drawing === 0) this.drawing = requestAnimationFrame(() => this.drawNow());
  }

  private drawNow(): void {
    this.drawing = 0;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.clear(width, height);
    const all = this.panels.flatMap((panel) => panel.meshes);
    for (const panel of this.panels) {
      all.forEach((mesh) => (mesh.visible = panel.meshes.includes(mesh)));
      const bottom = height - panel.top - panel.height;
      this.renderer.setViewport(panel.left, bottom, panel.width, panel.height);
      this.renderer.setScissor(panel.left, bottom, panel.width, panel.height);
      this.camera.aspect = panel.width / panel.height;
      this.camera.zoom = Math.min(1, this.camera.aspect); // a narrow panel shows as much in width as a square one
      this.camera.updateProjectionMatrix();
      this.renderer.render(this.scene, this.camera);
    }
  }

  private clear(width: number, height: number): void {
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.renderer.setScissor(0, 0, width, height);
    this.renderer.clear();
  }
}
