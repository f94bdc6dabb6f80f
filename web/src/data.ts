// What the page was given: facts as JSON, numbers as packed columns, program texts as bytes.
// aircut.export.page writes what this reads.

export type Six = [number, number, number, number, number, number];
/** at: move, system: 1 is G54, g5x and g92: mm and degrees, rotation: degrees. */
export type Frame = [at: number, system: number, g5x: Six, g92: Six, rotation: number];
export type Box = [low: [number, number, number], high: [number, number, number]];

interface Spec { name: string; count: number; base: number; quantum: number }
interface Facts {
  title: string; moves: number; start: Six; extents: [Box | null, Box | null];
  tools: number[]; frames: Frame[]; files: { name: string; bytes: number }[]; columns: Spec[];
}

/** A column of numbers: base + quantum · integer. A quantum of 0 means all are the base. */
export class Column {
  constructor(readonly count: number, readonly base: number, readonly quantum: number, readonly integers: Int32Array | null) {}
  at(index: number): number {
    return this.integers ? this.base + this.quantum * this.integers[index] : this.base;
  }
}

export interface File { name: string; text: Uint8Array }

export interface Model {
  title: string; moves: number; start: Six; frames: Frame[];
  /** Boxes in mm: of all moves, and of those that are not rapids. */
  all: Box | null; cut: Box | null;
  /** Lines along the tool, six numbers each: x, y, z of the tip, and of a point towards the holder. Only of
   *  five-axis machines; then points are as the part sees them. */
  tools: Float32Array;
  files: File[];
  /** Points: the start, then those of each move in turn. */
  points: number; x: Column; y: Column; z: Column;
  /** Move that a point ends or lies on; -1 for the start. */
  move: Column;
  /** Last point of each move. */
  last: Uint32Array;
  /** By move. */
  a: Column; b: Column; c: Column; feed: Column; line: Column; file: Column; tool: Column; kind: Column;
  /** What compensation led the tool beside: points, and which of them end a segment to be drawn. */
  contour: { x: Column; y: Column; z: Column; drawn: Column };
}

export const TRAVERSE = 0, PROBE = 3;
export const KINDS = ["Rapid", "Feed", "Arc", "Probe"];

function bytesOf(id: string): Uint8Array {
  const element = document.getElementById(id);
  const text = element?.textContent ?? "";
  element?.remove(); // the page need not keep it twice
  const native = Uint8Array as unknown as { fromBase64?: (text: string) => Uint8Array };
  if (native.fromBase64) return native.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflate(bytes: Uint8Array): Promise<Uint8Array> {
  if (!bytes.length) return bytes;
  const stream = new Blob([bytes as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function column(spec: Spec): Promise<Column> {
  const { count, base, quantum } = spec;
  const packed = bytesOf(`column-${spec.name}`);
  if (!quantum || !count) return new Column(count, base, quantum, null);
  const planes = await inflate(packed);
  const integers = new Int32Array(count);
  let sum = 0;
  for (let i = 0, j = count, k = 2 * count, l = 3 * count; i < count; i++, j++, k++, l++) {
    const zigzag = planes[i] | (planes[j] << 8) | (planes[k] << 16) | (planes[l] << 24);
    sum = (sum + ((zigzag >>> 1) ^ -(zigzag & 1))) | 0;
    integers[i] = sum;
  }
  return new Column(count, base, quantum, integers);
}

export async function load(): Promise<Model> {
  const facts = JSON.parse(document.getElementById("facts")?.textContent ?? "{}") as Facts;
  const [files, columns] = await Promise.all([
    Promise.all(facts.files.map(async (file, i) => ({ name: file.name, text: await inflate(bytesOf(`file-${i}`)) }))),
    Promise.all(facts.columns.map(column)),
  ]);
  const named = Object.fromEntries(facts.columns.map((spec, i) => [spec.name, columns[i]])) as Record<string, Column>;
  const { x, y, z, a, b, c, feed, line, file, tool, kind, move } = named;
  const last = new Uint32Array(facts.moves);
  for (let i = 1; i < x.count; i++) last[move.at(i)] = i;
  return {
    title: facts.title, moves: facts.moves, start: facts.start, frames: facts.frames, all: facts.extents[0],
    cut: facts.extents[1], tools: Float32Array.from(facts.tools), files, points: x.count, x, y, z, move, last, a, b, c, feed, line, file, tool, kind,
    contour: { x: named["contour-x"], y: named["contour-y"], z: named["contour-z"], drawn: named["contour-drawn"] },
  };
}

/** The frame in force at a move. */
export function frameAt(model: Model, move: number): Frame {
  let low = 0, high = model.frames.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (model.frames[middle][0] <= move) low = middle;
    else high = middle - 1;
  }
  return model.frames[low];
}

/** Machine coordinates of a frame's zero, mm. */
export function originOf([, , g5x, g92, rotation]: Frame): [number, number, number] {
  const turn = (rotation * Math.PI) / 180;
  const cos = Math.cos(turn), sin = Math.sin(turn);
  return [g5x[0] + g92[0] * cos - g92[1] * sin, g5x[1] + g92[0] * sin + g92[1] * cos, g5x[2] + g92[2]];
}

/** A machine position as the program's frame has it. */
export function inFrame(frame: Frame, machine: Six): Six {
  const [, , g5x, g92, rotation] = frame;
  const turn = (-rotation * Math.PI) / 180;
  const cos = Math.cos(turn), sin = Math.sin(turn);
  const off = machine.map((value, i) => value - g5x[i]);
  const turned = [off[0] * cos - off[1] * sin, off[0] * sin + off[1] * cos, ...off.slice(2)];
  return turned.map((value, i) => value - g92[i]) as Six;
}
