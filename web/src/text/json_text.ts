// Reads JSON and knows the line of everything in it; what is wrong is said with its line and column.

export interface Fault {
  line: number; ///< from 1
  column: number; ///< from 1
  says: string;
}

/// A text that is JSON.
export interface Read {
  value: unknown;
  /// The line of what is at a JSON Pointer, or, where nothing is, of the nearest thing around it; from 1.
  lineOf(pointer: string): number;
}

class Unreadable extends Error {
  constructor(
    readonly at: number,
    readonly says: string,
  ) {
    super(says);
  }
}

const deepest = 32; // as the server's --max-json-depth
const number = /-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?/y;
const word = /[A-Za-z_]+/y;
const words: Record<string, unknown> = { true: true, false: false, null: null };
const escaped: Record<string, string> = { b: "\b", f: "\f", n: "\n", r: "\r", t: "\t" };

const shown = (character: string | undefined): string =>
  character === undefined ? "the end of the text" : character === "\n" ? "the end of the line" : `“${character}”`;

class Reader {
  readonly places = new Map<string, number>(); // where the value at a pointer begins
  private at = 0;

  constructor(private readonly text: string) {}

  read(): unknown {
    const value = this.value("", 0);
    this.skip();
    if (this.at < this.text.length) throw new Unreadable(this.at, `${shown(this.text[this.at])} after the end`);
    return value;
  }

  private value(pointer: string, depth: number): unknown {
    this.skip();
    this.places.set(pointer, this.at);
    const first = this.text[this.at];
    if (depth > deepest) throw new Unreadable(this.at, `nested deeper than ${deepest} levels`);
    if (first === "{") return this.object(pointer, depth);
    if (first === "[") return this.array(pointer, depth);
    if (first === '"') return this.string();
    return this.scalar(first);
  }

  private scalar(first: string | undefined): unknown {
    number.lastIndex = word.lastIndex = this.at;
    const digits = number.exec(this.text)?.[0];
    if (digits !== undefined) {
      this.at += digits.length;
      const next = this.text[this.at];
      if (next !== undefined && /[\w.+-]/.test(next))
        throw new Unreadable(this.at, `${shown(next)} in a number; numbers look like -1.5e-3`);
      return Number(digits);
    }
    const name = word.exec(this.text)?.[0];
    if (name !== undefined && Object.hasOwn(words, name)) {
      this.at += name.length;
      return words[name];
    }
    if (name !== undefined) throw new Unreadable(this.at, `“${name}” is no value; text stands in double quotes`);
    throw new Unreadable(this.at, `${shown(first)} where a value belongs`);
  }

  private object(pointer: string, depth: number): Record<string, unknown> {
    const made: Record<string, unknown> = {};
    this.list("}", () => {
      if (this.text[this.at] !== '"')
        throw new Unreadable(this.at, `${shown(this.text[this.at])} where a key in double quotes belongs`);
      const start = this.at;
      const key = this.string();
      if (Object.hasOwn(made, key)) throw new Unreadable(start, `the key “${key}” stands here a second time`);
      this.skip();
      if (this.text[this.at] !== ":")
        throw new Unreadable(this.at, `${shown(this.text[this.at])} where the “:” after “${key}” belongs`);
      this.at++;
      const value = this.value(`${pointer}/${key.replaceAll("~", "~0").replaceAll("/", "~1")}`, depth + 1);
      Object.defineProperty(made, key, { value, writable: true, enumerable: true, configurable: true });
    });
    return made;
  }

  private array(pointer: string, depth: number): unknown[] {
    const made: unknown[] = [];
    this.list("]", () => made.push(this.value(`${pointer}/${made.length}`, depth + 1)));
    return made;
  }

  /// What stands between brackets, `end` being the closing one, with commas between.
  private list(end: string, item: () => void): void {
    this.at++;
    for (let first = true; ; first = false) {
      this.skip();
      if (this.text[this.at] === end && first) break;
      if (!first) {
        if (this.text[this.at] === end) break;
        if (this.text[this.at] !== ",")
          throw new Unreadable(this.at, `${shown(this.text[this.at])} where “,” or “${end}” belongs`);
        const comma = this.at++;
        this.skip();
        if (this.text[this.at] === end) throw new Unreadable(comma, `a “,” before “${end}”, after which nothing comes`);
      }
      item();
    }
    this.at++;
  }

  private string(): string {
    const start = this.at++;
    let made = "";
    for (;;) {
      const character = this.text[this.at];
      if (character === undefined || character === "\n")
        throw new Unreadable(start, "a text that its line does not end; it ends by a double quote");
      if (character < " ") throw new Unreadable(this.at, "a control character in a text; write it as \\u00XX");
      this.at++;
      if (character === '"') return made;
      made += character === "\\" ? this.escape() : character;
    }
  }

  private escape(): string {
    const character = this.text[this.at] ?? "";
    this.at++;
    if (character !== "u") {
      const meant = escaped[character] ?? ('"\\/'.includes(character) ? character : undefined);
      if (!meant) throw new Unreadable(this.at - 2, `“\\${character}” stands for nothing; “\\\\” is a backslash`);
      return meant;
    }
    const digits = this.text.slice(this.at, this.at + 4);
    if (!/^[0-9a-f]{4}$/i.test(digits)) throw new Unreadable(this.at - 2, "“\\u” without four digits after it");
    this.at += 4;
    return String.fromCharCode(Number.parseInt(digits, 16));
  }

  private skip(): void {
    while (" \t\r\n".includes(this.text[this.at] ?? "x")) this.at++;
    if (this.text.startsWith("//", this.at) || this.text.startsWith("/*", this.at))
      throw new Unreadable(this.at, "a comment; JSON has none");
  }
}

/// Reads a text; gives its fault if it is no JSON.
export function readJson(text: string): Read | Fault {
  const lineAt = (at: number): number => text.slice(0, at).split("\n").length;
  const reader = new Reader(text);
  try {
    const value = reader.read();
    const lineOf = (pointer: string): number => {
      for (let near = pointer; ; near = near.slice(0, near.lastIndexOf("/"))) {
        const at = reader.places.get(near);
        if (at !== undefined) return lineAt(at);
        if (near === "") return 1;
      }
    };
    return { value, lineOf };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    const line = lineAt(error.at);
    return { line, column: error.at - text.lastIndexOf("\n", error.at - 1), says: error.says };
  }
}

export const isFault = (read: Read | Fault): read is Fault => "says" in read;
