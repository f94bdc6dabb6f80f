// The program text: only the lines in sight are in the document, however long the file is.

import { File } from "./data";

const LINE = 19; // px, as in style.css
const TALLEST = 8_000_000; // px: browsers clip taller elements, so beyond it the scroll bar is to scale

const TOKEN = /(\([^)]*\)?|;.*|%.*$)|([GM]\s*\d+(?:\.\d+)?)|(N\s*\d+)|([FST]\s*[-+]?[\d.]+)|([A-Z]\s*[-+]?[\d.]+|.)/gi;

/** Start of each line in a text's bytes, and its length as a last entry. */
export function starts(text: Uint8Array): Uint32Array {
  let many = 1;
  for (let i = text.indexOf(10); i >= 0; i = text.indexOf(10, i + 1)) many++;
  const found = new Uint32Array(many + 1);
  many = 1;
  for (let i = text.indexOf(10); i >= 0; i = text.indexOf(10, i + 1)) found[many++] = i + 1;
  found[many] = text.length + 1;
  // A line feed that ends the file starts no line.
  return many > 1 && found[many - 1] === text.length ? found.slice(0, many) : found;
}

export class Listing {
  private text: Uint8Array = new Uint8Array();
  private starts: Uint32Array = new Uint32Array([0, 1]);
  private firstMoves: Int32Array = new Int32Array();
  private top = 0; // px of the whole text above the sight
  private selected = 0;
  private readonly page = document.createElement("div");
  private readonly spacer = document.createElement("div");
  private readonly rows: HTMLDivElement[] = [];
  private readonly decoder = new TextDecoder();
  private quiet = false;

  /** choose: called with the line that was clicked. */
  constructor(private readonly root: HTMLElement, private readonly choose: (line: number) => void) {
    this.page.className = "page";
    this.spacer.className = "spacer";
    root.append(this.page, this.spacer);
    root.addEventListener("scroll", () => {
      if (!this.quiet) this.top = root.scrollTop * this.scale;
      this.quiet = false;
      this.draw();
    });
    root.addEventListener("wheel", (event) => {
      if (this.scale === 1 || event.ctrlKey || !event.deltaY) return;
      event.preventDefault(); // a scroll bar to scale would leap
      this.scroll(this.top + event.deltaY * (event.deltaMode === 1 ? LINE : 1));
    }, { passive: false });
    root.addEventListener("click", (event) => {
      const row = (event.target as Element).closest<HTMLElement>(".line");
      if (row) this.choose(Number(row.dataset.line));
    });
    root.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = { ArrowUp: -LINE, ArrowDown: LINE, PageUp: -root.clientHeight, PageDown: root.clientHeight };
      if (!(event.key in steps)) return;
      event.preventDefault();
      event.stopPropagation();
      this.scroll(this.top + steps[event.key]);
    });
    new ResizeObserver(() => this.draw()).observe(root);
  }

  get lines(): number { return this.starts.length - 1; }
  /** Lines that stand in the document. */
  get shown(): number { return this.rows.filter((row) => row.isConnected).length; }

  private get height(): number { return this.lines * LINE; }
  private get scale(): number {
    const sight = this.root.clientHeight;
    return this.height <= TALLEST ? 1 : (this.height - sight) / (TALLEST - sight);
  }

  /** Show a file. firstMoves: by line from 1, the first move it made or -1. */
  open(file: File, lineStarts: Uint32Array, firstMoves: Int32Array): void {
    this.text = file.text;
    this.starts = lineStarts;
    this.firstMoves = firstMoves;
    this.selected = 0;
    this.spacer.style.height = `${Math.min(this.height, TALLEST)}px`;
    this.page.replaceChildren();
    this.rows.length = 0;
    this.scroll(0);
  }

  line(number: number): string {
    const bytes = this.text.subarray(this.starts[number - 1], this.starts[number] - 1);
    return this.decoder.decode(bytes).replace(/\r$/, "");
  }

  /** Highlight a line; reveal: bring it into sight. */
  select(line: number, reveal: boolean): void {
    this.selected = line;
    const at = (line - 1) * LINE, sight = this.root.clientHeight;
    if (reveal && line > 0 && (at < this.top + LINE || at > this.top + sight - 3 * LINE)) this.scroll(at - sight * 0.4);
    else this.draw();
  }

  private scroll(top: number): void {
    this.top = Math.min(Math.max(top, 0), Math.max(this.height - this.root.clientHeight, 0));
    const wanted = this.top / this.scale;
    if (Math.abs(this.root.scrollTop - wanted) >= 1) {
      this.quiet = true; // the event that follows must not round `top`
      this.root.scrollTop = wanted;
    }
    this.draw();
  }

  private draw(): void {
    const sight = this.root.clientHeight;
    const first = Math.floor(this.top / LINE);
    const many = Math.min(Math.ceil(sight / LINE) + 1, this.lines - first);
    const digits = String(this.lines).length;
    while (this.rows.length < many) {
      const row = document.createElement("div");
      row.setAttribute("role", "option");
      row.append(document.createElement("span"), document.createElement("span"));
      (row.firstChild as HTMLElement).className = "gutter";
      (row.lastChild as HTMLElement).className = "text";
      this.rows.push(row);
    }
    this.rows.forEach((row, i) => {
      if (i >= many) { row.remove(); return; }
      const number = first + i + 1;
      if (row.dataset.line !== String(number)) {
        row.dataset.line = String(number);
        row.className = this.firstMoves[number] >= 0 ? "line moves" : "line";
        const [gutter, text] = row.children as unknown as [HTMLElement, HTMLElement];
        gutter.style.width = `calc(${digits}ch + 18px)`;
        gutter.textContent = String(number);
        text.replaceChildren(...colored(this.line(number)));
      }
      row.setAttribute("aria-selected", String(number === this.selected));
      row.style.transform = `translateY(${(first + i) * LINE - this.top}px)`;
      if (!row.isConnected) this.page.append(row);
    });
  }
}

function colored(line: string): Node[] {
  const nodes: Node[] = [];
  if (line.length > 2000) line = line.slice(0, 2000) + " …";
  let plain = "";
  const flush = () => { if (plain) nodes.push(document.createTextNode(plain)); plain = ""; };
  for (const [whole, comment, code, number, other] of line.matchAll(TOKEN)) {
    const kind = comment ? "w-c" : code ? "w-g" : number ? "w-n" : other ? "w-f" : "";
    if (!kind) { plain += whole; continue; }
    flush();
    const span = document.createElement("span");
    span.className = kind;
    span.textContent = whole;
    nodes.push(span);
  }
  flush();
  return nodes;
}
