// A lil-gui controller with a native range input: the keyboard can reach it, and its scale may be logarithmic.
import { Controller, type GUI } from "lil-gui";

export interface Scale {
  min: number;
  max: number;
  step?: number; ///< of a linear scale; a logarithmic one moves by 0.4 % of its travel
  log?: boolean; ///< equal ratios take equal lengths of travel
  zero?: boolean; ///< the left end of a logarithmic scale is 0
  unit?: string;
  whole?: boolean;
  zeroText?: string; ///< the word for 0, if 0 is no number to the user
}

const travel = 1000; // length of a logarithmic scale
const zeroEnd = 20; // length at the left of `travel` between 0 and the least value of a logarithmic scale

function toValue(at: number, scale: Scale): number {
  if (!scale.log) return Number(at.toPrecision(6));
  const start = scale.zero ? zeroEnd : 0;
  if (scale.zero && at < start / 2) return 0;
  const share = Math.max(0, at - start) / (travel - start);
  return Number((scale.min * (scale.max / scale.min) ** share).toPrecision(3));
}

function toTravel(value: number, scale: Scale): number {
  if (!scale.log) return value;
  if (value <= 0) return 0;
  const start = scale.zero ? zeroEnd : 0;
  return start + ((travel - start) * Math.log(value / scale.min)) / Math.log(scale.max / scale.min);
}

/// A number short and exact enough to read: 20000, 0.001, 1e-5.
export function readable(value: number): string {
  return String(Number(value.toPrecision(5)));
}

export class SliderController extends Controller {
  private readonly range = document.createElement("input");
  private readonly text = document.createElement("input");
  private readonly tick = document.createElement("i");
  private readonly fault = document.createElement("p");
  /// What the scene allows, in words; "" if that is not known.
  allowed: () => string = () => "";
  private readonly low: number;
  private readonly high: number;
  private readonly stride: number;

  constructor(
    gui: GUI,
    object: Record<string, unknown>,
    property: string,
    label: string,
    private readonly scale: Scale,
  ) {
    super(gui, object, property, "slider-controller");
    this.range.type = "range";
    [this.low, this.high, this.stride] = scale.log
      ? [0, travel, 4]
      : [scale.min, scale.max, scale.step ?? (scale.max - scale.min) / 200];
    this.range.min = String(this.low);
    this.range.max = String(this.high);
    this.range.step = "any"; // keeps a value that lies between two steps
    this.range.tabIndex = 0;
    this.text.type = "text";
    this.text.inputMode = "decimal";
    this.text.spellcheck = false;
    for (const input of [this.range, this.text])
      input.setAttribute("aria-label", scale.unit ? `${label} [${scale.unit}]` : label);
    this.fault.id = `fault-${property}`;
    this.fault.className = "fault";
    this.fault.setAttribute("role", "alert");
    this.tick.className = "slider-mark";
    this.tick.hidden = true;
    const rail = document.createElement("span");
    rail.className = "slider-rail";
    rail.append(this.range, this.tick);
    this.$widget.append(rail, this.text);
    this.range.addEventListener("input", () => {
      this.mend();
      this.setValue(toValue(this.snapped(Number(this.range.value)), this.scale));
    });
    this.range.addEventListener("keydown", (event) => this.rangeKey(event));
    this.range.addEventListener("change", () => this._callOnFinishChange());
    this.text.addEventListener("focus", () => this.text.select());
    this.text.addEventListener("blur", () => this.take());
    this.text.addEventListener("keydown", (event) => this.key(event));
    if (scale.unit) {
      const unit = document.createElement("span");
      unit.className = "unit";
      unit.textContent = scale.unit;
      this.name(label);
      this.$name.append(unit);
    } else {
      this.name(label);
    }
    this.updateDisplay();
  }

  override updateDisplay(): this {
    const value = Number(this.getValue());
    const at = this.clamped(toTravel(value, this.scale));
    this.range.value = String(at);
    this.range.style.setProperty("--filled", `${(100 * (at - this.low)) / (this.high - this.low)}%`);
    this.range.setAttribute("aria-valuetext", this.named(value) ?? `${readable(value)} ${this.scale.unit ?? ""}`);
    if (document.activeElement !== this.text && !this.faulty) this.text.value = this.written(value);
    return this;
  }

  /// Marks a value on the scale; null, or a value outside the scale, removes the mark.
  mark(value: number | null): void {
    const share = value === null || value <= 0 ? -1 : (toTravel(value, this.scale) - this.low) / (this.high - this.low);
    this.tick.hidden = !(share >= 0 && share <= 1);
    this.tick.style.setProperty("--at", String(share));
  }

  private named(value: number): string | undefined {
    return value === 0 ? this.scale.zeroText : undefined;
  }
  private written(value: number): string {
    return this.named(value) ?? readable(value);
  }

  private clamped(at: number): number {
    return Math.min(this.high, Math.max(this.low, at));
  }

  private snapped(at: number): number {
    return this.scale.log ? at : this.clamped(this.low + Math.round((at - this.low) / this.stride) * this.stride);
  }

  // Moves by one step from the present value, with Shift or Page keys by ten.
  private nudge(direction: number, event: KeyboardEvent): void {
    const steps = direction * (event.shiftKey || event.key.startsWith("Page") ? 10 : 1);
    this.jump(toTravel(Number(this.getValue()), this.scale) + steps * this.stride, event);
  }

  private jump(at: number, event: KeyboardEvent): void {
    event.preventDefault();
    this.mend();
    this.setValue(toValue(this.clamped(at), this.scale));
    this._callOnFinishChange();
  }

  private rangeKey(event: KeyboardEvent): void {
    const directions: Record<string, number> = {
      ArrowRight: 1,
      ArrowUp: 1,
      PageUp: 1,
      ArrowLeft: -1,
      ArrowDown: -1,
      PageDown: -1,
    };
    const direction = directions[event.key];
    if (direction !== undefined) this.nudge(direction, event);
    else if (event.key === "Home") this.jump(this.low, event);
    else if (event.key === "End") this.jump(this.high, event);
  }

  private key(event: KeyboardEvent): void {
    if (event.key === "Enter") this.text.blur();
    if (event.key === "Escape") {
      this.mend();
      this.text.value = this.written(Number(this.getValue()));
      this.text.blur();
    }
    if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
    this.nudge(event.key === "ArrowUp" ? 1 : -1, event);
    this.text.value = this.written(Number(this.getValue()));
  }

  // Takes a typed number. It may lie outside the slider's travel: the server decides. What is no number stays, to be
  // mended, beside what is wrong with it; nothing typed is nothing wanted.
  private take(): void {
    const typed = this.text.value.trim().replace(",", ".");
    const value = typed === this.scale.zeroText ? 0 : Number(typed);
    const wrong = this.scale.whole ? !Number.isInteger(value) : !Number.isFinite(value);
    if (typed !== "" && wrong) {
      this.complain();
      return;
    }
    this.mend();
    if (typed !== "" && readable(value) !== readable(Number(this.getValue()))) {
      this.setValue(value);
      this._callOnFinishChange();
    }
    this.text.value = this.written(Number(this.getValue()));
  }

  private get faulty(): boolean {
    return this.fault.isConnected;
  }

  private complain(): void {
    const { whole, zeroText } = this.scale;
    const range = this.allowed();
    const number = whole ? "a whole number" : "a number, such as 0.25 or 1e-3";
    const allowed = [number, range && `: ${range}`, zeroText && `, or ${zeroText}`].filter(Boolean).join("");
    this.fault.textContent = `“${this.text.value.trim()}” is not ${whole ? "a whole" : "a"} number. Allowed is ${allowed}.`;
    this.text.setAttribute("aria-invalid", "true");
    this.text.setAttribute("aria-errormessage", this.fault.id);
    this.domElement.after(this.fault);
  }

  private mend(): void {
    this.fault.remove();
    this.text.removeAttribute("aria-invalid");
    this.text.removeAttribute("aria-errormessage");
  }
}
