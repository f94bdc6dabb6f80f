// The path on the graphics card.
//
// A toolpath is one unbroken line, so it is cut into chunks of CHUNK segments, each
// drawn in one of two ways over the same points: as instanced quads (wide lines, dashed
// rapids, for what is small enough) or as a line strip of one pixel with levels of
// detail (index lists that skip points nearer to the last kept one than a tolerance).
// Each chunk is drawn up to twice: the part done, and the part still to do, dimmed.

import * as THREE from "three";
import { Model, PROBE, TRAVERSE } from "./data";

const CHUNK = 1 << 14; // segments; an index into a chunk fits 16 bits
const QUADS = 200_000; // segments in view that are still drawn as quads
const STEPS = [4000, 1200, 400, 130, 40]; // levels of detail: the path's diagonal through this is the tolerance

const COMMON = /* glsl */ `
uniform vec3 rapid, feedLow, feedHigh, probe;
uniform vec2 heights;
uniform float opacity;
uniform bool hideRapids;
`;

const COLOR = /* glsl */ `
vec3 colored(float kind, float z) {
  if (kind < 0.5) return rapid;
  if (kind > 2.5) return probe;
  return mix(feedLow, feedHigh, clamp((z - heights.x) / max(heights.y - heights.x, 1e-6), 0.0, 1.0));
}
`;

const QUAD_VERTEX = /* glsl */ `${COMMON}
in vec3 start, end;
in float kind;
uniform vec2 size;   // of the canvas, device pixels
uniform vec2 width;  // of rapids and feeds, device pixels
uniform int from;
out vec3 tint;
out vec2 dash;       // distance along the segment in pixels, times w; w
flat out float isRapid;
${COLOR}
void main() {
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);  // outside, unless drawn below
  isRapid = kind < 0.5 ? 1.0 : 0.0;
  tint = colored(kind, mix(start.z, end.z, position.x));
  dash = vec2(0.0, 1.0);
  if (gl_InstanceID < from || (hideRapids && kind < 0.5)) return;
  vec4 a = projectionMatrix * modelViewMatrix * vec4(start, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(end, 1.0);
  float da = a.z + a.w, db = b.z + b.w;  // in front of the near plane where positive
  if (da < 0.0 && db < 0.0) return;
  if (da < 0.0) a = mix(a, b, da / (da - db));
  else if (db < 0.0) b = mix(b, a, db / (db - da));
  vec2 step = (b.xy / b.w - a.xy / a.w) * size * 0.5;
  float pixels = length(step);
  vec2 along = pixels > 1e-5 ? step / pixels : vec2(1.0, 0.0);
  float wide = kind < 0.5 ? width.x : width.y;
  vec4 at = position.x < 0.5 ? a : b;
  vec2 off = vec2(-along.y, along.x) * position.y * wide * 0.5 + along * (position.x - 0.5) * wide * 0.5;
  at.xy += off / size * 2.0 * at.w;
  gl_Position = at;
  dash = vec2(position.x * pixels, 1.0) * at.w;
}`;

const QUAD_FRAGMENT = /* glsl */ `
in vec3 tint;
in vec2 dash;
flat in float isRapid;
uniform float opacity, period;
out vec4 color;
void main() {
  if (isRapid > 0.5 && fract(dash.x / dash.y / period) > 0.62) discard;
  color = vec4(tint, opacity);
}`;

const STRIP_VERTEX = /* glsl */ `${COMMON}
in float kind;
flat out float kindOf;
out vec3 tint;
${COLOR}
void main() {
  kindOf = kind;
  tint = colored(kind, position.z);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// A segment has the kind of the vertex that ends it. Tint may blend along it with height, but not
// across kinds, so those other than feed are looked up again.
const STRIP_FRAGMENT = /* glsl */ `${COMMON}
flat in float kindOf;
in vec3 tint;
out vec4 color;
void main() {
  if (hideRapids && kindOf < 0.5) discard;
  color = vec4(kindOf < 0.5 ? rapid : kindOf > 2.5 ? probe : tint, opacity);
}`;

export interface Palette { rapid: THREE.Color; feedLow: THREE.Color; feedHigh: THREE.Color; probe: THREE.Color; tool: THREE.Color; ground: THREE.Color }

interface Level { tolerance: number; index: Uint16Array; attribute: THREE.BufferAttribute }

interface Half { quads: THREE.Mesh<THREE.InstancedBufferGeometry>; strip: THREE.Line }

interface Chunk { first: number; count: number; sphere: THREE.Sphere; levels: Level[]; done: Half; todo: Half }

function material(kind: "quad" | "strip", uniforms: Record<string, THREE.IUniform>, dim: boolean): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    glslVersion: THREE.GLSL3, uniforms,
    vertexShader: kind === "quad" ? QUAD_VERTEX : STRIP_VERTEX,
    fragmentShader: kind === "quad" ? QUAD_FRAGMENT : STRIP_FRAGMENT,
    transparent: dim, depthWrite: !dim, side: THREE.DoubleSide,
  });
}

export class Path {
  readonly group = new THREE.Group();
  /** Points relative to `pivot`, so that single precision suffices: x, y, z of each. */
  readonly points: Float32Array;
  private readonly kinds: Uint8Array; // of the segment that ends at a point
  private readonly chunks: Chunk[] = [];
  private readonly shared: Record<string, THREE.IUniform>;
  private readonly bright: Record<string, THREE.IUniform>;
  private readonly dim: Record<string, THREE.IUniform>;
  private readonly from = { value: 0 };
  private readonly quadPart: THREE.ShaderMaterial;
  private readonly quadDim: THREE.ShaderMaterial;
  private readonly tools = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
  private cursor = 0;
  /** Segments given to the card in the last frame. */
  drawn = 0;

  constructor(readonly model: Model, readonly pivot: THREE.Vector3, diagonal: number) {
    const { points: count, x, y, z, move, kind } = model;
    const points = (this.points = new Float32Array(3 * count));
    const kinds = (this.kinds = new Uint8Array(count));
    for (let i = 0, j = 0; i < count; i++) {
      points[j++] = x.at(i) - pivot.x;
      points[j++] = y.at(i) - pivot.y;
      points[j++] = z.at(i) - pivot.z;
      if (i) kinds[i] = kind.at(move.at(i));
    }
    if (count > 1) kinds[0] = kinds[1];

    const lines = model.tools.map((value, i) => value - pivot.getComponent(i % 3));
    this.tools.geometry.setAttribute("position", new THREE.BufferAttribute(lines, 3));
    this.tools.frustumCulled = false;
    this.tools.renderOrder = 2;
    if (lines.length) this.group.add(this.tools);

    const box = model.cut ?? model.all;
    this.shared = {
      hideRapids: { value: false }, size: { value: new THREE.Vector2(1, 1) }, width: { value: new THREE.Vector2(1, 2) },
      period: { value: 9 }, heights: { value: new THREE.Vector2(box ? box[0][2] - pivot.z : 0, box ? box[1][2] - pivot.z : 1) },
    };
    const color = () => ({ rapid: { value: new THREE.Color() }, feedLow: { value: new THREE.Color() }, feedHigh: { value: new THREE.Color() }, probe: { value: new THREE.Color() } });
    this.bright = { ...this.shared, ...color(), opacity: { value: 1 }, from: { value: 0 } };
    this.dim = { ...this.shared, ...color(), opacity: { value: 0.6 }, from: { value: 0 } };
    const quad = material("quad", this.bright, false);
    this.quadDim = material("quad", this.dim, true);
    this.quadPart = material("quad", { ...this.dim, from: this.from }, true);
    const strip = material("strip", this.bright, false), stripDim = material("strip", this.dim, true);

    const corners = new THREE.BufferAttribute(new Float32Array([0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0]), 3);
    const faces = new THREE.BufferAttribute(new Uint16Array([0, 1, 2, 2, 1, 3]), 1);
    for (let first = 0; first < count - 1; first += CHUNK) {
      const segments = Math.min(CHUNK, count - 1 - first);
      const own = points.subarray(3 * first, 3 * (first + segments + 1));
      const ownKinds = kinds.subarray(first, first + segments + 1);
      const sphere = sphereOf(own);
      const position = new THREE.BufferAttribute(own, 3), kindOfPoint = new THREE.BufferAttribute(ownKinds, 1);
      const start = new THREE.InstancedBufferAttribute(own.subarray(0, 3 * segments), 3);
      const end = new THREE.InstancedBufferAttribute(own.subarray(3), 3);
      const kindOfSegment = new THREE.InstancedBufferAttribute(ownKinds.subarray(1), 1);
      const levels = this.levels(own, ownKinds, count > 60_000 ? diagonal : 0);
      const half = (dim: boolean): Half => {
        const geometry = new THREE.InstancedBufferGeometry();
        geometry.setAttribute("position", corners);
        geometry.setIndex(faces);
        geometry.setAttribute("start", start);
        geometry.setAttribute("end", end);
        geometry.setAttribute("kind", kindOfSegment);
        geometry.instanceCount = segments;
        geometry.boundingSphere = sphere;
        const line = new THREE.BufferGeometry();
        line.setAttribute("position", position);
        line.setAttribute("kind", kindOfPoint);
        line.boundingSphere = sphere;
        const made = { quads: new THREE.Mesh(geometry, dim ? this.quadDim : quad), strip: new THREE.Line(line, dim ? stripDim : strip) };
        for (const object of [made.quads, made.strip]) {
          object.matrixAutoUpdate = false;
          object.frustumCulled = false; // done in `prepare`
          object.renderOrder = dim ? 2 : 1;
          object.visible = false;
          this.group.add(object);
        }
        return made;
      };
      this.chunks.push({ first, count: segments, sphere, levels, done: half(false), todo: half(true) });
    }
  }

  private levels(points: Float32Array, kinds: Uint8Array, diagonal: number): Level[] {
    const count = kinds.length, found: Level[] = [];
    let least = count;
    for (const step of diagonal ? STEPS : []) {
      const tolerance = diagonal / step, square = tolerance * tolerance;
      const kept = new Uint16Array(count);
      let many = 1, x = points[0], y = points[1], z = points[2];
      for (let i = 1; i < count; i++) {
        const dx = points[3 * i] - x, dy = points[3 * i + 1] - y, dz = points[3 * i + 2] - z;
        const away = dx * dx + dy * dy + dz * dz;
        if (i < count - 1 && away < square && kinds[i] === kinds[i + 1] && (away < square / 40 || !sharp(points, i))) continue;
        kept[many++] = i;
        x += dx; y += dy; z += dz;
      }
      if (many > 0.75 * least) continue;
      least = many;
      const index = kept.slice(0, many);
      found.push({ tolerance, index, attribute: new THREE.BufferAttribute(index, 1) });
    }
    return found;
  }

  recolor(palette: Palette): void {
    this.tools.material.color.copy(palette.tool);
    for (const name of ["rapid", "feedLow", "feedHigh", "probe"] as const) {
      (this.bright[name].value as THREE.Color).copy(palette[name]);
      (this.dim[name].value as THREE.Color).copy(palette[name]).lerp(palette.ground, 0.5);
    }
  }

  set rapids(shown: boolean) { this.shared.hideRapids.value = !shown; }
  get rapids(): boolean { return !this.shared.hideRapids.value; }

  resize(width: number, height: number, ratio: number): void {
    this.shared.size.value.set(width, height);
    this.shared.width.value.set(1.1 * ratio, 1.7 * ratio);
    this.shared.period.value = 8 * ratio;
  }

  /** Up to which point the path is done. */
  seek(point: number): void { this.cursor = point; }

  /** Choose what to draw. pixelAt: mm a pixel covers at a distance from the camera. slack: pixels of detail
   *  to forgo. quads: whether wide lines may be drawn. */
  prepare(camera: THREE.Camera, pixelAt: (distance: number) => number, slack: number, quads: boolean): void {
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    let inView = 0;
    const seen = this.chunks.map((chunk) => {
      const visible = frustum.intersectsSphere(chunk.sphere);
      if (visible) inView += chunk.count;
      return visible;
    });
    const wide = quads && inView <= QUADS;
    this.drawn = 0;
    this.chunks.forEach((chunk, i) => {
      const { done, todo, first, count, sphere } = chunk;
      for (const half of [done, todo]) half.quads.visible = half.strip.visible = false;
      if (!seen[i]) return;
      const split = Math.min(Math.max(this.cursor - first, 0), count);
      if (wide) {
        done.quads.visible = split > 0;
        todo.quads.visible = split < count;
        done.quads.geometry.instanceCount = split;
        todo.quads.material = split > 0 ? this.quadPart : this.quadDim;
        if (split > 0 && split < count) this.from.value = split;
        this.drawn += count;
        return;
      }
      const near = Math.max(camera.position.distanceTo(sphere.center) - sphere.radius, 0);
      const forgo = slack * pixelAt(near);
      let level: Level | undefined;
      for (const one of chunk.levels) if (one.tolerance <= forgo) level = one;
      const total = level ? level.index.length : count + 1;
      const at = level ? place(level.index, split) : split;
      for (const [half, start, many] of [[done, 0, at + 1], [todo, at, total - at]] as const) {
        half.strip.visible = many > 1;
        half.strip.geometry.setIndex(level ? level.attribute : null);
        half.strip.geometry.setDrawRange(start, many);
      }
      this.drawn += total - 1;
    });
  }

  /** The point that ends the segment nearest to a place on the canvas, or -1.
   *  x, y: pixels; reach: pixels; among those about as near the one closest to the eye wins. */
  pick(camera: THREE.Camera, ray: THREE.Ray, x: number, y: number, width: number, height: number, reach: number, pixelAt: (distance: number) => number): number {
    const { elements: m } = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const { points, kinds } = this;
    let best = -1, bestScore = Infinity;
    for (const chunk of this.chunks) {
      const far = camera.position.distanceTo(chunk.sphere.center) + chunk.sphere.radius;
      const wide = chunk.sphere.radius + reach * pixelAt(far);
      if (ray.distanceSqToPoint(chunk.sphere.center) > wide * wide) continue;
      let px = 0, py = 0, pz = 0, valid = false;
      for (let i = chunk.first; i <= chunk.first + chunk.count; i++) {
        const X = points[3 * i], Y = points[3 * i + 1], Z = points[3 * i + 2];
        const w = m[3] * X + m[7] * Y + m[11] * Z + m[15];
        const depth = (m[2] * X + m[6] * Y + m[10] * Z + m[14]) / w;
        const qx = ((m[0] * X + m[4] * Y + m[8] * Z + m[12]) / w + 1) * 0.5 * width;
        const qy = (1 - (m[1] * X + m[5] * Y + m[9] * Z + m[13]) / w) * 0.5 * height;
        const here = w > 0;
        if (i > chunk.first && here && valid && (this.rapids || kinds[i] !== TRAVERSE)) {
          const dx = qx - px, dy = qy - py, square = dx * dx + dy * dy;
          const t = square > 0 ? Math.min(Math.max(((x - px) * dx + (y - py) * dy) / square, 0), 1) : 1;
          const away = Math.hypot(px + t * dx - x, py + t * dy - y);
          if (away <= reach) {
            const score = Math.round(away / 2.5) + 0.5 * (pz + t * (depth - pz));
            if (score < bestScore) { bestScore = score; best = i; }
          }
        }
        px = qx; py = qy; pz = depth; valid = here;
      }
    }
    return best;
  }

  get hasTools(): boolean { return this.model.tools.length > 0; }

  get hasProbes(): boolean { return this.kinds.includes(PROBE); }
}

/** Whether a path turns by more than 45° at a point, so that corners outlast thinning. */
function sharp(points: Float32Array, i: number): boolean {
  const at = 3 * i;
  const ax = points[at] - points[at - 3], ay = points[at + 1] - points[at - 2], az = points[at + 2] - points[at - 1];
  const bx = points[at + 3] - points[at], by = points[at + 4] - points[at + 1], bz = points[at + 5] - points[at + 2];
  const dot = ax * bx + ay * by + az * bz;
  return dot < 0 || dot * dot < 0.5 * (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz);
}

/** Place of the last entry not above a value, in an ascending list that starts with 0. */
function place(sorted: Uint16Array, value: number): number {
  let low = 0, high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (sorted[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

function sphereOf(points: Float32Array): THREE.Sphere {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    const axis = i % 3, value = points[i];
    if (value < low[axis]) low[axis] = value;
    if (value > high[axis]) high[axis] = value;
  }
  const box = new THREE.Box3(new THREE.Vector3(...low), new THREE.Vector3(...high));
  return box.getBoundingSphere(new THREE.Sphere());
}
