// Everything around the path: cameras, views, grid, axes, extents, the tool, labels, compass.
// The scene's coordinates are machine millimeters less `pivot`; Z is up.

import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Box, frameAt, Frame, Model, originOf } from "./data";
import { Palette } from "./path";

const FOV = 32; // degrees, upright: close to what a long lens shows, so shapes keep their proportions
const HALF = Math.tan((FOV * Math.PI) / 360);

/** Directions from the target to the eye. The tiny part keeps the top view's X to the right. */
export const VIEWS: Record<string, [number, number, number]> = {
  iso: [1, -1, 0.82], top: [0, -1e-5, 1], front: [0, -1, 0], right: [1, 0, 0],
};

interface Label { element: HTMLSpanElement; at: THREE.Vector3; edge?: [THREE.Vector3, THREE.Vector3]; shift: [number, number]; least?: [THREE.Vector3, THREE.Vector3]; every?: number }

function css(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function nice(raw: number): number {
  const ten = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((n) => n * ten).find((n) => n >= raw * 0.999) ?? raw;
}

const number = (value: number, digits: number) => value.toFixed(digits).replace(/^-(0(?:\.0*)?)$/, "$1");

export class Stage {
  readonly scene = new THREE.Scene();
  readonly perspective = new THREE.PerspectiveCamera(FOV, 1, 1, 1000);
  readonly flat = new THREE.OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
  camera: THREE.PerspectiveCamera | THREE.OrthographicCamera = this.perspective;
  readonly controls: OrbitControls;
  readonly pivot = new THREE.Vector3();
  readonly diagonal: number;
  readonly frame: Frame; // the work offsets that most moves were made in
  spacing = 0; // mm between grid lines
  private readonly decor = new THREE.Group();
  private readonly tool = new THREE.Group();
  private readonly toolMaterial = new THREE.MeshLambertMaterial({ color: 0xffd34d, transparent: true, opacity: 0.92 });
  private labels: Label[] = [];
  private sphere = new THREE.Sphere(new THREE.Vector3(), 1);
  private width = 1;
  private height = 1;

  constructor(readonly model: Model, canvas: HTMLCanvasElement, private readonly holder: HTMLElement) {
    const box = model.all ?? [[-50, -50, -10], [50, 50, 10]];
    const low = new THREE.Vector3(...box[0]), high = new THREE.Vector3(...box[1]);
    this.pivot.addVectors(low, high).multiplyScalar(0.5);
    this.diagonal = low.distanceTo(high) || 1;
    this.frame = this.mainFrame();
    for (const camera of [this.perspective, this.flat]) camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.perspective, canvas);
    this.controls.screenSpacePanning = true;
    this.controls.zoomToCursor = true;
    this.controls.zoomSpeed = 1.4;
    this.scene.add(this.decor, this.tool, new THREE.HemisphereLight(0xffffff, 0x8899aa, 2.8));
    const sun = new THREE.DirectionalLight(0xffffff, 2.4);
    sun.position.set(-2, -3, 4);
    this.scene.add(sun);
    // The tool: its tip is at the group's origin, its length 1.
    const cone = new THREE.ConeGeometry(0.2, 0.62, 28).rotateX(-Math.PI / 2).translate(0, 0, 0.31);
    const shank = new THREE.CylinderGeometry(0.2, 0.2, 0.38, 28).rotateX(Math.PI / 2).translate(0, 0, 0.81);
    this.tool.add(new THREE.Mesh(cone, this.toolMaterial), new THREE.Mesh(shank, this.toolMaterial));
    this.tool.traverse((object) => { object.renderOrder = 5; });
  }

  private mainFrame(): Frame {
    const { frames, moves } = this.model;
    let best = frameAt(this.model, 0), most = 0;
    frames.forEach((frame, i) => {
      const many = (frames[i + 1]?.[0] ?? moves) - frame[0];
      if (many > most) { most = many; best = frame; }
    });
    return best;
  }

  palette(): Palette {
    const light = matchMedia("(prefers-color-scheme: light)").matches;
    const color = (value: string) => new THREE.Color(value);
    return {
      rapid: color(css("--rapid")), probe: color(css("--probe")), tool: color(css("--tool")), ground: color(css("--ground")),
      feedLow: color(light ? "#123a9c" : "#3f6df2"), feedHigh: color(light ? "#1492e6" : "#6fe3ff"),
    };
  }

  /** Grid, box, axes and labels anew, around a box (mm) or none. */
  dress(box: Box | null, shown: boolean): void {
    this.decor.traverse((object) => { if (object instanceof THREE.Mesh || object instanceof THREE.LineSegments) object.geometry.dispose(); });
    this.decor.clear();
    for (const label of this.labels) label.element.remove();
    this.labels = [];
    const around = box ?? ([[-50, -50, 0], [50, 50, 0]] as Box);
    const origin = new THREE.Vector3(...originOf(this.frame));
    const low = new THREE.Vector3(...around[0]), high = new THREE.Vector3(...around[1]);
    const span = high.clone().sub(low);
    const wide = Math.max(span.x, span.y, span.z * 0.4, 1e-3);
    this.spacing = nice(wide / 9);
    // The work zero belongs to the picture unless it is far off.
    const ground = new THREE.Box3(low.clone(), high.clone());
    if (ground.distanceToPoint(origin) < Math.max(span.length(), 1)) ground.expandByPoint(origin);
    if (shown) {
      this.grid(ground, origin, low.z);
      if (box) this.extents(low, high);
    }
    this.axes(origin, wide);
    const { center, radius } = ground.getBoundingSphere(new THREE.Sphere());
    this.sphere = new THREE.Sphere(center.sub(this.pivot), radius * 1.6 + 3 * this.spacing);
  }

  private local(x: number, y: number, z: number): THREE.Vector3 { return new THREE.Vector3(x, y, z).sub(this.pivot); }

  private lines(points: THREE.Vector3[], color: THREE.Color, opacity: number): void {
    const geometry = new THREE.BufferGeometry().setFromPoints(points);
    const material = new THREE.LineBasicMaterial({ color, transparent: true, opacity, depthWrite: false });
    this.decor.add(new THREE.LineSegments(geometry, material));
  }

  private label(text: string, kind: string, at: THREE.Vector3, more: Partial<Label> = {}): void {
    const element = document.createElement("span");
    element.className = kind;
    element.textContent = text;
    this.holder.append(element);
    this.labels.push({ element, at, shift: [0, 0], ...more });
  }

  private grid(ground: THREE.Box3, origin: THREE.Vector3, z: number): void {
    const step = this.spacing;
    const edge = (value: number, zero: number, side: -1 | 1) =>
      zero + step * (side < 0 ? Math.floor((value - zero) / step - 0.3) : Math.ceil((value - zero) / step + 0.3));
    const x0 = edge(ground.min.x, origin.x, -1), x1 = edge(ground.max.x, origin.x, 1);
    const y0 = edge(ground.min.y, origin.y, -1), y1 = edge(ground.max.y, origin.y, 1);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const soft = new THREE.Color(css("--soft"));
    const minor: THREE.Vector3[] = [], major: THREE.Vector3[] = [];
    const next: [THREE.Vector3, THREE.Vector3] = [this.local(x0, y0, z), this.local(x0 + step, y0, z)];
    const nextY: [THREE.Vector3, THREE.Vector3] = [this.local(x1, y0, z), this.local(x1, y0 + step, z)];
    for (let i = Math.round((x0 - origin.x) / step); i <= Math.round((x1 - origin.x) / step); i++) {
      const x = origin.x + i * step;
      (i % 5 ? minor : major).push(this.local(x, y0, z), this.local(x, y1, z));
      this.label(number(i * step, digits), "tick", this.local(x, y0, z), { shift: [0, 11], least: next, every: i });
    }
    for (let i = Math.round((y0 - origin.y) / step); i <= Math.round((y1 - origin.y) / step); i++) {
      const y = origin.y + i * step;
      (i % 5 ? minor : major).push(this.local(x0, y, z), this.local(x1, y, z));
      if (y > y0 + step / 2) this.label(number(i * step, digits), "tick", this.local(x1, y, z), { shift: [16, 4], least: nextY, every: i });
    }
    this.lines(minor, soft, 0.17);
    this.lines(major, soft, 0.34);
  }

  private extents(low: THREE.Vector3, high: THREE.Vector3): void {
    const at = (i: number) => this.local(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    const points: THREE.Vector3[] = [];
    for (let i = 0; i < 8; i++) for (const bit of [1, 2, 4]) if (!(i & bit)) points.push(at(i), at(i | bit));
    this.lines(points, new THREE.Color(css("--ink")), 0.32);
    const size = (name: string, length: number, a: number, b: number) => {
      if (length > 0) this.label(`${name} ${number(length, 3)} mm`, "size", at(a).add(at(b)).multiplyScalar(0.5), { least: [at(a), at(b)] });
    };
    size("X", high.x - low.x, 2 | 4, 1 | 2 | 4); // on edges away from the ticks
    size("Y", high.y - low.y, 0 | 4, 2 | 4);
    size("Z", high.z - low.z, 0, 4);
  }

  private axes(origin: THREE.Vector3, wide: number): void {
    const length = wide * 0.2, thin = length * 0.013;
    const center = origin.clone().sub(this.pivot);
    const turn = (this.frame[4] * Math.PI) / 180;
    for (const [name, axis, variable] of [["X", [1, 0, 0], "--ax"], ["Y", [0, 1, 0], "--ay"], ["Z", [0, 0, 1], "--az"]] as const) {
      const way = new THREE.Vector3(...axis).applyAxisAngle(new THREE.Vector3(0, 0, 1), turn);
      const material = new THREE.MeshBasicMaterial({ color: css(variable) });
      const shaft = new THREE.Mesh(new THREE.CylinderGeometry(thin, thin, length, 8).translate(0, length / 2, 0), material);
      const head = new THREE.Mesh(new THREE.ConeGeometry(thin * 3.6, length * 0.16, 16).translate(0, length * 1.05, 0), material);
      for (const mesh of [shaft, head]) {
        mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way);
        mesh.position.copy(center);
        this.decor.add(mesh);
      }
      this.label(name, `axis ${name.toLowerCase()}`, center.clone().addScaledVector(way, length * 1.24));
    }
    // Other zeros: of the machine, and of other work coordinate systems that moves were made in.
    const cross = (at: THREE.Vector3, text: string) => {
      const middle = at.clone().sub(this.pivot), arm = wide * 0.03;
      const points = [[arm, 0, 0], [0, arm, 0], [0, 0, arm]].flatMap(([x, y, z]) => [middle.clone().add(new THREE.Vector3(x, y, z)), middle.clone().sub(new THREE.Vector3(x, y, z))]);
      this.lines(points, new THREE.Color(css("--ink")), 0.9);
      this.label(text, "mark", middle, { shift: [0, 14] });
    };
    const told = [origin];
    const distinct = (at: THREE.Vector3) => told.every((other) => other.distanceTo(at) > 1e-6) && told.push(at) > 0;
    const zero = new THREE.Vector3();
    if (distinct(zero)) cross(zero, "Machine zero");
    this.model.frames.forEach((frame, i) => {
      const at = new THREE.Vector3(...originOf(frame));
      const used = frame[0] < (this.model.frames[i + 1]?.[0] ?? this.model.moves);
      if (told.length < 12 && used && distinct(at)) cross(at, systemName(frame[1]));
    });
  }

  resize(width: number, height: number): void {
    this.width = width;
    this.height = height;
    this.perspective.aspect = width / height;
    this.widen(this.flat.top);
  }

  private widen(half: number): void {
    const side = (half * this.width) / this.height;
    Object.assign(this.flat, { left: -side, right: side, top: half, bottom: -half });
    this.perspective.updateProjectionMatrix();
    this.flat.updateProjectionMatrix();
  }

  get isPerspective(): boolean { return this.camera === this.perspective; }

  set isPerspective(wanted: boolean) {
    if (wanted === this.isPerspective) return;
    const target = this.controls.target;
    const way = this.camera.position.clone().sub(target);
    if (wanted) {
      way.setLength(this.flat.top / this.flat.zoom / HALF);
      this.camera = this.perspective;
    } else {
      this.flat.zoom = 1;
      this.widen(way.length() * HALF);
      this.camera = this.flat;
    }
    this.camera.position.copy(target).add(way);
    this.camera.lookAt(target);
    this.controls.object = this.camera;
    this.controls.update();
  }

  /** Look from a direction (or the present one) so that a box just fits. */
  fit(box: Box | null, direction?: [number, number, number]): void {
    const around = box ?? ([[-50, -50, -10], [50, 50, 10]] as Box);
    const low = new THREE.Vector3(...around[0]).sub(this.pivot), high = new THREE.Vector3(...around[1]).sub(this.pivot);
    const origin = new THREE.Vector3(...originOf(this.frame)).sub(this.pivot);
    const ground = new THREE.Box3(low, high);
    const size = Math.max(ground.getSize(new THREE.Vector3()).length(), 1e-3);
    if (ground.distanceToPoint(origin) < 0.6 * size) ground.expandByPoint(origin);
    const back = direction ? new THREE.Vector3(...direction) : this.camera.position.clone().sub(this.controls.target);
    back.normalize();
    const across = new THREE.Vector3(0, 0, 1).cross(back).normalize(), up = back.clone().cross(across);
    // The middle of what the camera sees, then the distance that shows every corner.
    const corners = [...Array(8).keys()].map((i) => new THREE.Vector3(
      i & 1 ? ground.max.x : ground.min.x, i & 2 ? ground.max.y : ground.min.y, i & 4 ? ground.max.z : ground.min.z));
    const target = ground.getCenter(new THREE.Vector3());
    const margin = 1.24, aspect = this.width / this.height;
    let distance = size * 0.02, half = size * 0.01;
    for (const corner of corners) {
      const off = corner.clone().sub(target);
      const need = Math.max(Math.abs(off.dot(across)) / aspect, Math.abs(off.dot(up))) * margin;
      half = Math.max(half, need);
      distance = Math.max(distance, need / HALF + off.dot(back));
    }
    if (!this.isPerspective) distance = half / HALF;
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(back, distance);
    this.flat.zoom = 1;
    this.widen(half);
    this.controls.update();
  }

  /** mm a CSS pixel covers, at a distance (mm) from the eye. */
  pixelAt = (distance: number): number =>
    this.isPerspective ? (2 * HALF * Math.max(distance, 1e-6)) / this.height : (2 * this.flat.top) / this.flat.zoom / this.height;

  toolAt(x: number, y: number, z: number): void { this.tool.position.set(x, y, z); }

  /** Before each frame: planes that enclose the scene, the tool's size. */
  prepare(): void {
    const { camera } = this;
    const away = camera.position.distanceTo(this.sphere.center), radius = this.sphere.radius + this.diagonal;
    camera.far = away + radius;
    camera.near = this.isPerspective ? Math.max(away - radius, camera.position.distanceTo(this.controls.target) / 400, camera.far / 20000) : -camera.far;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
    this.tool.scale.setScalar(this.pixelAt(camera.position.distanceTo(this.tool.position)) * 52);
    const color = css("--ground");
    this.scene.background = new THREE.Color(color);
  }

  /** After each frame: labels over their places. */
  annotate(): void {
    const { width, height } = this;
    const spot = (at: THREE.Vector3) => {
      const p = at.clone().project(this.camera);
      return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height, seen: Math.abs(p.z) <= 1 };
    };
    for (const { element, at, shift, least, every } of this.labels) {
      const { x, y, seen } = spot(at);
      let shown = seen && x > -60 && x < width + 60 && y > -20 && y < height + 20;
      if (shown && least) {
        const a = spot(least[0]), b = spot(least[1]);
        const pixels = Math.hypot(a.x - b.x, a.y - b.y);
        if (every === undefined) shown = pixels > 28;
        else shown = pixels > 3 && every % ([1, 2, 5, 10, 20, 50].find((n) => n * pixels > 40) ?? 100) === 0;
      }
      element.style.display = shown ? "" : "none";
      if (shown) element.style.transform = `translate(${(x + shift[0]).toFixed(1)}px, ${(y + shift[1]).toFixed(1)}px) translate(-50%, -50%)`;
    }
  }

  /** The directions of the axes, small, in a corner. */
  compass(canvas: HTMLCanvasElement): void {
    const ratio = devicePixelRatio, side = 88;
    if (canvas.width !== side * ratio) canvas.width = canvas.height = side * ratio;
    const pen = canvas.getContext("2d");
    if (!pen) return;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, side, side);
    const view = this.camera.matrixWorldInverse;
    const arms = ([["X", [1, 0, 0], "--ax"], ["Y", [0, 1, 0], "--ay"], ["Z", [0, 0, 1], "--az"]] as const)
      .map(([name, axis, color]) => ({ name, color: css(color), way: new THREE.Vector3(...axis).transformDirection(view) }))
      .sort((a, b) => a.way.z - b.way.z);
    pen.lineWidth = 2.2;
    pen.lineCap = "round";
    pen.font = "700 11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const { name, color, way } of arms) {
      pen.globalAlpha = way.z < -0.1 ? 0.55 : 1;
      pen.strokeStyle = pen.fillStyle = color;
      pen.beginPath();
      pen.moveTo(side / 2, side / 2);
      pen.lineTo(side / 2 + way.x * 25, side / 2 - way.y * 25);
      pen.stroke();
      if (Math.hypot(way.x, way.y) > 0.2) pen.fillText(name, side / 2 + way.x * 36, side / 2 - way.y * 36);
    }
    pen.globalAlpha = 1;
  }
}

/** G54 … G59, G59.1 …; further systems by their number. */
export function systemName(system: number): string {
  return system <= 6 ? `G${53 + system}` : system <= 9 ? `G59.${system - 6}` : `G54.1 P${system}`;
}
