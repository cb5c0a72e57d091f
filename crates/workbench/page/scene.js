// @ts-check
// The bulge in space: a mesh coloured by a field, between two fittings. Nothing is drawn while nothing moves.

import { inks, rampAt } from "./palette.js";
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, Group, Mesh, MeshStandardMaterial, OrbitControls, PerspectiveCamera, Scene, WebGLRenderer,
} from "./vendor/three.js";

/** @typedef {import("./types.js").Shape} Shape */

/** Length of a fitting, in radii of the muscle's end. */
const FITTING = 0.9;

export class BulgeScene {
  /** Throws where the browser has no WebGL. @param {HTMLElement} element */
  constructor(element) {
    this.element = element;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    element.append(this.renderer.domElement);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(28, 1, 0.001, 100);
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(0.6, 1, 0.8);
    this.camera.add(key);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.5));
    this.body = new Group();
    this.scene.add(this.body);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.soon());
    this.frame = 0;
    /** Size of what the camera looks at; 0 before there is anything. */
    this.size = 0;
    new ResizeObserver(() => this.resize()).observe(element);
    element.addEventListener("keydown", (event) => this.turn(event));
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.soon();
  }

  /** Draws in the next frame, once. */
  soon() {
    this.frame ||= requestAnimationFrame(() => {
      this.frame = 0;
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** @param {KeyboardEvent} event */
  turn(event) {
    const by = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] })[event.key];
    if (!by) return;
    event.preventDefault();
    this.body.rotation.x += by[1];
    this.body.rotation.y += by[0];
    this.soon();
  }

  /** @param {Shape} shape @param {number} field @returns {[number, number]} the range of the field */
  show(shape, field) {
    const values = shape.fields[field]?.values ?? [];
    const range = rangeOf(values);
    const count = shape.points.length / 3;
    const axis = axisOf(shape.points);
    const positions = new Float32Array(shape.points.length);
    const colours = new Float32Array(shape.points.length);
    const colour = new Color();
    for (let i = 0; i < count; i += 1) {
      // The muscle lies along the screen, whichever way its axis goes in the document.
      positions[3 * i] = shape.points[3 * i + axis];
      positions[3 * i + 1] = shape.points[3 * i + ((axis + 1) % 3)];
      positions[3 * i + 2] = shape.points[3 * i + ((axis + 2) % 3)];
      const share = range[1] > range[0] ? (values[i] - range[0]) / (range[1] - range[0]) : 0.5;
      const [r, g, b] = rampAt(Number.isFinite(share) ? share : 0.5);
      colour.setRGB(r / 255, g / 255, b / 255, "srgb");
      colours.set([colour.r, colour.g, colour.b], 3 * i);
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    geometry.setIndex(shape.triangles);
    geometry.computeVertexNormals();
    this.empty();
    this.body.add(new Mesh(geometry, new MeshStandardMaterial({ vertexColors: true, side: DoubleSide, roughness: 0.55, metalness: 0.05 })));
    this.addFittings(positions);
    this.look(positions);
    this.soon();
    return range;
  }

  empty() {
    for (const mesh of [...this.body.children]) {
      if (mesh instanceof Mesh) {
        mesh.geometry.dispose();
        mesh.material.dispose();
      }
      this.body.remove(mesh);
    }
  }

  /** Two cylinders that hold the ends. @param {Float32Array} positions */
  addFittings(positions) {
    let [low, high] = [Infinity, -Infinity];
    for (let i = 0; i < positions.length; i += 3) {
      low = Math.min(low, positions[i]);
      high = Math.max(high, positions[i]);
    }
    const near = 1e-3 * (high - low);
    for (const [end, way] of [[low, -1], [high, 1]]) {
      let radius = 0;
      for (let i = 0; i < positions.length; i += 3) if (Math.abs(positions[i] - end) < near) radius = Math.max(radius, Math.hypot(positions[i + 1], positions[i + 2]));
      const length = FITTING * radius;
      const mesh = new Mesh(new CylinderGeometry(1.04 * radius, 1.04 * radius, length, 48), new MeshStandardMaterial({ color: inks().aside, roughness: 0.45, metalness: 0.15 }));
      mesh.rotation.z = Math.PI / 2;
      mesh.position.x = end + (way * length) / 2;
      this.body.add(mesh);
    }
  }

  /** Keeps the camera where a hand has put it, unless the muscle has quite another size. @param {Float32Array} positions */
  look(positions) {
    let size = 0;
    for (let i = 0; i < positions.length; i += 3) size = Math.max(size, Math.hypot(positions[i], positions[i + 1], positions[i + 2]));
    if (this.size && size < 1.4 * this.size && size > this.size / 1.4) return;
    this.size = size;
    // Half of the field of view is 14 degrees; the fittings need some room too.
    const distance = (1.32 * size) / Math.tan((14 * Math.PI) / 180) / Math.max(1, this.camera.aspect);
    this.camera.near = distance / 100;
    this.camera.far = distance * 10;
    this.camera.position.set(0.25 * distance, 0.38 * distance, 0.88 * distance);
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }
}

/** @param {number[]} values @returns {[number, number]} */
export function rangeOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low > high ? [0, 1] : [low, high];
}

/** The coordinate along the muscle: the other two vary alike, because it is round. @param {number[]} points */
function axisOf(points) {
  const spans = [0, 1, 2].map((k) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = k; i < points.length; i += 3) {
      low = Math.min(low, points[i]);
      high = Math.max(high, points[i]);
    }
    return high - low;
  });
  const unlike = spans.map((_, k) => Math.abs(spans[(k + 1) % 3] - spans[(k + 2) % 3]));
  return unlike.indexOf(Math.min(...unlike));
}
