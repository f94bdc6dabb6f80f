// The page: puts path, stage, listing and transport together.

import * as THREE from "three";
import { Box, frameAt, inFrame, KINDS, load, Model, Six } from "./data";
import { Listing, starts } from "./listing";
import { Path } from "./path";
import { Stage, systemName, VIEWS } from "./stage";

const RAPID = 10_000; // mm/min at which rapids are played; the machine's own speed is not in the page
const SPEEDS = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 5000];
const PLAYED = 40; // seconds that a whole program takes to play at the speed first offered
const PICK = 10; // px
const SMALL = 20_000; // points that are always drawn in full

THREE.ColorManagement.enabled = false; // colors are those of the style sheet, as they stand

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const fixed = (value: number, digits = 4) => value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1");
const grouped = (value: number) => value.toLocaleString("en-US");

/** Seconds from the start at which each point is reached, dwells and acceleration left out; path lengths, mm. */
function clock(model: Model): { seconds: Float64Array; cut: number; rapid: number } {
  const { points, x, y, z, move, feed, kind, a, b, c, last } = model;
  const seconds = new Float64Array(points);
  let cut = 0, rapid = 0;
  for (let i = 1; i < points; i++) {
    const of = move.at(i);
    let length = Math.hypot(x.at(i) - x.at(i - 1), y.at(i) - y.at(i - 1), z.at(i) - z.at(i - 1));
    if (kind.at(of) === 0) rapid += length;
    else cut += length;
    if (length < 1e-7 && last[of] === i)
      length = Math.hypot(...[a, b, c].map((axis, n) => axis.at(of) - (of ? axis.at(of - 1) : model.start[3 + n])));
    const speed = kind.at(of) === 0 ? RAPID : feed.at(of) || RAPID;
    seconds[i] = seconds[i - 1] + (length / speed) * 60;
  }
  return { seconds, cut, rapid };
}

/** The programmed contour, where the path runs beside it. Its color stays linked to the one given. */
function contourOf(model: Model, pivot: THREE.Vector3, color: THREE.Color): THREE.LineSegments {
  const { x, y, z, drawn } = model.contour;
  const ends: number[] = [];
  for (let i = 1; i < x.count; i++) if (drawn.at(i)) for (const at of [i - 1, i]) ends.push(x.at(at) - pivot.x, y.at(at) - pivot.y, z.at(at) - pivot.z);
  const material = new THREE.LineBasicMaterial();
  material.color = color;
  const lines = new THREE.LineSegments(new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(ends, 3)), material);
  lines.frustumCulled = false;
  return lines;
}

class Viewer {
  readonly stage: Stage;
  readonly path: Path;
  readonly listing: Listing;
  private readonly renderer?: THREE.WebGLRenderer;
  private readonly seconds: Float64Array;
  private readonly lineStarts: (Uint32Array | undefined)[] = [];
  private readonly firstMoves: Int32Array[];
  private readonly partial = new THREE.Line(new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(6), 3)), new THREE.LineBasicMaterial());
  private readonly contourColor = new THREE.Color();
  private shownFile = -1;
  private direction: [number, number, number] | undefined = VIEWS.iso;
  private gridShown = true;
  private pending = false;
  private movedAt = -1e9; // when the camera was last moved, ms
  private frameAt = 0;
  private pace = 16; // ms a frame takes while the camera moves
  private rough: number; // 0: full quality while moving, higher: coarser
  private restTimer = 0;
  private playedAt = 0;
  private now = 0; // seconds into the program
  frames = 0;
  playing = false;
  /** Move last done or being done; -1 before the first. */
  move: number;
  line = 0;
  file = 0;

  constructor(readonly model: Model) {
    const canvas = element<HTMLCanvasElement>("canvas");
    this.stage = new Stage(model, canvas, element("labels"));
    this.path = new Path(model, this.stage.pivot, this.stage.diagonal);
    this.stage.scene.add(this.path.group, this.partial, contourOf(model, this.stage.pivot, this.contourColor));
    this.partial.renderOrder = 3;
    this.partial.frustumCulled = false;
    this.rough = model.points > 300_000 ? 3 : model.points > 60_000 ? 2 : 0;
    this.move = model.moves - 1;
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
      this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
      // Without a graphics card, start coarse rather than find out.
      const context = this.renderer.getContext(), info = context.getExtension("WEBGL_debug_renderer_info");
      const drawnBy = String(context.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : context.RENDERER));
      if (/swiftshader|llvmpipe|software/i.test(drawnBy) && model.points > 60_000) this.rough = 5;
    } catch {
      this.say("This browser offers no WebGL 2: the path cannot be drawn.");
    }
    const { seconds, cut, rapid } = clock(model);
    this.seconds = seconds;
    this.firstMoves = model.files.map(() => new Int32Array());
    this.indexLines();
    this.listing = new Listing(element("lines"), (line) => this.chooseLine(line));
    this.fillFacts(cut, rapid);
    this.wire(canvas);
    this.recolor();
    this.size();
    this.view("iso");
    this.seek(this.move, false);
  }

  private say(text: string): void {
    const notice = element("notice");
    notice.textContent = text;
    notice.hidden = !text;
  }

  /** For each file, the first move of each line. */
  private indexLines(): void {
    const { moves, line, file } = this.model;
    const highest = this.model.files.map(() => 0);
    for (let i = 0; i < moves; i++) if (line.at(i) > highest[file.at(i)]) highest[file.at(i)] = line.at(i);
    highest.forEach((lines, i) => { this.firstMoves[i] = new Int32Array(lines + 1).fill(-1); });
    for (let i = moves - 1; i >= 0; i--) {
      const list = this.firstMoves[file.at(i)];
      if (list && line.at(i) >= 0) list[line.at(i)] = i;
    }
  }

  private fillFacts(cut: number, rapid: number): void {
    const { model } = this;
    element("title").textContent = model.title;
    const facts: [string, string][] = [["Moves", grouped(model.moves)]];
    if (model.moves) facts.push(["Feed path", `${grouped(Math.round(cut))} mm`], ["Rapid path", `${grouped(Math.round(rapid))} mm`]);
    const box = model.cut ?? model.all;
    if (box) for (let i = 0; i < 3; i++) facts.push([`${"XYZ"[i]}`, `${fixed(box[0][i], 3)} … ${fixed(box[1][i], 3)} mm`]);
    element("summary").replaceChildren(...facts.flatMap(([name, value]) => {
      const dt = document.createElement("dt"), dd = document.createElement("dd");
      dt.textContent = name;
      dd.textContent = value;
      return [dt, dd];
    }));
    if (!model.moves) this.say("This program makes no moves.");
    element("legend-probe").hidden = !this.path.hasProbes;
    element("legend-tool").hidden = !this.path.hasTools;
    element("legend-contour").hidden = !model.contour.x.count;
    const files = element<HTMLSelectElement>("files");
    files.replaceChildren(...model.files.map((file, i) => new Option(file.name, String(i))));
    const slider = element<HTMLInputElement>("slider");
    slider.min = "-1";
    slider.max = String(model.moves - 1);
    slider.disabled = !model.moves;
    const total = this.seconds[this.seconds.length - 1] || 1;
    const offered = SPEEDS.find((speed) => speed >= 1 && total / speed <= PLAYED) ?? SPEEDS[SPEEDS.length - 1];
    element<HTMLSelectElement>("speed").replaceChildren(...SPEEDS.map((speed) => new Option(`${speed}×`, String(speed), speed === offered, speed === offered)));
  }

  private wire(canvas: HTMLCanvasElement): void {
    const on = (id: string, run: () => void) => element(id).addEventListener("click", run);
    for (const name of Object.keys(VIEWS)) on(name, () => this.view(name));
    on("fit", () => this.fit());
    on("rapids", () => this.showRapids(!this.path.rapids));
    on("grid", () => this.showGrid(!this.gridShown));
    on("lens", () => this.setLens(!this.stage.isPerspective));
    on("first", () => this.seek(-1));
    on("back", () => this.seek(this.move - 1));
    on("next", () => this.seek(this.move + 1));
    on("last", () => this.seek(this.model.moves - 1));
    on("play", () => (this.playing ? this.pause() : this.play()));
    const slider = element<HTMLInputElement>("slider");
    slider.addEventListener("input", () => this.seek(slider.valueAsNumber));
    const files = element<HTMLSelectElement>("files");
    files.addEventListener("change", () => { this.open(Number(files.value)); this.mark(false); });
    this.stage.controls.addEventListener("change", () => {
      this.movedAt = performance.now();
      this.direction = undefined;
      this.draw();
    });
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (event) => { down = { x: event.clientX, y: event.clientY }; });
    canvas.addEventListener("pointerup", (event) => {
      if (event.button !== 0 || Math.hypot(event.clientX - down.x, event.clientY - down.y) > 4) return;
      const found = this.pick(event.offsetX, event.offsetY);
      if (found >= 0) this.seek(found);
    });
    new ResizeObserver(() => this.size()).observe(element("view"));
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.recolor());
    document.addEventListener("keydown", (event) => this.key(event));
    this.divide();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target instanceof HTMLSelectElement) return;
    const views = ["iso", "top", "front", "right"];
    const keys: Record<string, () => void> = {
      ArrowLeft: () => this.seek(this.move - (event.shiftKey ? 10 : 1)), ArrowRight: () => this.seek(this.move + (event.shiftKey ? 10 : 1)),
      Home: () => this.seek(-1), End: () => this.seek(this.model.moves - 1),
      " ": () => (this.playing ? this.pause() : this.play()), r: () => this.showRapids(!this.path.rapids), f: () => this.fit(),
      g: () => this.showGrid(!this.gridShown), p: () => this.setLens(!this.stage.isPerspective),
    };
    views.forEach((name, i) => { keys[String(i + 1)] = () => this.view(name); });
    const run = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!run || (event.key === " " && event.target instanceof HTMLButtonElement && event.target.id !== "play")) return;
    event.preventDefault();
    run();
  }

  /** The border between picture and text can be moved. */
  private divide(): void {
    const divider = element("divider"), main = divider.parentElement as HTMLElement;
    const set = (width: number) => main.style.setProperty("--source", `${Math.min(Math.max(width, 160), innerWidth - 240)}px`);
    divider.addEventListener("pointerdown", (event) => {
      divider.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    divider.addEventListener("pointermove", (event) => { if (divider.hasPointerCapture(event.pointerId)) set(innerWidth - event.clientX - 3); });
    divider.addEventListener("keydown", (event) => {
      const step = event.key === "ArrowLeft" ? 20 : event.key === "ArrowRight" ? -20 : 0;
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      set(element("source").clientWidth + step);
    });
  }

  /** What the picture is of: all moves, or those that cut where rapids are hidden or reach far beyond. */
  private get box(): Box | null {
    const { all, cut } = this.model;
    const size = (box: Box) => Math.hypot(...box[0].map((low, i) => box[1][i] - low));
    return cut && all && (!this.path.rapids || size(all) > 2.5 * size(cut)) && size(cut) > 0 ? cut : all;
  }

  private recolor(): void {
    this.path.recolor(this.stage.palette());
    this.contourColor.set(getComputedStyle(document.documentElement).getPropertyValue("--contour").trim());
    this.dress();
  }

  private dress(): void {
    this.stage.dress(this.box, this.gridShown);
    const { spacing, frame } = this.stage;
    const moved = this.model.frames.length > 1 || [...frame[2], ...frame[3]].some(Boolean);
    element("spacing").textContent = this.gridShown ? `Grid ${spacing} mm${moved ? ` from ${systemName(frame[1])} zero` : ""}` : "";
    this.draw();
  }

  private size(): void {
    const { clientWidth: width, clientHeight: height } = element("view");
    if (!width || !height) return;
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer?.setPixelRatio(ratio);
    this.renderer?.setSize(width, height, false);
    this.path.resize(width * ratio, height * ratio, ratio);
    this.stage.resize(width, height);
    if (this.direction) this.stage.fit(this.box, this.direction);
    this.movedAt = -1e9;
    this.draw();
  }

  view(name: string): void {
    const direction = VIEWS[name];
    if (!direction) return;
    this.setLens(name === "iso"); // along an axis lengths are to be compared, so without perspective
    this.stage.fit(this.box, direction);
    this.direction = direction; // fitted again when the window changes, until the camera is moved by hand
    this.movedAt = -1e9;
    this.draw();
  }

  fit(): void {
    this.stage.fit(this.box);
    this.movedAt = -1e9;
    this.draw();
  }

  showRapids(shown: boolean): void {
    this.path.rapids = shown;
    element("rapids").setAttribute("aria-pressed", String(shown));
    this.dress();
  }

  showGrid(shown: boolean): void {
    this.gridShown = shown;
    element("grid").setAttribute("aria-pressed", String(shown));
    this.dress();
  }

  setLens(perspective: boolean): void {
    this.stage.isPerspective = perspective;
    const button = element("lens");
    button.setAttribute("aria-pressed", String(perspective));
    button.textContent = perspective ? "Persp" : "Ortho";
    this.draw();
  }

  /** The move nearest to a place on the canvas, px; -1 for none. */
  pick(x: number, y: number): number {
    const { clientWidth: width, clientHeight: height } = element("view");
    const caster = new THREE.Raycaster();
    caster.setFromCamera(new THREE.Vector2((x / width) * 2 - 1, 1 - (y / height) * 2), this.stage.camera);
    const point = this.path.pick(this.stage.camera, caster.ray, x, y, width, height, PICK, this.stage.pixelAt);
    return point < 0 ? -1 : this.model.move.at(point);
  }

  private chooseLine(line: number): void {
    const move = this.firstMoves[this.shownFile]?.[line] ?? -1;
    if (move >= 0) this.seek(move);
  }

  /** Stand at the end of a move; -1 stands before the first. */
  seek(move: number, reveal = true): void {
    this.pause();
    const at = Math.min(Math.max(Math.round(move) || 0, -1), this.model.moves - 1);
    const point = at < 0 ? 0 : this.model.last[at];
    this.now = this.seconds[point] ?? 0;
    this.show(at, point, 0, reveal);
  }

  /** part: of the segment after `point` that is done, 0 to 1. */
  private show(move: number, point: number, part: number, reveal = true): void {
    const { points } = this.path;
    this.move = move;
    this.path.seek(point);
    const here = [0, 1, 2].map((i) => points[3 * point + i] ?? 0);
    const there = part > 0 ? here.map((value, i) => value + part * (points[3 * point + 3 + i] - value)) : here;
    this.stage.toolAt(there[0], there[1], there[2]);
    this.partial.visible = part > 0;
    if (part > 0) {
      (this.partial.geometry.attributes.position.array as Float32Array).set([...here, ...there]);
      this.partial.geometry.attributes.position.needsUpdate = true;
    }
    this.mark(reveal);
    this.draw();
  }

  /** Slider, readout and text say where we stand. */
  private mark(reveal: boolean): void {
    const { model, move } = this;
    const slider = element<HTMLInputElement>("slider");
    slider.value = String(move);
    slider.setAttribute("aria-valuetext", `Move ${move + 1} of ${model.moves}`);
    element("counter").textContent = `${grouped(move + 1)} / ${grouped(model.moves)}`;
    this.line = move < 0 ? 0 : model.line.at(move);
    this.file = move < 0 ? 0 : model.file.at(move);
    if (reveal || this.shownFile < 0) this.open(this.file);
    if (this.shownFile === this.file) this.listing.select(this.line, reveal);
    element("place").textContent = this.line && model.files[this.file] ? `line ${grouped(this.line)} of ${grouped(this.listing.lines)}` : "";
    this.readout();
  }

  private open(file: number): void {
    if (file === this.shownFile || !this.model.files[file]) return;
    this.shownFile = file;
    const opened = this.model.files[file];
    this.listing.open(opened, (this.lineStarts[file] ??= starts(opened.text)), this.firstMoves[file]);
    element<HTMLSelectElement>("files").value = String(file);
  }

  /** End point of a move, mm and degrees, in machine coordinates. */
  position(move: number): Six {
    const { model } = this;
    if (move < 0) return model.start;
    const point = model.last[move];
    return [model.x.at(point), model.y.at(point), model.z.at(point), model.a.at(move), model.b.at(move), model.c.at(move)];
  }

  private readout(): void {
    const { model, move } = this;
    const spans: HTMLElement[] = [];
    const add = (name: string, value: string, kind = "num") => {
      const span = document.createElement("span"), text = document.createElement("span");
      if (name) span.append(Object.assign(document.createElement("b"), { textContent: name }));
      text.className = kind;
      text.textContent = value;
      span.append(text);
      spans.push(span);
    };
    const machine = this.position(move), frame = frameAt(model, Math.max(move, 0));
    const work = inFrame(frame, machine);
    const moved = work.some((value, i) => Math.abs(value - machine[i]) > 1e-9);
    add("", move < 0 ? "Start" : `${model.files[this.file]?.name ?? "?"}:${this.line}`, "where");
    if (move >= 0) add("", KINDS[model.kind.at(move)] ?? "", "kind");
    if (moved) add("", systemName(frame[1]), "frame");
    const shown = moved ? work : machine;
    shown.forEach((value, i) => add("XYZABC"[i], fixed(value, i < 3 ? 4 : 3)));
    if (move >= 0) {
      const feed = model.feed.at(move);
      add("F", model.kind.at(move) === 0 ? "rapid" : String(Number(feed.toFixed(3))));
      add("T", String(model.tool.at(move)), "tool");
    }
    if (moved) add("Machine", machine.slice(0, 3).map((value) => fixed(value)).join("  "), "machine");
    element("readout").replaceChildren(...spans);
  }

  play(): void {
    const { model, seconds } = this;
    if (!model.moves || this.playing) return;
    if (this.move >= model.moves - 1) this.now = 0;
    this.playing = true;
    this.playedAt = performance.now();
    this.pressPlay();
    const tick = () => {
      if (!this.playing) return;
      const time = performance.now();
      this.now += (Math.min(time - this.playedAt, 200) / 1000) * Number(element<HTMLSelectElement>("speed").value);
      this.playedAt = time;
      const end = seconds.length - 1;
      if (this.now >= seconds[end]) { this.seek(model.moves - 1); return; }
      let low = 0, high = end - 1; // the last point reached by now
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (seconds[middle] <= this.now) low = middle;
        else high = middle - 1;
      }
      const step = seconds[low + 1] - seconds[low];
      this.show(model.move.at(low + 1), low, step > 0 ? (this.now - seconds[low]) / step : 0);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    this.pressPlay();
  }

  private pressPlay(): void {
    const button = element("play");
    button.setAttribute("aria-pressed", String(this.playing));
    button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
  }

  /** Ask for a frame. */
  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.render());
  }

  private render(): void {
    this.pending = false;
    const time = performance.now();
    const moving = time - this.movedAt < 160 || this.playing;
    if (moving) this.adapt(time);
    this.frameAt = time;
    this.stage.prepare();
    // Detail forgone, px, and whether lines may be wide: at rest, and as the pace allows while moving.
    const slack = moving ? [0.7, 0.7, 2, 5, 14, 50][this.rough] : 0.7;
    this.path.prepare(this.stage.camera, this.stage.pixelAt, slack, !moving || this.rough === 0);
    (this.partial.material as THREE.LineBasicMaterial).color.set(getComputedStyle(document.documentElement).getPropertyValue("--feed").trim());
    this.renderer?.render(this.stage.scene, this.stage.camera);
    this.stage.annotate();
    this.stage.compass(element("compass"));
    this.frames++;
    if (moving && this.rough) {
      clearTimeout(this.restTimer);
      this.restTimer = window.setTimeout(() => this.draw(), 220);
    }
  }

  /** Coarser when frames come slowly, finer when they come quickly. */
  private adapt(time: number): void {
    const took = time - this.frameAt;
    if (took > 500 || this.model.points < SMALL) return; // not one frame after another, or not the path's doing
    this.pace += 0.2 * (took - this.pace);
    if (this.pace > 45 && this.rough < 5) { this.rough++; this.pace = 28; }
    else if (this.pace < 18.5 && this.rough > 0) { this.rough--; this.pace = 28; }
  }

  get state(): object {
    return { frames: this.frames, points: this.model.points, drawn: this.path.drawn, rough: this.rough, pace: this.pace, lines: this.listing.lines, rows: this.listing.shown };
  }
}

/** What scripts and tests may use. */
class Surface {
  viewer?: Viewer;
  readonly ready: Promise<void>;
  constructor() { this.ready = this.start(); }
  private async start(): Promise<void> {
    try {
      this.viewer = new Viewer(await load());
    } catch (error) {
      const notice = element("notice");
      notice.textContent = `The path could not be shown: ${String(error)}`;
      notice.hidden = false;
      throw error;
    }
    await new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve)));
  }
  private get shown(): Viewer {
    if (!this.viewer) throw new Error("await aircut.ready first");
    return this.viewer;
  }
  get moves(): number { return this.shown.model.moves; }
  get move(): number { return this.shown.move; }
  get line(): number { return this.shown.line; }
  get file(): string { return this.shown.model.files[this.shown.file]?.name ?? ""; }
  get position(): Six { return this.shown.position(this.shown.move); }
  get rapids(): boolean { return this.shown.path.rapids; }
  get playing(): boolean { return this.shown.playing; }
  get state(): object { return this.shown.state; }
  seek(move: number): void { this.shown.seek(move); }
  play(): void { this.shown.play(); }
  pause(): void { this.shown.pause(); }
  view(name: string): void { this.shown.view(name); }
  fit(): void { this.shown.fit(); }
  showRapids(shown: boolean): void { this.shown.showRapids(shown); }
  showGrid(shown: boolean): void { this.shown.showGrid(shown); }
  pick(x: number, y: number): number { return this.shown.pick(x, y); }
  /** Machine mm to canvas px. */
  project(x: number, y: number, z: number): [number, number] {
    const { stage } = this.shown, { clientWidth, clientHeight } = element("view");
    const at = new THREE.Vector3(x, y, z).sub(stage.pivot).project(stage.camera);
    return [((at.x + 1) / 2) * clientWidth, ((1 - at.y) / 2) * clientHeight];
  }
  text(line: number): string { return this.shown.listing.line(line); }
}

declare global {
  interface Window { aircut: Surface }
}

window.aircut = new Surface();
